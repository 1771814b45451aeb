//! What the benchmarks drive: stretches of built-in scenarios, prepared so that only the steps are timed.

use hp_plant::command::Command;
use hp_plant::config::library;
use hp_plant::plant::StepRecord;
use hp_trip::controllers::rule_based::CabinMode;
use hp_trip::experiment::Experiment;
use hp_trip::kinds::SCENARIO;
use hp_trip::run::Run;
use std::hint::black_box;
use std::sync::Arc;

/// Commands of a stretch.
pub enum Driver {
    /// HPCU, part of what is timed.
    RuleBased,
    /// Commands made beforehand, one a second.
    Prepared(Vec<Command>),
}

/// What steps the thermal network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Executor {
    /// The one that was compiled for the architecture, where there is one.
    Own,
    /// The one for any architecture.
    Planned,
}

/// What drives the workloads.
#[derive(Debug, Clone)]
pub struct Car {
    /// What steps its thermal network.
    pub executor: Executor,
    /// Vehicle by name or path; that of each scenario where absent.
    pub vehicle: Option<String>,
}

impl Car {
    /// A built-in scenario driven with this car.
    fn experiment(&self, name: &str) -> Arc<Experiment> {
        let mut experiment =
            Experiment::with_vehicle(name, self.vehicle.as_deref(), None, &[]).expect("a vehicle that fits");
        if self.executor == Executor::Planned {
            experiment.plant = Arc::new(Arc::unwrap_or_clone(experiment.plant).with_planned_network());
        }
        Arc::new(experiment)
    }

    /// All built-in scenarios; of the paper's only for a vehicle of its own, which may lack what others speak of.
    fn scenarios(&self) -> Vec<&'static str> {
        let all = library::names(SCENARIO).into_iter();
        all.filter(|name| self.vehicle.is_none() || name.starts_with("jeffs2019/")).collect()
    }
}

/// A stretch of a run.
pub struct Segment {
    experiment: Arc<Experiment>,
    start: Run,
    /// Number of steps.
    pub steps: usize,
    driver: Driver,
}

impl Segment {
    /// Nodes and links of its vehicle's network.
    #[allow(dead_code, reason = "not every program that drives stretches says so")]
    pub fn network(&self) -> (usize, usize) {
        let layout = self.experiment.plant.layout();
        (layout.nodes.len(), layout.links.len())
    }

    /// Drives the stretch once; the sum of battery powers keeps the compiler honest.
    pub fn replay(&self) -> f64 {
        let mut run = self.start;
        let (mut sum, mut record) = (0.0, StepRecord::default());
        for step in 0..self.steps {
            self.step(&mut run, step, &mut record);
            sum += black_box(&record).battery_current_a;
        }
        sum
    }

    #[inline(always)]
    fn step(&self, run: &mut Run, step: usize, record: &mut StepRecord) {
        let command = match &self.driver {
            Driver::RuleBased => self.experiment.rule_based_command(run),
            Driver::Prepared(commands) => commands[step],
        };
        let disturbance = self.experiment.disturbance(run.steps);
        run.steps += 1;
        self.experiment.plant.step_into(&mut run.state, &command, &disturbance, record);
    }
}

/// Whether the compressor runs in each step of a run with the HPCU.
fn compressor_on(experiment: &Experiment) -> Vec<(Run, bool)> {
    let mut run = experiment.start();
    let mut steps = Vec::new();
    loop {
        let before = run;
        let command = experiment.rule_based_command(&mut run);
        let end = experiment.step(&mut run, &command);
        steps.push((before, run.record.is_some_and(|record| record.refrigeration.running())));
        if end.is_some() {
            return steps;
        }
    }
}

/// All stretches of the paper's nine scenarios during which the compressor runs.
pub fn compressor_on_segments(car: &Car) -> Vec<Segment> {
    let mut segments = Vec::new();
    for name in library::names(SCENARIO).iter().filter(|name| name.starts_with("jeffs2019/")) {
        let experiment = car.experiment(name);
        let steps = compressor_on(&experiment);
        let mut from = 0;
        while from < steps.len() {
            let length = steps[from..].iter().take_while(|(_, on)| *on).count();
            if length > 0 {
                segments.push(Segment {
                    experiment: Arc::clone(&experiment),
                    start: steps[from].0,
                    steps: length,
                    driver: Driver::RuleBased,
                });
            }
            from += length.max(1);
        }
    }
    segments
}

/// Whole trips of all built-in scenarios under actions drawn uniformly each second, as by an agent that knows
/// nothing: six connections, PTC and eleven levels of compressor power, or a compressor at rest; everything else as the
/// scenario has it.
pub fn random_segments(car: &Car, compressor_runs: bool) -> Vec<Segment> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let segment = |name: &&str| {
        let experiment = car.experiment(name);
        let (mut run, mut commands) = (experiment.start(), Vec::new());
        loop {
            let mut command = random_command(&experiment, &mut random);
            if let (Some(row), false) = (experiment.plant.layout().compressor_row, compressor_runs) {
                command.0[row] = -1.0;
            }
            commands.push(command);
            if experiment.step(&mut run, &command).is_some() {
                break;
            }
        }
        Segment {
            start: experiment.start(),
            experiment,
            steps: commands.len(),
            driver: Driver::Prepared(commands),
        }
    };
    car.scenarios().iter().map(segment).collect()
}

fn random_command(experiment: &Experiment, random: &mut Random) -> Command {
    let ranges = &experiment.plant.ranges;
    let layout = experiment.plant.layout();
    let mut demand = experiment.commander.requested(0.0);
    for member in &layout.members {
        if let Some(row) = member.connection_row {
            demand[row] = random.below(member.options.len() + 1) as f64;
        }
    }
    let cooling = layout.cabins[0].cooler.is_some_and(|cooler| {
        let branch = layout.branches[cooler];
        let row = layout.members[branch.member].connection_row;
        row.is_some_and(|row| demand[row] == branch.option as f64)
    });
    for heater in &layout.heaters {
        demand[heater.row] = random.below(2) as f64;
    }
    let mode = if cooling { CabinMode::Cooling } else { CabinMode::Heating };
    experiment.rules.constant_settings().enter(mode, experiment.rules.roles(), &mut demand);
    let mut command = ranges.encode(&demand);
    if let Some(row) = layout.compressor_row {
        command.0[row] = match random.below(11) {
            0 => -1.0,
            level => -0.9 + 1.9 * (level - 1) as f32 / 9.0,
        };
    }
    command
}

/// Marsaglia's xorshift: repeatable numbers without a dependency.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % count
    }
}
