//! Whole runs: a scenario with its vehicle, cycle and controller, from start to arrival.

use crate::command::Command;
use crate::config::controller::Controller;
use crate::config::library::{self, Kind, Override};
use crate::config::scenario::{ClimateParameters, InitialParameters, ScenarioParameters};
use crate::control::heat_demand_commander;
use crate::control::hpcu::{Hpcu, HpcuState};
use crate::drive_cycle::DriveCycle;
use crate::error::{PlantError, PlantResult};
use crate::flows::Flow;
use crate::media::air::AirProperties;
use crate::plant::{Disturbance, Plant, StepRecord};
use crate::signals::{self, View};
use crate::state::State;
use crate::summary::Summary;
use serde::{Deserialize, Serialize};
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
    /// Initial state of this run.
    pub initial: InitialParameters,
    /// Vehicle.
    pub plant: Arc<Plant>,
    /// Drive cycle.
    pub cycle: DriveCycle,
    /// Name of the controller's file.
    pub controller: Arc<str>,
    /// What that file says.
    pub rules: Arc<Controller>,
    /// Rule-based controller of this scenario.
    pub hpcu: Arc<Hpcu>,
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    /// The cycle was driven to its end.
    Arrived,
    /// The battery could not deliver what driving needed.
    UnservedEnergy,
    /// The usable state of charge reached zero.
    BatteryEmpty,
}

impl EndReason {
    /// Name used in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::UnservedEnergy => "unserved_energy",
            Self::BatteryEmpty => "battery_empty",
        }
    }
}

/// Energy that may go unserved before a run ends [J].
const TOLERATED_UNSERVED_J: f64 = 3600.0;

/// A run in progress; a copy of it is a snapshot.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Run {
    /// State of the vehicle.
    pub state: State,
    /// Memory of the HPCU.
    pub memory: HpcuState,
    /// Steps done.
    pub steps: usize,
    /// Result of the last step.
    pub record: Option<StepRecord>,
    /// Totals so far.
    pub summary: Summary,
}

/// Columns of a run, one row a second, the state at the start included.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// Number of columns, those of [`signals::all`].
    pub columns: usize,
    /// Values, row by row.
    pub values: Vec<f64>,
    /// Totals.
    pub summary: Summary,
    /// Why it ended.
    pub end: EndReason,
}

impl Experiment {
    /// Loads a scenario; overrides are prefixed with `vehicle.`, `controller.` or `scenario.`.
    ///
    /// # Errors
    /// Anything wrong in one of its files or in an override.
    pub fn load(scenario: &str, controller: Option<&str>, overrides: &[Override]) -> PlantResult<Self> {
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
        let scenario: ScenarioParameters = library::load(Kind::Scenario, scenario, &part("scenario"))?;
        let controller = controller.unwrap_or(&scenario.controller).to_owned();
        let rules = Arc::new(Controller::load(&controller, &part("controller"))?);
        Ok(Self {
            plant: Arc::new(Plant::load(&scenario.vehicle, &part("vehicle"))?),
            cycle: DriveCycle::load(&scenario.cycle)?,
            controller: controller.into(),
            hpcu: Arc::new(Hpcu::of(&rules, &scenario.strategy, scenario.climate.ambient_temperature_degc)),
            rules,
            air: scenario.climate.air(),
            climate: scenario.climate.clone(),
            initial: scenario.initial.clone(),
            scenario: Arc::new(scenario),
        })
    }

    /// The same with each second integrated in several sub-steps; controllers stay at 1 s.
    #[must_use]
    pub fn with_substeps(mut self, substeps: u32) -> Self {
        self.plant = Arc::new(Arc::unwrap_or_clone(self.plant).with_substeps(substeps));
        self
    }

    /// The vehicle before the first step.
    #[must_use]
    pub fn start(&self) -> Run {
        let state = self.plant.parked(&self.initial);
        Run { memory: self.hpcu.awake(&state), state, steps: 0, record: None, summary: Summary::default() }
    }

    /// What the surroundings do during a step.
    #[must_use]
    pub fn disturbance(&self, step: usize) -> Disturbance {
        let speeds = self.cycle.speeds_m_s();
        let at = |second: usize| speeds[second.min(speeds.len() - 1)];
        Disturbance {
            start_speed_m_s: at(step),
            end_speed_m_s: at(step + 1),
            air: self.air,
            solar_gain_w: self.climate.solar_gain_w,
            occupants: f64::from(self.climate.occupants),
        }
    }

    /// Command of the HPCU, heatDemandCommander and connection schedule for the next step.
    pub fn rule_based_command(&self, run: &mut Run) -> Command {
        let time_s = run.state.time_s;
        let requests_w = heat_demand_commander::requests_w(&self.scenario.heat_demand, time_s);
        let mut demand = self.hpcu.demand(&self.plant, &run.state, &mut run.memory, &requests_w);
        heat_demand_commander::apply_schedule(
            &self.scenario.connection_schedule,
            time_s,
            &mut demand.connections,
        );
        self.plant.ranges.encode(&demand)
    }

    /// One step with a command; tells why the run is over, if it is.
    pub fn step(&self, run: &mut Run, command: &Command) -> Option<EndReason> {
        let disturbance = self.disturbance(run.steps);
        let nodes = &self.plant.assembly.nodes;
        let supplies_before_k =
            [nodes.htc_supply, nodes.chiller_supply].map(|node| run.state.temperatures_k[node.index()]);
        let record = run.record.get_or_insert_default();
        self.plant.step_into(&mut run.state, command, &disturbance, record);
        run.steps += 1;
        run.summary.add(&self.plant, supplies_before_k, &run.state, record, &disturbance);
        if run.summary.energy_j(Flow::Unserved) > TOLERATED_UNSERVED_J {
            Some(EndReason::UnservedEnergy)
        } else if run.summary.final_soc() <= 0.0 {
            Some(EndReason::BatteryEmpty)
        } else if run.steps >= self.cycle.duration_s() {
            Some(EndReason::Arrived)
        } else {
            None
        }
    }

    /// Appends everything that can be seen of a run now, one value a signal.
    pub fn look(&self, run: &Run, row: &mut Vec<f64>) {
        let disturbance = self.disturbance(run.steps.saturating_sub(1));
        let view = View {
            plant: &self.plant,
            state: &run.state,
            record: run.record.as_ref(),
            disturbance: &disturbance,
        };
        row.extend(signals::all().map(|signal| signal.read(&view)));
    }

    /// Runs to the end with the rule-based controller.
    #[must_use]
    pub fn simulate(&self) -> Trajectory {
        let columns = signals::all().count();
        let mut values = Vec::with_capacity(columns * (self.cycle.duration_s() + 1));
        let mut run = self.start();
        self.look(&run, &mut values);
        let end = loop {
            let command = self.rule_based_command(&mut run);
            let end = self.step(&mut run, &command);
            self.look(&run, &mut values);
            if let Some(reason) = end {
                break reason;
            }
        };
        Trajectory { columns, values, summary: run.summary, end }
    }

    /// Runs to the end with the rule-based controller, keeping totals only.
    #[must_use]
    pub fn totals(&self) -> (Summary, EndReason) {
        let mut run = self.start();
        loop {
            let command = self.rule_based_command(&mut run);
            if let Some(reason) = self.step(&mut run, &command) {
                return (run.summary, reason);
            }
        }
    }
}
