//! What a rule-based controller may use: the test cases of paper section 2.6.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How the rules treat the battery.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BatteryTreatment {
    /// Never connected.
    Isolate,
    /// Heated below 20 degC, cooled above 30 degC.
    Heat,
    /// Used as a heat source above 0 degC.
    Source,
}

/// Cabin climate control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClimateControl {
    /// Heating only, as in the paper.
    Heat,
    /// Air conditioning only.
    Cool,
    /// Whichever the cabin temperature calls for (ours).
    Auto,
}

/// What the rules may use.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Strategy {
    /// Battery.
    pub battery: BatteryTreatment,
    /// Cabin.
    pub climate_control: ClimateControl,
    /// Heaters.
    pub ptc: bool,
    /// Heat pump; without it the compressor stays off (ours).
    #[serde(default = "yes")]
    pub heat_pump: bool,
    /// Sources and stores by name; one that is not named is not used.
    #[serde(flatten)]
    pub members: BTreeMap<String, bool>,
}

impl Strategy {
    /// Whether a source or store may be used.
    #[must_use]
    pub fn uses(&self, member: &str) -> bool {
        self.members.get(member).copied().unwrap_or(false)
    }
}

/// What a controller changes in a strategy; the rest stays as the scenario has it (ours).
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct StrategyChanges {
    /// Battery.
    pub battery: Option<BatteryTreatment>,
    /// Heaters.
    pub ptc: Option<bool>,
    /// Heat pump.
    pub heat_pump: Option<bool>,
    /// Sources and stores by name.
    #[serde(flatten)]
    pub members: BTreeMap<String, bool>,
}

impl StrategyChanges {
    /// A strategy with these changes.
    #[must_use]
    pub fn applied_to(&self, strategy: &Strategy) -> Strategy {
        let mut members = strategy.members.clone();
        members.extend(self.members.clone());
        Strategy {
            battery: self.battery.unwrap_or(strategy.battery),
            climate_control: strategy.climate_control,
            ptc: self.ptc.unwrap_or(strategy.ptc),
            heat_pump: self.heat_pump.unwrap_or(strategy.heat_pump),
            members,
        }
    }
}

fn yes() -> bool {
    true
}
