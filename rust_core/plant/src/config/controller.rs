//! Parameters of the rule-based heat pump control unit (HPCU).

use super::Celsius;
use super::coolant::PidParameters;
use crate::parameters;

parameters! {
    /// HPCU of paper section 2.4.
    pub struct HpcuParameters {
        /// Cabin target (paper: 22 degC) [degC].
        cabin_set_point_degc: Celsius = 10.0 .. 30.0,
        /// Up to the cabin target the whole heat flow is requested; this far beyond it, none [K].
        cabin_request_band_k: f64 = 0.1 .. 10.0,
        /// Deviation from the cabin target that switches between heating and air conditioning [K] (ours).
        mode_switch_deviation_k: f64 = 0.5 .. 10.0,
        /// HTC target of the compressor control (paper: 90 degC) [degC].
        htc_set_point_degc: Celsius = 25.0 .. 95.0,
        /// Chiller target of the compressor control (paper: -10 degC) [degC].
        chiller_set_point_degc: Celsius = -40.0 .. 20.0,
        /// Chiller target while the cabin is cooled [degC] (ours).
        cooling_chiller_set_point_degc: Celsius = -10.0 .. 20.0,
        /// Constant flow demand for the HTC [kg/s].
        htc_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant flow demand for the chiller circuit [kg/s].
        chiller_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant blower level [-].
        blower_level: f64 = 0.0 .. 1.0,
        /// Recirculated share while heating [-] (paper: ambient air only, 0).
        heating_recirculation: f64 = 0.0 .. 0.95,
        /// Recirculated share while cooling [-] (ours).
        cooling_recirculation: f64 = 0.0 .. 0.95,
        ;
        /// Thresholds of the battery's connection.
        battery: BatteryThresholds,
        /// Compressor power against cabin temperature, W per K.
        cabin_pid: PidParameters,
        /// Compressor power against battery temperature, W per K.
        battery_pid: PidParameters,
        /// Compressor power against HTC supply, W per K.
        htc_pid: PidParameters,
        /// Compressor power against chiller supply, W per K.
        chiller_pid: PidParameters,
    }
}

parameters! {
    /// Battery thresholds of the HPCU.
    pub struct BatteryThresholds {
        /// The battery is heated up to here (paper: 20 degC) [degC].
        heat_up_to_degc: Celsius = -20.0 .. 50.0,
        /// Heating starts again this far below [K].
        heating_hysteresis_k: f64 = 0.0 .. 10.0,
        /// The battery is cooled above here (paper: 30 degC) [degC].
        cool_above_degc: Celsius = 0.0 .. 60.0,
        /// Cooling ends this far below [K].
        cooling_hysteresis_k: f64 = 0.0 .. 10.0,
        /// Used as a heat source, the battery is cooled down to here (paper section 2.6: 0 degC) [degC].
        source_down_to_degc: Celsius = -40.0 .. 40.0,
        /// Above that by this much, the whole heat is requested; below it fades to none [K].
        source_request_band_k: f64 = 0.1 .. 10.0,
    }
}
