//! What a rule-based controller may use: the test cases of paper section 2.6.

use serde::{Deserialize, Serialize};

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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strategy {
    /// Battery.
    pub battery: BatteryTreatment,
    /// Cabin.
    pub climate_control: ClimateControl,
    /// Motor and inverter as heat source.
    pub motor: bool,
    /// Transmission as heat source.
    pub transmission: bool,
    /// Ambient as heat source.
    pub ambient: bool,
    /// Thermal battery.
    pub thermal_battery: bool,
    /// PTC heater.
    pub ptc: bool,
    /// Heat pump; without it the compressor stays off (ours).
    #[serde(default = "yes")]
    pub heat_pump: bool,
}

/// What a controller changes in a strategy; the rest stays as the scenario has it (ours).
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrategyChanges {
    /// Battery.
    pub battery: Option<BatteryTreatment>,
    /// Motor and inverter as heat source.
    pub motor: Option<bool>,
    /// Transmission as heat source.
    pub transmission: Option<bool>,
    /// Ambient as heat source.
    pub ambient: Option<bool>,
    /// Thermal battery.
    pub thermal_battery: Option<bool>,
    /// PTC heater.
    pub ptc: Option<bool>,
    /// Heat pump.
    pub heat_pump: Option<bool>,
}

impl StrategyChanges {
    /// A strategy with these changes.
    #[must_use]
    pub fn applied_to(&self, strategy: &Strategy) -> Strategy {
        Strategy {
            battery: self.battery.unwrap_or(strategy.battery),
            climate_control: strategy.climate_control,
            motor: self.motor.unwrap_or(strategy.motor),
            transmission: self.transmission.unwrap_or(strategy.transmission),
            ambient: self.ambient.unwrap_or(strategy.ambient),
            thermal_battery: self.thermal_battery.unwrap_or(strategy.thermal_battery),
            ptc: self.ptc.unwrap_or(strategy.ptc),
            heat_pump: self.heat_pump.unwrap_or(strategy.heat_pump),
        }
    }
}

fn yes() -> bool {
    true
}
