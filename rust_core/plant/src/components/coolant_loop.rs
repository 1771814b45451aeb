//! Coolant loops: coolant and wetted metal, valves, how the flow divides over parallel branches, supply limits.

use super::pump::PumpParameters;
use crate::config::{Celsius, Validate, Violation, check_range};
use crate::parameters;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

parameters! {
    /// Coolant, wetted metal, pump and valves of one loop.
    pub struct CircuitParameters {
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

/// A loop's section of a vehicle: supply limits that the heat pump keeps, and the circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopParameters {
    /// Supply temperature that a condenser must not exceed (paper: 90 degC) [degC].
    pub maximum_supply_degc: Option<Celsius>,
    /// Supply temperature that an evaporator must not undercut (paper: -10 degC) [degC].
    pub minimum_supply_degc: Option<Celsius>,
    /// Coolant, pump, valves.
    pub circuit: CircuitParameters,
}

impl Validate for LoopParameters {
    fn validate(&self) -> Result<(), Violation> {
        if let Some(highest) = self.maximum_supply_degc {
            check_range("maximum_supply_degc", highest, 30.0, 130.0)?;
        }
        if let Some(lowest) = self.minimum_supply_degc {
            check_range("minimum_supply_degc", lowest, -40.0, 20.0)?;
        }
        self.circuit.validate().map_err(|violation| violation.within("circuit"))
    }
}

/// What becomes of the flow of closed branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedBranches {
    #[default]
    /// It bypasses the component; each branch keeps its share (the paper's Figures 8 and 9).
    Bypass,
    /// It goes to the open branches.
    Redistribute,
    /// Bypass, but redistribution during air conditioning (ours; the paper only heats).
    RedistributeInCooling,
}

/// How the loop flow divides over the parallel branches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
pub struct BranchShares {
    /// What becomes of the flow of closed branches.
    pub closed_branches: ClosedBranches,
    /// Share of each member's parallel branch; members in series see the whole flow.
    #[serde(flatten)]
    pub shares: BTreeMap<String, f64>,
}

impl BranchShares {
    /// Share of a member's branch.
    #[must_use]
    pub fn of(&self, member: &str) -> f64 {
        self.shares.get(member).copied().unwrap_or(0.0)
    }
}

impl Validate for BranchShares {
    fn validate(&self) -> Result<(), Violation> {
        for (key, &value) in &self.shares {
            check_range(key, value, 0.0, 1.0)?;
        }
        let sum: f64 = self.shares.values().sum();
        if !self.shares.is_empty() && (sum - 1.0).abs() > 1e-9 {
            return Err(Violation::new(
                "",
                format!("{} in sum", (sum * 1e9).round() / 1e9),
                "the shares must add up to 1",
            ));
        }
        Ok(())
    }
}
