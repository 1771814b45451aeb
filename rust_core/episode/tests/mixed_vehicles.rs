//! Cars of different architectures in one vector: rows by name, each car as if it were alone.

use hp_episode::action::LEVELS;
use hp_episode::episode::{Clock, Episode};
use hp_episode::random::Random;
use hp_episode::rows::ActionRow;
use hp_episode::setup::{Origin, Settings, Setup};
use hp_episode::vector::{Actions, Autoreset, Extras, PARTS, Results, Vector};
use hp_plant::command::Scale;
use hp_plant::error::PlantError;
use std::collections::BTreeMap;
use std::sync::Arc;

const WITHOUT_STORE: &str = "jeffs2019-no-thermal-battery";

fn origin(vehicle: Option<String>) -> Origin {
    Origin { scenario: Some("ours/commute-minus5".to_owned()), vehicle, ..Origin::default() }
}

/// Steps environments and gives back observations and rewards, environment by environment.
struct Driven {
    setup: Arc<Setup>,
    vector: Vector,
    observations: Vec<f32>,
    rewards: Vec<f64>,
}

impl Driven {
    fn new(settings: &Settings, vehicles: &[Option<String>]) -> Self {
        let origins: Vec<Origin> = vehicles.iter().cloned().map(origin).collect();
        let (setup, sources) = Setup::new(settings, &origins).expect("vehicles");
        let episodes = sources.into_iter().map(|source| Episode::new(Arc::clone(&setup), source)).collect();
        let mut vector = Vector::new(episodes, Autoreset::NextStep, None, 1);
        for index in 0..vehicles.len() {
            vector.reset(index, Some(1), None).expect("a scenario");
        }
        let (count, width) = (vehicles.len(), setup.observations.rows().len());
        Self { setup, vector, observations: vec![0.0; count * width], rewards: vec![0.0; count] }
    }

    fn step(&mut self, levels: &[i64]) {
        let count = self.rewards.len();
        let (mut terminated, mut truncated) = (vec![false; count], vec![false; count]);
        let mut results = Results {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
            parts: &mut vec![0.0; count * PARTS],
            extras: Extras::default(),
        };
        self.vector.step(Actions::Levels(levels), &mut results).expect("a scenario");
    }

    fn action_names(&self) -> Vec<String> {
        self.setup.actions.rows().iter().map(|row| row.name.clone()).collect()
    }

    /// Observation of an environment by name.
    fn observed(&self, index: usize) -> BTreeMap<&str, f32> {
        let rows = self.setup.observations.rows();
        let values = &self.observations[index * rows.len()..(index + 1) * rows.len()];
        rows.iter().map(|row| row.name.as_str()).zip(values.iter().copied()).collect()
    }

    /// Names of the options of a row; numbers for levels.
    fn options(&self, column: usize) -> Vec<String> {
        match &self.setup.actions.rows()[column].scale {
            Scale::Choice(options) => options.clone(),
            _ => (0..LEVELS).map(|level| level.to_string()).collect(),
        }
    }

    /// Which options of an environment are granted, by name.
    fn mask(&self, index: usize) -> BTreeMap<(String, String), bool> {
        let table = &self.setup.actions;
        let mut mask = vec![false; table.mask_length()];
        self.vector.episodes()[index].write_mask(&mut mask);
        let rows = table.rows().iter().enumerate();
        let keys =
            rows.flat_map(|(column, row)| self.options(column).into_iter().map(|o| (row.name.clone(), o)));
        keys.zip(mask).collect()
    }

    /// Levels of these environments that mean what those of others do; the first option where these lack it.
    fn levels_of(&self, others: &Self, levels: &[i64]) -> Vec<i64> {
        let rows = self.setup.actions.rows().iter().enumerate();
        let level = |(column, row): (usize, &ActionRow)| {
            let place = others.action_names().iter().position(|name| *name == row.name).expect("shared");
            let wanted = &others.options(place)[levels[place] as usize];
            self.options(column).iter().position(|option| option == wanted).unwrap_or(0) as i64
        };
        rows.map(level).collect()
    }
}

#[test]
fn each_car_drives_and_sees_what_it_does_alone() {
    let cars = [None, Some("no-thermal-battery"), Some("direct"), Some("three-loops"), Some("ptc-only")]
        .map(|name| name.map(|name| format!("jeffs2019-{name}")));
    let mut together = Driven::new(&Settings::default(), &cars);
    let mut alone: Vec<Driven> =
        cars.iter().map(|car| Driven::new(&Settings::default(), std::slice::from_ref(car))).collect();
    let mut random = Random::seeded(3);
    for second in 0..400 {
        let counts = together.setup.actions.option_counts().to_vec();
        let levels: Vec<i64> = counts.iter().map(|&count| random.index(count) as i64).collect();
        together.step(&levels.repeat(cars.len()));
        for (index, single) in alone.iter_mut().enumerate() {
            let own: Vec<i64> = single.levels_of(&together, &levels);
            single.step(&own);
            assert_eq!(together.rewards[index], single.rewards[0], "car {index}, second {second}");
            let (shared, own) = (together.observed(index), single.observed(0));
            for (name, value) in &own {
                // Options that the car lacks make the parts of a previous action's range narrower.
                if !name.starts_with("previous_") {
                    assert_eq!(shared[name], *value, "car {index}, second {second}: {name}");
                }
            }
            let (shared, own) = (together.mask(index), single.mask(0));
            for (key, granted) in &shared {
                let first = ["isolated", "off", "closed", "0"].contains(&key.1.as_str());
                let expected = own.get(key).copied().unwrap_or(first);
                assert_eq!(*granted, expected, "car {index}, second {second}: {key:?}");
            }
        }
    }
}

#[test]
fn what_a_car_lacks_is_masked_ignored_and_reads_as_zero() {
    let mut together = Driven::new(&Settings::default(), &[None, Some(WITHOUT_STORE.to_owned())]);
    let row = together
        .action_names()
        .iter()
        .position(|name| name == "thermal_battery")
        .expect("the paper's car has it");
    let mut levels = vec![0_i64; together.setup.actions.rows().len()];
    levels[row] = 1;
    for _ in 0..10 {
        together.step(&[levels.clone(), levels.clone()].concat());
    }
    let mask = together.mask(1);
    let granted = ["isolated", "htc", "chiller"].map(|o| mask[&("thermal_battery".to_owned(), o.to_owned())]);
    assert_eq!(granted, [true, false, false]);
    let seen = together.observed(1);
    assert_eq!(seen["previous_thermal_battery"], 0.0);
    // 0 degC between -40 and 100.
    assert!((seen["thermal_battery_temperature_degc"] - (80.0 / 140.0 - 1.0)).abs() < 1e-6);
    assert_eq!(seen["thermal_battery_on_htc"], -1.0);
    let ruled = {
        let mut levels = vec![9; together.setup.actions.rows().len()];
        together.vector.episodes_mut()[1].rule_based_levels(&mut levels);
        levels[row]
    };
    assert_eq!(ruled, 0);
}

#[test]
fn a_state_of_another_architecture_or_of_other_numbers_says_what_it_is_of() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml");
    let write = |mass_kg: f64| {
        std::fs::write(&file, format!("base = \"{WITHOUT_STORE}\"\n[body]\nmass_kg = {mass_kg:?}\n"))
            .expect("written");
    };
    write(2400.0);
    let mine = Some(file.to_str().expect("plain name").to_owned());
    let paper = Driven::new(&Settings::default(), &[None]);
    let other = Driven::new(&Settings::default(), std::slice::from_ref(&mine));
    let bytes = other.vector.to_bytes(0).expect("plain data");
    let error = paper.vector.episodes()[0].read(&bytes).expect_err("another architecture");
    assert!(matches!(error, PlantError::State { .. }));
    let message = error.to_string();
    assert!(
        message.contains("architecture `no-thermal-battery`), but this one has vehicle `jeffs2019`"),
        "{message}"
    );

    assert_eq!(other.vector.episodes()[0].read(&bytes).expect("its own").clock, Clock::default());
    write(2500.0);
    let changed = Driven::new(&Settings::default(), &[mine]);
    let message = changed.vector.episodes()[0].read(&bytes).expect_err("other numbers").to_string();
    assert!(message.contains("whose parameters were others"), "{message}");
}

#[test]
fn states_of_several_environments_go_back_all_or_none() {
    let mut together = Driven::new(&Settings::default(), &[None, Some(WITHOUT_STORE.to_owned())]);
    let width = together.setup.actions.rows().len();
    let states =
        [together.vector.to_bytes(0).expect("plain data"), together.vector.to_bytes(1).expect("plain data")];
    together.step(&vec![0; width * 2]);
    let moved = together.vector.to_bytes(0).expect("plain data");
    let damaged = &states[1][..states[1].len() - 1];
    assert!(together.vector.restore(&[(0, &states[0]), (1, damaged)]).is_err());
    assert_eq!(together.vector.to_bytes(0).expect("plain data"), moved);
    together.vector.restore(&[(0, &states[0]), (1, &states[1])]).expect("its own");
    assert_eq!(together.vector.to_bytes(0).expect("plain data"), states[0]);
}

#[test]
fn settings_name_the_vehicle_of_environments_that_name_none() {
    let settings = Settings { vehicle: Some(WITHOUT_STORE.to_owned()), ..Settings::default() };
    let driven = Driven::new(&settings, &[None]);
    assert!(!driven.action_names().iter().any(|name| name == "thermal_battery"));
    let refused = Settings { actions: vec!["thermal_batery".to_owned()], ..Settings::default() };
    let message = Setup::new(&refused, &[origin(None)]).expect_err("misspelt").to_string();
    assert!(message.ends_with("(nearest: thermal_battery)"), "{message}");
}
