//! Totals of many trips, side by side, on threads that live as long as the call: a fork has none to wait for.

use hp_plant::config::library::Override;
use hp_plant::error::PlantResult;
use hp_plant::plant::Plant;
use hp_trip::experiment::Experiment;
use hp_trip::run::EndReason;
use hp_trip::summary::Summary;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::{available_parallelism, scope};
use std::time::Duration;

/// So often the caller is asked whether to go on.
const BETWEEN_CHECKS: Duration = Duration::from_millis(50);

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
    mut go_on: impl FnMut() -> Result<(), E>,
) -> Result<Vec<PlantResult<Driven>>, E> {
    let (next, over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let drive = |name: &str| {
        let experiment = Experiment::with_vehicle(name, vehicle, None, overrides)?;
        let go_on = || if over.load(Ordering::Relaxed) { Err(()) } else { Ok(()) };
        Ok(experiment.totals_while(go_on).ok().map(|(summary, end)| (summary, end, experiment.plant)))
    };
    let workers = available_parallelism().map_or(1, usize::from).min(scenarios.len());
    let mut all: Vec<Option<PlantResult<Driven>>> = Vec::new();
    all.resize_with(scenarios.len(), || None);
    scope(|threads| {
        let (sender, receiver) = channel();
        for _ in 0..workers {
            let sender = sender.clone();
            let (next, over, drive) = (&next, &over, &drive);
            threads.spawn(move || {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    if place >= scenarios.len() || over.load(Ordering::Relaxed) {
                        return;
                    }
                    let driven = drive(&scenarios[place]).transpose();
                    let Some(driven) = driven else { return };
                    if sender.send((place, driven)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(BETWEEN_CHECKS) {
                Ok((place, driven)) => all[place] = Some(driven),
                // All are done, or one panicked, which goes on where the scope ends.
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Err(error) = go_on() {
                over.store(true, Ordering::Relaxed);
                return Err(error);
            }
        }
    })?;
    Ok(all.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

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
