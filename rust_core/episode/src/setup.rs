//! The settings of an environment, checked and made ready; shared by all its episodes.

use crate::action::{ActionTable, FittedActions};
use crate::garage::{Garage, Trip};
use crate::kinds::REWARD;
use crate::limits::{self, Narrow};
use crate::observation::{FittedObservations, ObservationTable};
use crate::reward::{self, RewardParameters};
use crate::rows::RowSet;
use crate::scenario_sampler::Distribution;
use crate::snapshot::{self, Identity};
use hp_plant::architecture::layout::Layout;
use hp_plant::config::library::{self, Override};
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::plant::Plant;
use hp_trip::experiment::Experiment;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// Longest control interval [s].
const LONGEST_INTERVAL_S: u32 = 3600;

/// Settings as they come from outside; what is not given is as in [`Settings::default`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Vehicle by name or path; that of the scenario where absent.
    pub vehicle: Option<String>,
    /// Continuous values instead of levels.
    pub continuous: bool,
    /// Actuators that the agent controls, in the order of an action; names of actuators or of groups of them.
    pub actions: Vec<String>,
    /// Options of choices by name, in the order of the agent's levels; those of the vehicles where absent.
    pub action_options: BTreeMap<String, Vec<String>>,
    /// What the agent sees, in the order of an observation; names of rows or of groups of rows.
    pub observations: Vec<String>,
    /// What is shown as -1 and as 1, by row; as in the table where absent.
    pub observation_bounds: BTreeMap<String, (f64, f64)>,
    /// What is told of a step beside the parts of its reward.
    pub info: Vec<Told>,
    /// Reward file.
    pub reward: String,
    /// Changes of single weights.
    pub reward_overrides: Vec<String>,
    /// Changes of single values of vehicle, controller and scenario.
    pub overrides: Vec<String>,
    /// Seconds for which an action is held.
    pub control_interval_s: u32,
    /// Standard deviation of the noise on measured rows, in units of half their range.
    pub sensor_noise: f64,
}

/// What a step can tell beside the parts of its reward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Told {
    /// What a safe agent is held to, see [`Terms::cost`].
    ///
    /// [`Terms::cost`]: crate::reward::Terms::cost
    Cost,
    /// Which options the plant would grant next.
    ActionMask,
    /// The terms that rewards and KPIs are made of.
    Terms,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            vehicle: None,
            continuous: false,
            actions: vec!["default".to_owned()],
            action_options: BTreeMap::new(),
            observations: vec!["default".to_owned()],
            observation_bounds: BTreeMap::new(),
            info: Vec::new(),
            reward: "balanced".to_owned(),
            reward_overrides: Vec::new(),
            overrides: Vec::new(),
            control_interval_s: 1,
            sensor_noise: 0.0,
        }
    }
}

/// Where the trips of an environment come from, by name: a scenario or else a distribution, driven with a vehicle.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Origin {
    /// Scenario.
    pub scenario: Option<String>,
    /// Distribution.
    pub distribution: Option<String>,
    /// Vehicle, where not that of settings or scenario.
    pub vehicle: Option<String>,
}

/// Where the trips of an environment come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// Always the same.
    Scenario(Arc<Trip>),
    /// Drawn anew.
    Distribution(Arc<Distribution>),
}

/// The rows of an environment in one vehicle.
#[derive(Debug)]
pub struct Car {
    /// Actions.
    pub actions: FittedActions,
    /// Observations.
    pub observations: FittedObservations,
    /// Hash of its parameters.
    pub fingerprint: u64,
}

/// Settings made ready.
#[derive(Debug)]
pub struct Setup {
    /// Vehicle of environments that name none.
    vehicle: Option<String>,
    /// Continuous values instead of levels.
    pub continuous: bool,
    /// Actions.
    pub actions: ActionTable,
    /// Observations.
    pub observations: ObservationTable,
    /// What a step tells beside the parts of its reward.
    pub told: Vec<Told>,
    /// Rows whose bounds a vehicle can leave.
    pub narrow: Vec<Narrow>,
    /// Weights of the reward.
    pub reward: RewardParameters,
    /// Seconds for which an action is held.
    pub control_interval_s: u32,
    /// Standard deviation of the noise.
    pub sensor_noise: f64,
    /// Vehicles, cycles, scenarios.
    pub garage: Garage,
    /// Identifies all of this.
    pub identity: Identity,
    /// Rows by vehicle, worked out once.
    cars: Mutex<HashMap<String, Arc<Car>>>,
}

/// What a vehicle is called in messages.
#[must_use]
pub fn vehicle_label(experiment: &Experiment) -> String {
    let Experiment { scenario, plant, .. } = experiment;
    format!("vehicle `{}` (architecture `{}`)", scenario.vehicle, plant.vehicle.architecture)
}

/// The scenario, or one of the trips, that names the vehicle of a source.
fn template(garage: &Garage, source: &Source) -> PlantResult<Arc<Experiment>> {
    match source {
        Source::Scenario(trip) => garage.experiment(&trip.origin, trip.vehicle.as_deref()),
        Source::Distribution(distribution) => Ok(Arc::clone(distribution.template())),
    }
}

fn load(garage: &Garage, origin: &Origin, vehicle: Option<&String>) -> PlantResult<Source> {
    let vehicle = origin.vehicle.as_ref().or(vehicle).map(String::as_str);
    match (&origin.scenario, &origin.distribution) {
        (Some(name), _) => garage.trip(name, vehicle).map(|trip| Source::Scenario(Arc::new(trip))),
        (None, Some(name)) => Ok(Source::Distribution(Arc::new(Distribution::load(name, vehicle, garage)?))),
        (None, None) => Err(PlantError::InvalidArgument {
            what: "scenario and distribution".into(),
            value: "None".into(),
            allowed: "must be given, one of them".into(),
        }),
    }
}

impl Settings {
    /// Checks what single values can be.
    ///
    /// # Errors
    /// The first that is not accepted.
    fn check(&self) -> PlantResult<()> {
        let refused = |what: &str, value: String, allowed: String| {
            Err(PlantError::InvalidArgument { what: what.to_owned(), value, allowed })
        };
        if !(1..=LONGEST_INTERVAL_S).contains(&self.control_interval_s) {
            let allowed = format!("must be between 1 and {LONGEST_INTERVAL_S}");
            return refused("control_interval_s", self.control_interval_s.to_string(), allowed);
        }
        if !(0.0..=1.0).contains(&self.sensor_noise) {
            return refused(
                "sensor_noise",
                self.sensor_noise.to_string(),
                "must be between 0 and 1".to_owned(),
            );
        }
        Ok(())
    }
}

impl Setup {
    /// Checks settings and makes them ready for environments whose trips come from these origins; returns the source of
    /// each too. Rows are those of all their vehicles together.
    ///
    /// # Errors
    /// Anything in settings or origins that is not accepted.
    pub fn new(settings: &Settings, origins: &[Origin]) -> PlantResult<(Arc<Self>, Vec<Source>)> {
        let parse = |texts: &[String]| {
            texts.iter().map(|text| Override::parse(text)).collect::<PlantResult<Vec<_>>>()
        };
        settings.check()?;
        let weights = parse(&settings.reward_overrides)?;
        let reward: RewardParameters = library::load(REWARD, &settings.reward, &weights)?;
        reward::check(&reward).map_err(|violation| violation.in_file(&settings.reward))?;
        let garage = Garage::new(parse(&settings.overrides)?);
        let mut loaded: HashMap<&Origin, Source> = HashMap::new();
        let mut sources = Vec::with_capacity(origins.len());
        let mut vehicles: Vec<Arc<Experiment>> = Vec::new();
        for origin in origins {
            if !loaded.contains_key(origin) {
                let source = load(&garage, origin, settings.vehicle.as_ref())?;
                vehicles.push(template(&garage, &source)?);
                loaded.insert(origin, source);
            }
            sources.push(loaded[origin].clone());
        }
        let set = RowSet::of(vehicles.iter().map(|experiment| experiment.plant.layout()))?;
        let actions = ActionTable::new(&settings.actions, &set, &settings.action_options)?;
        let observations =
            ObservationTable::new(&settings.observations, &set, &actions, &settings.observation_bounds)?;
        let narrow = vehicles.iter().flat_map(|experiment| {
            limits::narrow(&observations, &experiment.scenario.vehicle, &experiment.plant.vehicle)
        });
        // Whoever gives bounds means them.
        let chosen = &settings.observation_bounds;
        let narrow: Vec<Narrow> = narrow.filter(|narrow| !chosen.contains_key(&narrow.row)).collect();
        let setup = Self {
            vehicle: settings.vehicle.clone(),
            continuous: settings.continuous,
            actions,
            observations,
            narrow,
            told: settings.info.clone(),
            control_interval_s: settings.control_interval_s,
            sensor_noise: settings.sensor_noise,
            garage,
            identity: identity(settings, &reward, &vehicles),
            reward,
            cars: Mutex::default(),
        };
        Ok((Arc::new(setup), sources))
    }

    /// Where trips of an origin come from.
    ///
    /// # Errors
    /// Its scenario, distribution or vehicle cannot be loaded, or there is none.
    pub fn source(&self, origin: &Origin) -> PlantResult<Source> {
        load(&self.garage, origin, self.vehicle.as_ref())
    }

    /// Rows in the vehicle of a trip.
    #[must_use]
    pub fn car(&self, experiment: &Experiment) -> Arc<Car> {
        // Whatever a panicking thread left there is complete.
        let mut cars = self.cars.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(car) = cars.get(&experiment.scenario.vehicle) {
            return Arc::clone(car);
        }
        let car = Arc::new(self.fit(&experiment.plant));
        cars.insert(experiment.scenario.vehicle.clone(), Arc::clone(&car));
        car
    }

    fn fit(&self, plant: &Plant) -> Car {
        let actions = FittedActions::of(&self.actions, plant.layout());
        Car {
            observations: FittedObservations::of(&self.observations, plant, &actions),
            actions,
            fingerprint: snapshot::fingerprint(&[format!("{:?}", plant.vehicle)]),
        }
    }
}

/// What snapshots of environments with these settings and vehicles belong to. Which vehicle a trip is driven with stands in
/// the snapshot itself.
fn identity(settings: &Settings, reward: &RewardParameters, vehicles: &[Arc<Experiment>]) -> Identity {
    let mut layouts: Vec<&Layout> = Vec::new();
    let mut labels: Vec<String> = Vec::new();
    for experiment in vehicles {
        let (layout, label) = (experiment.plant.layout(), vehicle_label(experiment));
        if !layouts.contains(&layout) {
            layouts.push(layout);
        }
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let version = env!("CARGO_PKG_VERSION").to_owned();
    // What is told changes nothing.
    let settings = Settings { vehicle: None, info: Vec::new(), ..settings.clone() };
    Identity {
        architectures: snapshot::fingerprint(
            &layouts.iter().map(|layout| format!("{layout:?}")).collect::<Vec<_>>(),
        ),
        settings: snapshot::fingerprint(&[version, format!("{settings:?}"), format!("{reward:?}")]),
        vehicles: labels.join(", "),
    }
}
