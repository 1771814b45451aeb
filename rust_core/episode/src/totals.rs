//! Totals of many trips, side by side.

use crate::side_by_side::side_by_side;
use hp_plant::config::library::Override;
use hp_plant::error::PlantResult;
use hp_plant::plant::Plant;
use hp_trip::experiment::Experiment;
use hp_trip::run::EndReason;
use hp_trip::summary::Summary;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::available_parallelism;

/// Totals of a trip, why it ended, and its vehicle.
pub type Driven = (Summary, EndReason, Arc<Plant>);

/// Drives several scenarios to their ends with the same overrides.
///
/// # Errors
/// What `go_on` says, which is asked every now and then; trips that have begun then are given up.
pub fn totals<E>(
    scenarios: &[String],
    vehicle: Option<&str>,
    overrides: &[Override],
    go_on: impl FnMut() -> Result<(), E>,
) -> Result<Vec<PlantResult<Driven>>, E> {
    let drive = |name: &String, over: &AtomicBool| {
        let experiment = Experiment::with_vehicle(name, vehicle, None, overrides)?;
        let go_on = || if over.load(Ordering::Relaxed) { Err(()) } else { Ok(()) };
        Ok(experiment.totals_while(go_on).ok().map(|(summary, end)| (summary, end, experiment.plant)))
    };
    let threads = available_parallelism().map_or(1, usize::from);
    side_by_side(scenarios, threads, |name, over| drive(name, over).transpose(), go_on)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn totals_of_many_trips_are_those_of_each_in_order() {
        let names = ["jeffs2019/case1-1", "nowhere", "jeffs2019/case1-4"].map(str::to_owned);
        let all = totals(&names, None, &[], || Ok::<(), ()>(())).expect("goes on");
        assert!(all[1].is_err() && all.len() == 3);
        for place in [0, 2] {
            let (summary, end) = Experiment::load(&names[place], None, &[]).expect("built in").totals();
            let driven = all[place].as_ref().expect("built in");
            assert_eq!((driven.0.final_soc(), driven.1), (summary.final_soc(), end));
        }
    }

    #[test]
    fn totals_end_soon_after_they_are_told_to() {
        let names = vec!["jeffs2019/case1-1".to_owned(); 100_000];
        let began = Instant::now();
        assert_eq!(totals(&names, None, &[], || Err("stop")).expect_err("told to stop"), "stop");
        assert!(began.elapsed() < Duration::from_secs(5));
    }
}
