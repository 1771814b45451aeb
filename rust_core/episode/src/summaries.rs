//! Totals of many different runs, side by side.

use crate::guard::caught;
use crate::side_by_side::side_by_side;
use hp_plant::config::library::Override;
use hp_plant::error::PlantResult;
use hp_trip::experiment::Experiment;
use hp_trip::run::EndReason;
use std::sync::atomic::{AtomicBool, Ordering};

/// A run that is yet to be loaded.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// Name or path of the scenario.
    pub scenario: String,
    /// Name or path of a controller, where not the scenario's own.
    pub controller: Option<String>,
    /// Name or path of a vehicle, where not that of the scenario.
    pub vehicle: Option<String>,
    /// Changes of single values.
    pub overrides: Vec<Override>,
    /// Steps of the plant in each second.
    pub substeps: u32,
}

/// Totals of a run by name, and why it ended.
pub type Summarised = (Vec<(String, Option<f64>)>, EndReason);

impl PlannedRun {
    /// Loads the run and drives it to its end; nothing where it was given up.
    fn drive(&self, over: &AtomicBool) -> PlantResult<Option<Summarised>> {
        let (vehicle, controller) = (self.vehicle.as_deref(), self.controller.as_deref());
        let experiment = Experiment::with_vehicle(&self.scenario, vehicle, controller, &self.overrides)?
            .with_substeps(self.substeps);
        let go_on = || if over.load(Ordering::Relaxed) { Err(()) } else { Ok(()) };
        let driven = experiment.totals_while(go_on).ok();
        Ok(driven.map(|(summary, end)| (summary.values(experiment.plant.layout()), end)))
    }
}

/// Drives runs to their ends on so many threads; what cannot be loaded is an error of its own, and the others go on.
///
/// # Errors
/// What `go_on` says, which is asked every now and then; runs that have begun then are given up.
pub fn summaries<E>(
    runs: &[PlannedRun],
    threads: usize,
    go_on: impl FnMut() -> Result<(), E>,
) -> Result<Vec<PlantResult<Summarised>>, E> {
    side_by_side(runs, threads.max(1), |run, over| caught(|| run.drive(over)).transpose(), go_on)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn planned(scenario: &str, ambient_degc: f64) -> PlannedRun {
        let change = format!("scenario.climate.ambient_temperature_degc={ambient_degc}");
        let overrides = vec![Override::parse(&change).expect("has a value")];
        PlannedRun { scenario: scenario.to_owned(), controller: None, vehicle: None, overrides, substeps: 1 }
    }

    #[test]
    fn summaries_are_those_of_each_run_in_order() {
        let runs = [
            planned("jeffs2019/case1-4", 5.0),
            planned("nowhere", 5.0),
            planned("jeffs2019/case1-4", -5.0),
            planned("jeffs2019/case1-4", 1000.0),
        ];
        let all = summaries(&runs, 3, || Ok::<(), ()>(())).expect("goes on");
        assert!(all.len() == 4 && all[1].is_err() && all[3].is_err());
        for place in [0, 2] {
            let experiment = Experiment::load(&runs[place].scenario, None, &runs[place].overrides);
            let experiment = experiment.expect("built in");
            let (summary, end) = experiment.totals();
            let expected = (summary.values(experiment.plant.layout()), end);
            assert_eq!(all[place].as_ref().expect("built in"), &expected);
        }
    }

    #[test]
    fn summaries_end_soon_after_they_are_told_to() {
        let runs = vec![planned("jeffs2019/case1-1", 0.0); 10_000];
        let began = Instant::now();
        assert_eq!(summaries(&runs, 2, || Err("stop")).expect_err("told to stop"), "stop");
        assert!(began.elapsed() < Duration::from_secs(5));
    }
}
