//! Coolant loops: coolant and wetted metal, valves, how the flow divides over parallel branches, supply limits.

use super::pump::PumpParameters;
use crate::config::{Celsius, Validate, Violation, check_range};
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
