//! A scenario: vehicle, cycle, climate, strategy, heat demands.

use crate::heat_demand_commander::{ConnectionChange, HeatDemandParameters, check_order};
use crate::strategy::Strategy;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::{Celsius, Validate, Violation};
use hp_plant::media::air::{self, AirProperties};
use hp_plant::parameters;
use serde::{Deserialize, Serialize};

/// Everything that defines a run except the numbers of vehicle and controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioParameters {
    /// What this scenario is, in a sentence.
    pub description: String,
    /// Name or path of the vehicle.
    pub vehicle: String,
    /// Name or path of the drive cycle.
    pub cycle: String,
    /// Name or path of the controller.
    pub controller: String,
    /// Climate.
    pub climate: ClimateParameters,
    /// State at the start.
    pub initial: InitialParameters,
    /// What the controller may use.
    pub strategy: Strategy,
    /// Heat flows that the heatDemandCommander asks for.
    pub heat_demand: HeatDemandParameters,
    /// Connections that follow a schedule instead of the controller.
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
