//! Vehicles, cycles and scenarios, each loaded once and shared by all episodes.

use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::Override;
use hp_plant::config::{Validate, Violation};
use hp_plant::error::PlantResult;
use hp_plant::plant::Plant;
use hp_trip::drive_cycle::DriveCycle;
use hp_trip::experiment::Experiment;
use hp_trip::scenario::ClimateParameters;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What defines a trip: plain data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trip {
    /// Scenario that gives all that is not below.
    pub origin: Arc<str>,
    /// Vehicle, where not that of the scenario.
    pub vehicle: Option<Arc<str>>,
    /// Drive cycle.
    pub cycle: Arc<str>,
    /// Climate.
    pub climate: ClimateParameters,
    /// Initial state.
    pub initial: InitialParameters,
    /// Part of the cycle that is driven [s]; the whole where absent.
    pub window: Option<(usize, usize)>,
}

/// Loaded parts by name, with the overrides that apply to all of them.
#[derive(Debug, Default)]
pub struct Garage {
    overrides: Vec<Override>,
    shelves: Mutex<Shelves>,
}

#[derive(Debug, Default)]
struct Shelves {
    experiments: HashMap<(String, Option<String>), Arc<Experiment>>,
    plants: HashMap<String, Arc<Plant>>,
    cycles: HashMap<String, DriveCycle>,
}

impl Garage {
    /// An empty garage whose scenarios are loaded with overrides.
    #[must_use]
    pub fn new(overrides: Vec<Override>) -> Self {
        Self { overrides, shelves: Mutex::default() }
    }

    fn shelves(&self) -> MutexGuard<'_, Shelves> {
        // Whatever a panicking thread left on the shelves is complete.
        self.shelves.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A scenario by name or path, with its own vehicle or another one.
    ///
    /// # Errors
    /// Anything wrong in one of its files or in an override, or a member that the vehicle cannot have.
    pub fn experiment(&self, name: &str, vehicle: Option<&str>) -> PlantResult<Arc<Experiment>> {
        let mut shelves = self.shelves();
        let key = (name.to_owned(), vehicle.map(str::to_owned));
        if let Some(experiment) = shelves.experiments.get(&key) {
            return Ok(Arc::clone(experiment));
        }
        let mut experiment = Experiment::with_vehicle(name, vehicle, None, &self.overrides)?;
        check_constant(name, &experiment)?;
        let vehicle = experiment.scenario.vehicle.clone();
        experiment.plant = Arc::clone(shelves.plants.entry(vehicle).or_insert(experiment.plant));
        let cycle = experiment.scenario.cycle.clone();
        experiment.cycle = shelves.cycles.entry(cycle).or_insert(experiment.cycle).clone();
        let experiment = Arc::new(experiment);
        shelves.experiments.insert(key, Arc::clone(&experiment));
        Ok(experiment)
    }

    /// A drive cycle by name or path.
    ///
    /// # Errors
    /// There is none of that name, or its file is no cycle.
    pub fn cycle(&self, name: &str) -> PlantResult<DriveCycle> {
        let mut shelves = self.shelves();
        if let Some(cycle) = shelves.cycles.get(name) {
            return Ok(cycle.clone());
        }
        let cycle = DriveCycle::load(name)?;
        shelves.cycles.insert(name.to_owned(), cycle.clone());
        Ok(cycle)
    }

    /// The trip of a scenario file, with its own vehicle or another one.
    ///
    /// # Errors
    /// See [`Self::experiment`].
    pub fn trip(&self, name: &str, vehicle: Option<&str>) -> PlantResult<Trip> {
        let experiment = self.experiment(name, vehicle)?;
        Ok(Trip {
            origin: name.into(),
            vehicle: vehicle.map(Into::into),
            cycle: experiment.scenario.cycle.as_str().into(),
            climate: experiment.climate.clone(),
            initial: experiment.initial.clone(),
            window: None,
        })
    }

    /// Checks what a trip says as if a scenario file said it, and that its part of the cycle is there.
    ///
    /// # Errors
    /// The first that is not right, or its cycle cannot be loaded.
    pub fn check(&self, trip: &Trip) -> PlantResult<()> {
        let climate = trip.climate.validate().map_err(|violation| violation.within("climate"));
        climate
            .and_then(|()| trip.initial.validate().map_err(|violation| violation.within("initial")))
            .map_err(|violation| violation.in_file("trip"))?;
        let duration_s = self.cycle(&trip.cycle)?.duration_s();
        match trip.window {
            Some((first_s, last_s)) if first_s >= last_s || last_s > duration_s => {
                let allowed = format!("must be a part of the cycle's {duration_s} s");
                Err(Violation::new("window", format!("{first_s} to {last_s} s"), allowed).in_file("trip"))
            }
            _ => Ok(()),
        }
    }

    /// Makes a trip ready to drive.
    ///
    /// # Errors
    /// Its origin or cycle cannot be loaded.
    pub fn build(&self, trip: Trip) -> PlantResult<Experiment> {
        let origin = self.experiment(&trip.origin, trip.vehicle.as_deref())?;
        let mut cycle = self.cycle(&trip.cycle)?;
        if let Some((first_s, last_s)) = trip.window {
            cycle = cycle.window(first_s, last_s);
        }
        let ambient = trip.climate.ambient_temperature_degc;
        let rules = origin.controller_file.at(ambient, &origin.scenario.strategy, origin.plant.layout());
        Ok(Experiment {
            // Nearly all trips have the controller of their origin.
            rules: if rules == *origin.rules { Arc::clone(&origin.rules) } else { Arc::new(rules) },
            scenario: Arc::clone(&origin.scenario),
            weather: None,
            air: trip.climate.air(),
            ambient_humidity_ratio: trip.climate.humidity_ratio(),
            climate: trip.climate,
            initial: trip.initial,
            plant: Arc::clone(&origin.plant),
            cycle,
            controller: origin.controller.clone(),
            controller_file: Arc::clone(&origin.controller_file),
            commander: Arc::clone(&origin.commander),
        })
    }
}

/// Checks that a scenario leaves to episodes what they draw or decide.
fn check_constant(name: &str, experiment: &Experiment) -> PlantResult<()> {
    let scenario = &experiment.scenario;
    let refused = |key: &str, allowed: &str| Err(Violation::new(key, "given", allowed).in_file(name));
    if scenario.climate_series.is_some() {
        return refused("climate.series", "must not be: the climate of an episode is constant");
    }
    match scenario.settings.first_key() {
        Some(key) => refused(
            &format!("settings.{key}"),
            "must not be: in an episode the agent, or the controller where it decides, has these settings",
        ),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_plant::config::Celsius;

    #[test]
    fn a_trip_that_no_file_could_describe_is_refused() {
        let garage = Garage::default();
        let trip = garage.trip("jeffs2019/case1-1", None).expect("built in");
        assert_eq!(garage.check(&trip), Ok(()));
        let duration_s = garage.cycle(&trip.cycle).expect("built in").duration_s();
        for window in [(0, duration_s + 1), (5, 5), (9, 3), (0, usize::MAX)] {
            let error =
                garage.check(&Trip { window: Some(window), ..trip.clone() }).expect_err("no such part");
            assert!(error.to_string().contains("part of the cycle"), "{error}");
        }
        let mut hot = trip.clone();
        hot.initial.set("cabin", Some(Celsius(315.0)));
        assert!(garage.check(&hot).is_err());
        let mut strange = trip;
        strange.climate.solar_gain_w = f64::NAN;
        assert!(garage.check(&strange).is_err());
    }
}
