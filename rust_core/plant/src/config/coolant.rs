//! Parameters of the coolant loops and of what is connected to them.

use super::Celsius;
use super::{Validate, Violation, check_range};
use crate::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// Coolant, wetted metal, pump, valves and limits of one loop.
    pub struct LoopParameters {
        /// Heat capacity of coolant and wetted metal [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 1000000.0,
        /// Specific heat of the coolant [J/(kg K)].
        coolant_specific_heat_j_kg_k: f64 = 1000.0 .. 5000.0,
        /// Hose and pipe conductance to ambient, the whole loop [W/K].
        hose_conductance_w_k: f64 = 0.0 .. 200.0,
        /// Valve position "open": share of the branch flow that passes the component (paper: 0.99) [-].
        valve_open: f64 = 0.01 .. 1.0,
        /// Valve position "closed" (paper: 1e-8) [-].
        valve_closed: f64 = 0.0 .. 0.1,
        ;
        /// Circulation pump.
        pump: PumpParameters,
        /// Share of the loop flow in each parallel branch.
        branch_shares: BranchShares,
    }
}

parameters! {
    /// Circulation pump under a PID that follows the flow demand.
    pub struct PumpParameters {
        /// Largest coolant flow [kg/s].
        maximum_flow_kg_s: f64 = 0.01 .. 5.0,
        /// Smallest coolant flow while the vehicle is on [kg/s].
        minimum_flow_kg_s: f64 = 0.001 .. 1.0,
        /// Electrical power at the largest flow; it warms the coolant [W].
        maximum_power_w: f64 = 0.0 .. 2000.0,
        ;
        /// Controller on the flow.
        pid: PidParameters,
    }
}

parameters! {
    /// PID gains; the derivative acts on the measurement. Units follow from the controller's use.
    pub struct PidParameters {
        /// Proportional gain [output unit per input unit].
        proportional: f64 = 0.0 .. 1000000.0,
        /// Integral gain [output unit per input unit and second].
        integral: f64 = 0.0 .. 1000000.0,
        /// Derivative gain [output unit seconds per input unit].
        derivative: f64 = 0.0 .. 1000000.0,
    }
}

/// What becomes of the flow of closed branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedBranches {
    /// It bypasses the component; each branch keeps its share (the paper's Figures 8 and 9).
    Bypass,
    /// It goes to the open branches.
    Redistribute,
    /// Bypass, but redistribution during air conditioning (ours; the paper only heats).
    RedistributeInCooling,
}

/// How the loop flow divides over the parallel branches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BranchShares {
    /// What becomes of the flow of closed branches.
    pub closed_branches: ClosedBranches,
    /// Cabin core.
    pub cabin: f64,
    /// Battery plate.
    pub battery: f64,
    /// Ambient exchanger.
    pub ambient: f64,
    /// Motor and inverter (chiller loop).
    #[serde(default)]
    pub motor: f64,
    /// Transmission (chiller loop).
    #[serde(default)]
    pub transmission: f64,
    /// Thermal battery (chiller loop; it is in series in the HTC).
    #[serde(default)]
    pub thermal_battery: f64,
}

impl BranchShares {
    /// Sum of the shares.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.cabin + self.battery + self.ambient + self.motor + self.transmission + self.thermal_battery
    }
}

impl Validate for BranchShares {
    fn validate(&self) -> Result<(), Violation> {
        for (key, value) in [
            ("cabin", self.cabin),
            ("battery", self.battery),
            ("ambient", self.ambient),
            ("motor", self.motor),
            ("transmission", self.transmission),
            ("thermal_battery", self.thermal_battery),
        ] {
            check_range(key, value, 0.0, 1.0)?;
        }
        if (self.sum() - 1.0).abs() > 1e-9 {
            return Err(Violation::new("", format!("{} in sum", self.sum()), "the shares must add up to 1"));
        }
        Ok(())
    }
}

parameters! {
    /// High temperature circuit: supply limit and its own members.
    pub struct HtcParameters {
        /// Supply temperature that the heat pump must not exceed (paper: 90 degC) [degC].
        maximum_supply_degc: Celsius = 30.0 .. 130.0,
        ;
        /// Loop.
        circuit: LoopParameters,
    }
}

parameters! {
    /// Chiller circuit: supply limit and its own members.
    pub struct ChillerParameters {
        /// Supply temperature that the heat pump must not undercut (paper: -10 degC) [degC].
        minimum_supply_degc: Celsius = -40.0 .. 20.0,
        ;
        /// Loop.
        circuit: LoopParameters,
    }
}

parameters! {
    /// PTC heater at the end of the HTC's series part.
    pub struct PtcParameters {
        /// Largest electrical power [W].
        maximum_power_w: f64 = 0.0 .. 20000.0,
        /// Coolant temperature above which it is off (paper: 85 degC) [degC].
        cutoff_degc: Celsius = 20.0 .. 120.0,
        ;
        /// Controller on the cabin temperature.
        pid: PidParameters,
    }
}

parameters! {
    /// Sensible heat store.
    pub struct ThermalBatteryParameters {
        /// Heat capacity [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 10000000.0,
        /// Coolant conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
        /// Loss conductance to ambient [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 50.0,
    }
}

parameters! {
    /// Front-end exchanger with ambient air: heat source in the chiller loop, radiator in the HTC.
    pub struct AmbientExchangerParameters {
        /// Conductance as heat source at standstill, fan on [W/K].
        source_ua_w_k: f64 = 0.0 .. 5000.0,
        /// Its increase with vehicle speed [W/K per m/s].
        source_ua_per_speed_w_s_k_m: f64 = 0.0 .. 200.0,
        /// Conductance as radiator at standstill, fan on [W/K].
        radiator_ua_w_k: f64 = 0.0 .. 5000.0,
        /// Its increase with vehicle speed [W/K per m/s].
        radiator_ua_per_speed_w_s_k_m: f64 = 0.0 .. 200.0,
        /// Fan power while the exchanger is connected and the vehicle is slow [W].
        fan_power_w: f64 = 0.0 .. 2000.0,
        /// Vehicle speed at which ram air replaces the fan [m/s].
        fan_off_speed_m_s: f64 = 0.1 .. 100.0,
        /// Ambient temperature at or below which it is no heat source (frost interlock; paper: -10 degC) [degC].
        frost_interlock_degc: Celsius = -60.0 .. 20.0,
    }
}

parameters! {
    /// Thermal switches between components and loops.
    pub struct SwitchParameters {
        /// Temperature difference needed to close a connection [K].
        closing_difference_k: f64 = 0.0 .. 20.0,
        /// Temperature difference below which it opens again [K].
        opening_difference_k: f64 = 0.0 .. 20.0,
        ;
        /// Controller on the heat flow, both normalised by what the exchanger could pass.
        pid: PidParameters,
    }
}

parameters! {
    /// Controls that belong to the plant itself.
    pub struct PlantControlParameters {
        /// Constant 12 V load without pumps, blower and fan [W].
        auxiliary_power_w: f64 = 0.0 .. 5000.0,
        ;
        /// Thermal switches.
        thermal_switch: SwitchParameters,
        /// Compressor power against condensing pressure (`PID_pressureControl`), W per bar.
        pressure_pid: PidParameters,
    }
}
