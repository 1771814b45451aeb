//! A scenario with its vehicle, cycle and controller, loaded and ready to run.

use crate::controllers::Rules;
use crate::controllers::file::Controller;
use crate::drive_cycle::DriveCycle;
use crate::heat_demand_commander::HeatDemandCommander;
use crate::pace::Pace;
use crate::scenario::{ClimateParameters, ScenarioParameters, known_member};
use crate::weather::Weather;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::Override;
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::media::air::AirProperties;
use hp_plant::plant::{Disturbance, Plant};
use std::sync::Arc;

/// A scenario, loaded and ready to run.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Scenario as its file gives it; climate and initial state of this run are those below.
    pub scenario: Arc<ScenarioParameters>,
    /// Climate of this run.
    pub climate: ClimateParameters,
    /// Ambient air of that climate, worked out once.
    pub air: AirProperties,
    /// Water in a kilogram of its dry air [kg/kg].
    pub ambient_humidity_ratio: f64,
    /// Climate over time; none where it is constant.
    pub weather: Option<Arc<Weather>>,
    /// Initial state of this run.
    pub initial: InitialParameters,
    /// Vehicle.
    pub plant: Arc<Plant>,
    /// Drive cycle.
    pub cycle: DriveCycle,
    /// Name of the controller's file.
    pub controller: Arc<str>,
    /// What that file says.
    pub controller_file: Arc<Controller>,
    /// Rule-based controller of this scenario.
    pub rules: Arc<Rules>,
    /// Requested heat flows and scheduled connections.
    pub commander: Arc<HeatDemandCommander>,
}

impl Experiment {
    /// Loads a scenario; overrides are prefixed with `vehicle.`, `controller.` or `scenario.`.
    ///
    /// # Errors
    /// Anything wrong in one of its files or in an override.
    pub fn load(scenario: &str, controller: Option<&str>, overrides: &[Override]) -> PlantResult<Self> {
        Self::with_vehicle(scenario, None, controller, overrides)
    }

    /// [`Self::load`] with another vehicle than that of the scenario, by name or path.
    ///
    /// # Errors
    /// Anything wrong in one of its files or in an override, or a member that the vehicle cannot have.
    pub fn with_vehicle(
        scenario_name: &str,
        vehicle: Option<&str>,
        controller: Option<&str>,
        overrides: &[Override],
    ) -> PlantResult<Self> {
        let part = |prefix: &str| -> Vec<Override> {
            let stripped = |change: &Override| {
                let key = change.key.strip_prefix(prefix)?.strip_prefix('.')?.to_owned();
                Some(Override { key, value: change.value.clone() })
            };
            overrides.iter().filter_map(stripped).collect()
        };
        let known = ["vehicle.", "controller.", "scenario."];
        if let Some(other) = overrides.iter().find(|change| !known.iter().any(|k| change.key.starts_with(k)))
        {
            return Err(PlantError::InvalidArgument {
                what: "override key".into(),
                value: format!("`{}`", other.key),
                allowed: format!("must begin with one of {}", known.join(", ")),
            });
        }
        let mut scenario = ScenarioParameters::load(scenario_name, &part("scenario"))?;
        if let Some(vehicle) = vehicle {
            vehicle.clone_into(&mut scenario.vehicle);
        }
        let named = |error: PlantError| error.named_by(scenario_name);
        let file = Controller::load(controller.unwrap_or(&scenario.controller), &part("controller"));
        let file = Arc::new(if controller.is_none() { file.map_err(named)? } else { file? });
        let controller = controller.unwrap_or(&scenario.controller).to_owned();
        let plant = Plant::load(&scenario.vehicle, &part("vehicle"));
        let plant = Arc::new(if vehicle.is_none() { plant.map_err(named)? } else { plant? });
        let layout = plant.layout();
        scenario.check_members(layout).map_err(|violation| violation.in_file(scenario_name))?;
        for member in file.members() {
            known_member(layout, "strategy", member).map_err(|violation| violation.in_file(&controller))?;
        }
        let commander = HeatDemandCommander::of(
            &scenario.heat_demand,
            &scenario.connection_schedule,
            plant.ranges.idle(),
            layout,
        )
        .map_err(|violation| violation.in_file(scenario_name))?;
        let cycle = DriveCycle::load(&scenario.cycle).map_err(named)?;
        Ok(Self {
            weather: weather(&scenario, &plant, &cycle).map_err(named)?,
            cycle,
            controller: controller.into(),
            rules: Arc::new(file.at(scenario.climate.ambient_temperature_degc, &scenario.strategy, layout)),
            controller_file: file,
            commander: Arc::new(commander),
            air: scenario.climate.air(),
            ambient_humidity_ratio: scenario.climate.humidity_ratio(),
            climate: scenario.climate.clone(),
            initial: scenario.initial.clone(),
            scenario: Arc::new(scenario),
            plant,
        })
    }

    /// The same with each second integrated in several sub-steps; controllers stay at 1 s.
    #[must_use]
    pub fn with_substeps(mut self, substeps: u32) -> Self {
        self.plant = Arc::new(Arc::unwrap_or_clone(self.plant).with_substeps(substeps));
        self
    }

    /// What is asked of a vehicle at its pace in the next second, and what the surroundings do.
    #[must_use]
    #[inline]
    pub fn next_disturbance(&self, step: usize, pace: &Pace) -> Disturbance {
        let end_speed_m_s = pace.wanted_m_s(&self.cycle, step);
        let grade = self.cycle.grade(step, pace.behind_m);
        Disturbance { start_speed_m_s: pace.speed_m_s, end_speed_m_s, grade, ..self.disturbance(step) }
    }

    /// What the surroundings did to a vehicle at its pace in the last of so many steps, at the speeds of the cycle; before the
    /// first, what they will do.
    #[must_use]
    pub fn last_disturbance(&self, steps: usize, pace: &Pace) -> Disturbance {
        let step = steps.saturating_sub(1);
        Disturbance { grade: self.cycle.grade(step, pace.behind_m), ..self.disturbance(step) }
    }

    /// What the surroundings do during a step, at the speeds of the cycle.
    #[must_use]
    pub fn disturbance(&self, step: usize) -> Disturbance {
        let speeds = self.cycle.speeds_m_s();
        let at = |second: usize| speeds[second.min(speeds.len() - 1)];
        let mut disturbance = Disturbance {
            start_speed_m_s: at(step),
            end_speed_m_s: at(step + 1),
            air: self.air,
            ambient_humidity_ratio: self.ambient_humidity_ratio,
            solar_gain_w: self.climate.solar_gain_w,
            occupants: f64::from(self.climate.occupants),
            grade: self.cycle.grade(step, 0.0),
            headwind_m_s: 0.0,
        };
        if let Some(weather) = &self.weather {
            weather.enter(step, &mut disturbance);
        }
        disturbance
    }
}

/// Weather of a scenario, where it changes, once all its series are long enough for its cycle.
fn weather(
    scenario: &ScenarioParameters,
    plant: &Plant,
    cycle: &DriveCycle,
) -> PlantResult<Option<Arc<Weather>>> {
    let climate = scenario.climate_series.as_deref();
    for series in climate.into_iter().chain(scenario.settings.trace()) {
        series.check_length(&scenario.cycle, cycle.duration_s())?;
    }
    let aperture_m2 = plant.vehicle.body.solar_aperture_m2;
    Ok(climate.map(|series| Arc::new(Weather::of(series, &scenario.climate, aperture_m2))))
}
