//! The settings of an environment, checked and made ready; shared by all its episodes.

use crate::action::ActionTable;
use crate::garage::{Garage, Trip};
use crate::kinds::REWARD;
use crate::observation::ObservationTable;
use crate::reward::{self, RewardParameters};
use crate::scenario_sampler::Distribution;
use crate::snapshot;
use hp_plant::config::library::{self, Override};
use hp_plant::error::{PlantError, PlantResult};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Longest control interval [s].
const LONGEST_INTERVAL_S: u32 = 3600;

/// Settings as they come from outside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Continuous values instead of levels.
    pub continuous: bool,
    /// Actuators that the agent controls, in the order of an action.
    pub actions: Vec<String>,
    /// What the agent sees, in the order of an observation; names of rows or of groups of rows.
    pub observations: Vec<String>,
    /// Reward file.
    pub reward: String,
    /// Changes of single weights.
    pub reward_overrides: Vec<String>,
    /// Changes of single values of vehicle, controller and scenario.
    pub overrides: Vec<String>,
    /// Seconds for which an action is held.
    pub control_interval_s: u32,
    /// Standard deviation of the noise on measured rows, in units of half their range.
    pub sensor_noise: f64,
}

/// Where the trips of an environment come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// Always the same.
    Scenario(Arc<Trip>),
    /// Drawn anew.
    Distribution(Arc<Distribution>),
}

/// Settings made ready.
#[derive(Debug)]
pub struct Setup {
    /// Continuous values instead of levels.
    pub continuous: bool,
    /// Actions.
    pub actions: ActionTable,
    /// Observations.
    pub observations: ObservationTable,
    /// Weights of the reward.
    pub reward: RewardParameters,
    /// Seconds for which an action is held.
    pub control_interval_s: u32,
    /// Standard deviation of the noise.
    pub sensor_noise: f64,
    /// Vehicles, cycles, scenarios.
    pub garage: Garage,
    /// Identifies all of this.
    pub fingerprint: u64,
}

impl Setup {
    /// Checks settings and makes them ready.
    ///
    /// # Errors
    /// Anything in them that is not accepted.
    pub fn new(settings: &Settings) -> PlantResult<Self> {
        let parse = |texts: &[String]| {
            texts.iter().map(|text| Override::parse(text)).collect::<PlantResult<Vec<_>>>()
        };
        let out_of_range = |what: &str, value: String, allowed: String| PlantError::InvalidArgument {
            what: what.to_owned(),
            value,
            allowed,
        };
        if !(1..=LONGEST_INTERVAL_S).contains(&settings.control_interval_s) {
            let allowed = format!("must be between 1 and {LONGEST_INTERVAL_S}");
            return Err(out_of_range("control_interval_s", settings.control_interval_s.to_string(), allowed));
        }
        if !(0.0..=1.0).contains(&settings.sensor_noise) {
            let allowed = "must be between 0 and 1".to_owned();
            return Err(out_of_range("sensor_noise", settings.sensor_noise.to_string(), allowed));
        }
        let actions = ActionTable::new(&settings.actions)?;
        let observations = ObservationTable::new(&settings.observations, &actions)?;
        let reward: RewardParameters =
            library::load(REWARD, &settings.reward, &parse(&settings.reward_overrides)?)?;
        reward::check(&reward).map_err(|violation| violation.in_file(&settings.reward))?;
        let fingerprint = snapshot::fingerprint(&[
            env!("CARGO_PKG_VERSION").to_owned(),
            format!("{settings:?}"),
            format!("{reward:?}"),
        ]);
        Ok(Self {
            continuous: settings.continuous,
            actions,
            observations,
            reward,
            control_interval_s: settings.control_interval_s,
            sensor_noise: settings.sensor_noise,
            garage: Garage::new(parse(&settings.overrides)?),
            fingerprint,
        })
    }

    /// Trips of a scenario file.
    ///
    /// # Errors
    /// See [`Garage::trip`].
    pub fn scenario(&self, name: &str) -> PlantResult<Source> {
        self.garage.trip(name).map(|trip| Source::Scenario(Arc::new(trip)))
    }

    /// Trips of a distribution.
    ///
    /// # Errors
    /// See [`Distribution::load`].
    pub fn distribution(&self, name: &str) -> PlantResult<Source> {
        Ok(Source::Distribution(Arc::new(Distribution::load(name, &self.garage)?)))
    }
}
