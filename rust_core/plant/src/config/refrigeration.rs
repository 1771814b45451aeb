//! Parameters of the refrigeration loop.

use crate::parameters;

parameters! {
    /// Refrigerant loop: compressor, condenser, expansion, evaporator.
    pub struct RefrigerationParameters {
        /// Condenser conductance, refrigerant to HTC coolant [W/K].
        condenser_ua_w_k: f64 = 50.0 .. 10000.0,
        /// Evaporator (chiller) conductance, coolant to refrigerant [W/K].
        evaporator_ua_w_k: f64 = 50.0 .. 10000.0,
        /// Superheat that the expansion valve holds where the coolant allows it [K].
        superheat_k: f64 = 0.5 .. 10.0,
        /// Subcooling at the condenser outlet where the coolant allows it [K].
        subcooling_k: f64 = 0.0 .. 10.0,
        /// Condensing pressure that must not be exceeded [bar] (paper section 2.3: 30 bar).
        maximum_pressure_bar: f64 = 5.0 .. 45.0,
        /// Suction pressure that must not be undercut [bar], the low-pressure guard of the evaporator.
        minimum_suction_pressure_bar: f64 = 0.2 .. 3.0,
        ;
        /// The electrically driven compressor.
        compressor: CompressorParameters,
    }
}

parameters! {
    /// Electrically driven scroll compressor.
    pub struct CompressorParameters {
        /// Displacement [cm3/rev].
        displacement_cm3: f64 = 5.0 .. 200.0,
        /// Lowest continuous speed [rev/s].
        minimum_speed_rev_s: f64 = 1.0 .. 100.0,
        /// Highest speed [rev/s].
        maximum_speed_rev_s: f64 = 20.0 .. 400.0,
        /// Largest change of speed [rev/s per s].
        speed_ramp_rev_s2: f64 = 0.1 .. 1000.0,
        /// Largest electrical power [W].
        maximum_power_w: f64 = 100.0 .. 20000.0,
        /// Smallest power demand that counts as "on" [W]; the lower end of the demand scale.
        minimum_power_w: f64 = 10.0 .. 2000.0,
        /// Shortest time on [s].
        minimum_on_time_s: f64 = 0.0 .. 600.0,
        /// Shortest time off [s].
        minimum_off_time_s: f64 = 0.0 .. 600.0,
        /// Electrical energy lost at each start (pressure equalisation, spin-up) [J].
        start_loss_j: f64 = 0.0 .. 100000.0,
        /// Discharge gas temperature that must not be exceeded [degC].
        maximum_discharge_temperature_degc: f64 = 60.0 .. 150.0,
        /// Volumetric efficiency extrapolated to pressure ratio 1, without leakage [-].
        volumetric_efficiency_at_unity: f64 = 0.5 .. 1.1,
        /// Relative loss of volumetric efficiency per unit of pressure ratio [-].
        volumetric_efficiency_slope: f64 = 0.0 .. 0.2,
        /// Gas that leaks back per delivered gas at the lowest speed and pressure ratio 2 [-].
        leakage_share: f64 = 0.0 .. 0.5,
        /// Peak isentropic efficiency, without leakage [-].
        isentropic_efficiency_peak: f64 = 0.2 .. 0.95,
        /// Pressure ratio of the peak [-].
        isentropic_peak_pressure_ratio: f64 = 1.2 .. 8.0,
        /// Extra work with the squared logarithm of the pressure ratio over the peak's [-].
        isentropic_pressure_ratio_loss: f64 = 0.0 .. 2.0,
        /// Extra work with the squared distance of relative speed from half of maximum speed [-].
        isentropic_speed_loss: f64 = 0.0 .. 4.0,
        /// Efficiency of compressor motor and inverter [-]; the rest leaves to ambient.
        electrical_efficiency: f64 = 0.3 .. 1.0,
        /// Lowest pressure ratio at which the machine compresses [-].
        minimum_pressure_ratio: f64 = 1.05 .. 2.0,
    }
}
