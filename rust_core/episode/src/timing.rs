//! Time that a plant step takes, measured over whole trips.

use crate::action::{ActionTable, FittedActions, GROUPS};
use crate::defaults::Defaults;
use crate::random::Random;
use crate::rows::RowSet;
use hp_plant::command::Command;
use hp_plant::error::PlantResult;
use hp_plant::plant::StepRecord;
use hp_trip::experiment::Experiment;
use hp_trip::run::Run;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Time of all steps of a trip with the compressor on, and their number.
///
/// With a seed each second has random levels of the default actions; otherwise the HPCU drives, and its time
/// counts. The clock is read where the compressor starts and stops, not in between.
///
/// # Errors
/// None with the actuators that there are.
pub fn compressor_on_steps(experiment: &Experiment, seed: Option<u64>) -> PlantResult<(Duration, usize)> {
    let random = seed.map(|seed| random_commands(experiment, seed)).transpose()?;
    let mut record = StepRecord::default();
    let mut step = |run: &mut Run| {
        let command = match &random {
            Some(commands) => commands[run.steps],
            None => experiment.rule_based_command(run),
        };
        let disturbance = experiment.disturbance(run.steps);
        run.steps += 1;
        experiment.plant.step_into(&mut run.state, &command, &disturbance, &mut record);
        record.refrigeration.running()
    };
    let mut rehearsal = experiment.start();
    let running: Vec<bool> = (0..experiment.cycle.duration_s()).map(|_| step(&mut rehearsal)).collect();
    let mut run = experiment.start();
    let mut spent = Duration::ZERO;
    for stretch in running.chunk_by(|one, next| one == next) {
        let start = Instant::now();
        for _ in stretch {
            black_box(step(&mut run));
        }
        if stretch[0] {
            spent += start.elapsed();
        }
    }
    Ok((spent, running.into_iter().filter(|&running| running).count()))
}

fn random_commands(experiment: &Experiment, seed: u64) -> PlantResult<Vec<Command>> {
    let layout = experiment.plant.layout();
    let table = ActionTable::new(&[GROUPS[0].to_owned()], &RowSet::of([layout])?, &BTreeMap::new())?;
    let actions = FittedActions::of(&table, layout);
    let defaults = Defaults::of(experiment);
    let mut random = Random::seeded(seed);
    let commands = (0..experiment.cycle.duration_s()).map(|second| {
        let options = table.option_counts().iter().enumerate();
        let values: Vec<f32> =
            options.map(|(column, &count)| table.value(column, random.index(count))).collect();
        defaults.complete(&actions, &values, experiment, second as f64)
    });
    Ok(commands.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_plant::circuits::refrigeration_loop::Limit;
    use hp_plant::config::library;
    use hp_trip::kinds::SCENARIO;

    #[test]
    fn the_steps_timed_are_those_with_the_compressor_on() {
        let experiment = Experiment::load("jeffs2019/case1-4", None, &[]).expect("built in");
        let mut run = experiment.start();
        let mut running = 0;
        for _ in 0..experiment.cycle.duration_s() {
            let command = experiment.rule_based_command(&mut run);
            experiment.step(&mut run, &command);
            running += usize::from(run.record.is_some_and(|record| record.refrigeration.running()));
        }
        let (spent, steps) = compressor_on_steps(&experiment, None).expect("built in");
        assert_eq!(steps, running);
        assert!(steps > 600 && spent > Duration::ZERO);
    }

    /// Two limits often meet at nearly the same speed then; Newton must not jump to and fro between them.
    #[test]
    fn random_actions_hardly_ever_need_bracketing() {
        let (mut solved, mut bracketed) = (0, 0);
        let scenarios = library::names(SCENARIO);
        for (seed, scenario) in scenarios.iter().enumerate() {
            let experiment = Experiment::load(scenario, None, &[]).expect("built in");
            let mut run = experiment.start();
            for command in random_commands(&experiment, seed as u64).expect("built in") {
                if experiment.step(&mut run, &command).is_some() {
                    break;
                }
                let refrigeration = run.record.expect("a step was made").refrigeration;
                solved += u32::from(refrigeration.iterations > 0);
                bracketed +=
                    u32::from(refrigeration.bracketed && refrigeration.limited_by != Limit::Discharge);
            }
        }
        assert!(solved > 5000 && bracketed * 2000 < solved, "{bracketed} of {solved}");
    }

    #[test]
    fn random_actions_start_the_compressor() {
        let experiment = Experiment::load("jeffs2019/case1-4", None, &[]).expect("built in");
        let (_, steps) = compressor_on_steps(&experiment, Some(1)).expect("built in");
        assert!(steps > 100 && steps < experiment.cycle.duration_s(), "{steps} steps");
    }
}
