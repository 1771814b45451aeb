//! Runs: an experiment driven from start to arrival.

use crate::controllers::RuleMemory;
use crate::experiment::Experiment;
use crate::pace::{LONGEST_DELAY_S, LONGEST_STANDSTILL_S, Pace};
use crate::summary::{Summary, supplies_k};
use hp_plant::command::{Command, Demand};
use hp_plant::plant::StepRecord;
use hp_plant::signals::View;
use hp_plant::state::State;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    /// The way of the cycle was driven to its end, perhaps late.
    Arrived,
    /// The usable state of charge reached zero.
    BatteryEmpty,
    /// The vehicle stood for [`LONGEST_STANDSTILL_S`] although its driver wanted to move.
    Immobile,
    /// The vehicle had not arrived [`LONGEST_DELAY_S`] after the end of its cycle.
    Late,
}

impl EndReason {
    /// Name used in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::BatteryEmpty => "battery_empty",
            Self::Immobile => "immobile",
            Self::Late => "late",
        }
    }
}

/// Steps of the plant between two looks at whether to go on: some tens of milliseconds.
const SUBSTEPS_BETWEEN_CHECKS: u32 = 10_000;

/// A run in progress; a copy of it is a snapshot.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Run {
    /// State of the vehicle.
    pub state: State,
    /// Memory of the rules.
    pub memory: RuleMemory,
    /// Where it is on its cycle.
    pub pace: Pace,
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
    /// Number of columns, those of the plant's signals.
    pub columns: usize,
    /// Values, row by row.
    pub values: Vec<f64>,
    /// Totals.
    pub summary: Summary,
    /// Why it ended.
    pub end: EndReason,
}

impl Experiment {
    /// The vehicle before the first step.
    #[must_use]
    pub fn start(&self) -> Run {
        let state = self.plant.parked_in(&self.initial, self.ambient_humidity_ratio);
        Run {
            memory: self.rules.awake(&self.plant, &state, &self.scenario.settings.at(0)),
            state,
            pace: Pace::start(&self.cycle),
            steps: 0,
            record: None,
            summary: Summary::default(),
        }
    }

    /// Demand of the rules, heatDemandCommander and connection schedule for the next step.
    #[must_use]
    pub fn demand(&self, run: &mut Run) -> Demand {
        let mut demand = *self.commander.constant();
        self.enter_demand(run, &mut demand);
        demand
    }

    #[inline(always)]
    fn enter_demand(&self, run: &mut Run, demand: &mut Demand) {
        let time_s = run.state.time_s;
        self.commander.change_requests(time_s, demand);
        let settings = self.scenario.settings.at(run.steps);
        self.rules.demand(&self.plant, &run.state, &settings, &mut run.memory, demand);
        self.commander.apply_schedule(time_s, demand);
    }

    /// [`Self::demand`] as a command.
    pub fn rule_based_command(&self, run: &mut Run) -> Command {
        let mut demand = *self.commander.constant();
        self.enter_demand(run, &mut demand);
        self.plant.ranges.encode(&demand)
    }

    /// One step with a command; tells why the run is over, if it is.
    pub fn step(&self, run: &mut Run, command: &Command) -> Option<EndReason> {
        let disturbance = self.next_disturbance(run.steps, &run.pace);
        let supplies_before_k = supplies_k(self.plant.layout(), &run.state);
        let record = run.record.get_or_insert_default();
        self.plant.step_into(&mut run.state, command, &disturbance, record);
        let (wanted_m_s, end_m_s) = (disturbance.end_speed_m_s, record.end_speed_m_s);
        run.pace.drove(&self.cycle, run.steps, wanted_m_s, end_m_s);
        run.steps += 1;
        let delay_s = run.steps.saturating_sub(self.cycle.duration_s());
        run.summary.add(&self.plant, &supplies_before_k, &run.state, record, &disturbance);
        run.summary.keep_pace(delay_s, &run.pace);
        if run.summary.final_soc() <= 0.0 {
            Some(EndReason::BatteryEmpty)
        } else if run.pace.arrived(&self.cycle, run.steps) {
            Some(EndReason::Arrived)
        } else if run.pace.stuck_s >= LONGEST_STANDSTILL_S {
            Some(EndReason::Immobile)
        } else if delay_s >= LONGEST_DELAY_S {
            Some(EndReason::Late)
        } else {
            None
        }
    }

    /// Appends everything that can be seen of a run now, one value a signal.
    pub fn look(&self, run: &Run, row: &mut Vec<f64>) {
        let disturbance = self.last_disturbance(run.steps, &run.pace);
        let view = View {
            plant: &self.plant,
            state: &run.state,
            record: run.record.as_ref(),
            disturbance: &disturbance,
        };
        row.extend(self.plant.signals.rows().iter().map(|signal| signal.reader.read(&view)));
    }

    /// Runs to the end with the rule-based controller.
    #[must_use]
    pub fn simulate(&self) -> Trajectory {
        let Ok(trajectory) = self.simulate_while(|| Ok::<(), Infallible>(()));
        trajectory
    }

    /// [`Self::simulate`], unless it is given up.
    ///
    /// # Errors
    /// What `go_on` says, which is asked every now and then.
    pub fn simulate_while<E>(&self, go_on: impl FnMut() -> Result<(), E>) -> Result<Trajectory, E> {
        let columns = self.plant.signals.rows().len();
        let mut values = Vec::with_capacity(columns * (self.cycle.duration_s() + 1));
        let (summary, end) = self.drive(go_on, |run| self.look(run, &mut values))?;
        Ok(Trajectory { columns, values, summary, end })
    }

    /// Runs to the end with the rule-based controller, keeping totals only.
    #[must_use]
    pub fn totals(&self) -> (Summary, EndReason) {
        let Ok(totals) = self.totals_while(|| Ok::<(), Infallible>(()));
        totals
    }

    /// [`Self::totals`], unless it is given up.
    ///
    /// # Errors
    /// What `go_on` says, which is asked every now and then.
    pub fn totals_while<E>(&self, go_on: impl FnMut() -> Result<(), E>) -> Result<(Summary, EndReason), E> {
        self.drive(go_on, |_| ())
    }

    /// Drives to the end, looking at the start and after each step.
    #[inline]
    fn drive<E>(
        &self,
        mut go_on: impl FnMut() -> Result<(), E>,
        mut look: impl FnMut(&Run),
    ) -> Result<(Summary, EndReason), E> {
        let between_checks = (SUBSTEPS_BETWEEN_CHECKS / self.plant.substeps_a_second()).max(1) as usize;
        let mut run = self.start();
        look(&run);
        loop {
            let command = self.rule_based_command(&mut run);
            let end = self.step(&mut run, &command);
            look(&run);
            if let Some(reason) = end {
                return Ok((run.summary, reason));
            }
            if run.steps.is_multiple_of(between_checks) {
                go_on()?;
            }
        }
    }
}
