//! A scenario: vehicle, cycle, climate, strategy, heat demands.

use super::{Celsius, Validate, Violation, check_range};
use crate::command::{Connection, Member};
use crate::media::air::{self, AirProperties};
use crate::parameters;
use serde::{Deserialize, Serialize};

/// Everything that defines a run except the numbers of vehicle and controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioParameters {
    /// What this scenario is, in a sentence.
    pub description: String,
    /// Vehicle file.
    pub vehicle: String,
    /// Drive cycle file.
    pub cycle: String,
    /// Controller file.
    pub controller: String,
    /// Climate.
    pub climate: ClimateParameters,
    /// State at the start.
    pub initial: InitialParameters,
    /// What the HPCU may use.
    pub strategy: Strategy,
    /// Heat flows that the heatDemandCommander asks for.
    pub heat_demand: HeatDemandParameters,
    /// Connections that follow a schedule instead of the HPCU.
    #[serde(default)]
    pub connection_schedule: Vec<ConnectionChange>,
}

parameters! {
    /// Climate, constant over the run.
    pub struct ClimateParameters {
        /// Ambient temperature [degC].
        ambient_temperature_degc: Celsius = -50.0 .. 60.0,
        /// Solar heat that reaches the cabin [W] (ours; 0 in the paper).
        solar_gain_w: f64 = 0.0 .. 3000.0,
        /// Number of people (ours; the driver in the paper).
        occupants: u32 = 0 .. 9,
    }
}

impl ClimateParameters {
    /// Ambient air.
    #[must_use]
    pub fn air(&self) -> AirProperties {
        air::at_temperature(self.ambient_temperature_degc.kelvin())
    }
}

/// State at the start; what is not given has the soak temperature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InitialParameters {
    /// Temperature of everything after the soak [degC].
    pub soak_temperature_degc: Celsius,
    /// State of charge [%].
    pub state_of_charge_pct: f64,
    /// Cabin air and furnishings [degC].
    pub cabin_temperature_degc: Option<Celsius>,
    /// Battery [degC].
    pub battery_temperature_degc: Option<Celsius>,
    /// Thermal battery [degC].
    pub thermal_battery_temperature_degc: Option<Celsius>,
}

/// How the HPCU treats the battery.
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

/// Cabin climate control of the HPCU.
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

/// What the HPCU may use; test cases of paper section 2.6.
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

/// Requested heat flows [W]: constants, then changes in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatDemandParameters {
    /// Battery.
    pub battery_w: f64,
    /// Motor and inverter.
    pub motor_w: f64,
    /// Transmission.
    pub transmission_w: f64,
    /// Ambient.
    pub ambient_w: f64,
    /// Thermal battery.
    pub thermal_battery_w: f64,
    /// Cabin.
    pub cabin_w: f64,
    /// Changes, in order of time.
    #[serde(default)]
    pub schedule: Vec<HeatDemandChange>,
}

/// From a time on, one member's requested heat flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatDemandChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: Member,
    /// Heat flow [W].
    pub heat_flow_w: f64,
}

/// From a time on, one member's connection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConnectionChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: Member,
    /// Connection.
    pub connection: Connection,
}

impl Validate for InitialParameters {
    fn validate(&self) -> Result<(), Violation> {
        check_range("soak_temperature_degc", self.soak_temperature_degc, -50.0, 70.0)?;
        check_range("state_of_charge_pct", self.state_of_charge_pct, 0.0, 100.0)?;
        for (key, value) in [
            ("cabin_temperature_degc", self.cabin_temperature_degc),
            ("battery_temperature_degc", self.battery_temperature_degc),
            ("thermal_battery_temperature_degc", self.thermal_battery_temperature_degc),
        ] {
            if let Some(value) = value {
                check_range(key, value, -50.0, 100.0)?;
            }
        }
        Ok(())
    }
}

impl HeatDemandParameters {
    /// Constants, by member.
    #[must_use]
    pub fn constants_w(&self) -> [f64; 6] {
        [
            self.battery_w,
            self.motor_w,
            self.transmission_w,
            self.ambient_w,
            self.thermal_battery_w,
            self.cabin_w,
        ]
    }
}

impl Validate for HeatDemandParameters {
    fn validate(&self) -> Result<(), Violation> {
        let keys = ["battery_w", "motor_w", "transmission_w", "ambient_w", "thermal_battery_w", "cabin_w"];
        for (key, value) in keys.into_iter().zip(self.constants_w()) {
            check_range(key, value, 0.0, crate::command::MAXIMUM_REQUEST_W)?;
        }
        check_order("schedule", self.schedule.iter().map(|change| change.from_s))?;
        for (i, change) in self.schedule.iter().enumerate() {
            let key = format!("schedule[{i}].heat_flow_w");
            check_range(&key, change.heat_flow_w, 0.0, crate::command::MAXIMUM_REQUEST_W)?;
        }
        Ok(())
    }
}

fn check_order(key: &str, times: impl Iterator<Item = f64>) -> Result<(), Violation> {
    let mut last = 0.0;
    for (i, time) in times.enumerate() {
        let key = format!("{key}[{i}].from_s");
        check_range(&key, time, 0.0, 1e7)?;
        if time < last {
            return Err(Violation::new(
                key,
                time,
                format!("must not be before the change above it ({last} s)"),
            ));
        }
        last = time;
    }
    Ok(())
}

impl Validate for ScenarioParameters {
    fn validate(&self) -> Result<(), Violation> {
        self.climate.validate().map_err(|violation| violation.within("climate"))?;
        self.initial.validate().map_err(|violation| violation.within("initial"))?;
        self.heat_demand.validate().map_err(|violation| violation.within("heat_demand"))?;
        check_order("connection_schedule", self.connection_schedule.iter().map(|change| change.from_s))?;
        for (i, change) in self.connection_schedule.iter().enumerate() {
            if !change.member.options().contains(&change.connection) {
                return Err(Violation::new(
                    format!("connection_schedule[{i}].connection"),
                    format!("{:?}", change.connection).to_lowercase(),
                    format!("must be one of {:?}", change.member.options()).to_lowercase(),
                ));
            }
        }
        Ok(())
    }
}
