//! One environment: trips driven second by second from start to arrival.

use crate::defaults::Defaults;
use crate::garage::Trip;
use crate::observation::{Clipped, Look};
use crate::random::Random;
use crate::reference::ReferenceConditions;
use crate::reward::{Meter, Parts, Terms};
use crate::setup::{Car, Setup, Source, vehicle_label};
use crate::snapshot;
use hp_plant::command::Command;
use hp_plant::error::PlantResult;
use hp_plant::signals::View;
use hp_trip::experiment::Experiment;
use hp_trip::run::{EndReason, Run};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Keeps the noise apart from what draws the trips.
const NOISE_STREAM: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a step gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Reward.
    pub reward: f64,
    /// Its parts.
    pub parts: Parts,
    /// What it was counted from.
    pub terms: Terms,
    /// Why the trip is over, if it is.
    pub end: Option<EndReason>,
}

/// What a trip is, for those who ask.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Scenario by name, or the distribution's template.
    pub scenario: Arc<str>,
    /// Vehicle by name or path.
    pub vehicle: String,
    /// Drive cycle by name or path.
    pub cycle: String,
    /// Part of the cycle that is driven [s]; the whole where absent.
    pub window_s: Option<(usize, usize)>,
    /// Duration [s].
    pub duration_s: usize,
    /// Ambient temperature [degC].
    pub ambient_temperature_degc: f64,
}

/// What changes while a trip is driven: plain data.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Progress {
    run: Run,
    meter: Meter,
    asked: Command,
    /// What the rule-based controller wants this second, once it was asked.
    ruled: Option<Command>,
    end: Option<EndReason>,
}

/// A trip in progress.
#[derive(Debug, Clone)]
struct Current {
    origin: Arc<str>,
    vehicle: Option<Arc<str>>,
    window: Option<(usize, usize)>,
    experiment: Experiment,
    car: Arc<Car>,
    conditions: ReferenceConditions,
    defaults: Defaults,
    progress: Progress,
}

/// Steps since the last reset, and whether the environment waits for the next; kept by what steps environments together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Clock {
    /// Steps done.
    pub elapsed: u64,
    /// Whether the trip is over.
    pub over: bool,
}

/// Everything that an episode's future depends on.
#[derive(Serialize, Deserialize)]
struct Snapshot {
    clock: Clock,
    random: Random,
    noise: Random,
    clipped: Clipped,
    current: Option<Driven>,
}

/// A trip in progress as a snapshot holds it.
#[derive(Serialize, Deserialize)]
struct Driven {
    trip: Trip,
    /// Its vehicle in words, and a hash of that one's parameters.
    vehicle: String,
    fingerprint: u64,
    progress: Progress,
}

/// A state that was read and found to fit.
#[derive(Debug)]
pub struct Restored {
    /// Its clock.
    pub clock: Clock,
    random: Random,
    noise: Random,
    clipped: Clipped,
    current: Option<Current>,
}

/// One environment.
#[derive(Debug, Clone)]
pub struct Episode {
    setup: Arc<Setup>,
    source: Source,
    random: Random,
    noise: Random,
    /// Of the observations of this trip.
    clipped: Clipped,
    current: Option<Current>,
}

impl Current {
    fn of(setup: &Setup, trip: Trip) -> PlantResult<Self> {
        let (origin, vehicle, window) = (Arc::clone(&trip.origin), trip.vehicle.clone(), trip.window);
        let experiment = setup.garage.build(trip)?;
        let run = experiment.start();
        let defaults = Defaults::of(&experiment);
        let car = setup.car(&experiment);
        let off: Vec<f32> =
            (0..setup.actions.rows().len()).map(|column| setup.actions.value(column, 0)).collect();
        let progress = Progress {
            meter: Meter::start(&experiment, &run.state),
            asked: defaults.complete(&car.actions, &off, &experiment, 0.0),
            run,
            ruled: None,
            end: None,
        };
        let conditions = ReferenceConditions::of(&experiment);
        Ok(Self { origin, vehicle, window, experiment, car, conditions, defaults, progress })
    }

    /// What defines the trip.
    fn trip(&self) -> Trip {
        let Experiment { climate, initial, cycle, .. } = &self.experiment;
        Trip {
            origin: Arc::clone(&self.origin),
            vehicle: self.vehicle.clone(),
            cycle: cycle.name().into(),
            climate: climate.clone(),
            initial: initial.clone(),
            window: self.window,
        }
    }
}

impl Episode {
    /// An environment before its first reset.
    #[must_use]
    pub fn new(setup: Arc<Setup>, source: Source) -> Self {
        let (random, noise) = (Random::seeded(0), Random::seeded(NOISE_STREAM));
        Self { setup, source, random, noise, clipped: Clipped::default(), current: None }
    }

    /// Settings.
    #[must_use]
    pub fn setup(&self) -> &Arc<Setup> {
        &self.setup
    }

    /// Starts the random numbers anew.
    pub fn seed(&mut self, seed: u64) {
        self.random = Random::seeded(seed);
        self.noise = Random::seeded(seed ^ NOISE_STREAM);
    }

    /// Begins a trip of the environment's own source, or of another one just this once.
    ///
    /// # Errors
    /// A file of the trip cannot be loaded; the trip in progress stays as it is.
    pub fn reset(&mut self, once: Option<&Source>) -> PlantResult<()> {
        let trip = match once.unwrap_or(&self.source) {
            Source::Scenario(trip) => Trip::clone(trip),
            Source::Distribution(distribution) => distribution.draw(&mut self.random),
        };
        self.current = Some(Current::of(&self.setup, trip)?);
        self.clipped = Clipped::default();
        Ok(())
    }

    /// [`Self::reset`], with the random numbers started anew where there is a seed.
    ///
    /// # Errors
    /// As of [`Self::reset`]; nothing has changed then.
    pub fn restart(&mut self, seed: Option<u64>, once: Option<&Source>) -> PlantResult<()> {
        let before = (self.random.clone(), self.noise.clone());
        if let Some(seed) = seed {
            self.seed(seed);
        }
        let begun = self.reset(once);
        if begun.is_err() {
            (self.random, self.noise) = before;
        }
        begun
    }

    /// Whether a trip was begun.
    #[must_use]
    pub fn begun(&self) -> bool {
        self.current.is_some()
    }

    /// Why the last trip is over, if it is.
    #[must_use]
    pub fn end(&self) -> Option<EndReason> {
        self.current.as_ref().and_then(|current| current.progress.end)
    }

    /// Drives one control interval with values of the selected rows.
    ///
    /// Nothing happens, and there is no outcome, before the first reset and after the end of a trip.
    pub fn step(&mut self, values: &[f32]) -> Option<Outcome> {
        let current = self.current.as_mut().filter(|current| current.progress.end.is_none())?;
        let Current { experiment, car, conditions, defaults, progress, .. } = current;
        let mut added = Terms::default();
        progress.ruled = None;
        for _ in 0..self.setup.control_interval_s {
            let time_s = progress.run.state.time_s;
            defaults.complete_into(&car.actions, values, experiment, time_s, &mut progress.asked);
            let disturbance = experiment.disturbance(progress.run.steps);
            progress.end = experiment.step(&mut progress.run, &progress.asked);
            added += progress.meter.add(
                experiment,
                conditions,
                &self.setup.reward,
                &progress.run,
                &disturbance,
                progress.end,
            );
            if progress.end.is_some() {
                break;
            }
        }
        let parts = added.reward(&self.setup.reward);
        Some(Outcome { reward: parts.iter().sum(), parts, terms: added, end: progress.end })
    }

    /// Writes the observation of now; all zero before the first reset.
    pub fn observe(&mut self, values: &mut [f32]) {
        let Some(current) = &self.current else {
            values.fill(0.0);
            return;
        };
        let Current { experiment, car, progress, .. } = current;
        let disturbance = experiment.last_disturbance(progress.run.steps, &progress.run.pace);
        let look = Look {
            view: View {
                plant: &experiment.plant,
                state: &progress.run.state,
                record: progress.run.record.as_ref(),
                disturbance: &disturbance,
            },
            experiment,
            asked: &progress.asked,
            steps: progress.run.steps,
            behind_m: progress.run.pace.behind_m,
        };
        let strength = self.setup.sensor_noise;
        let noise = &mut self.noise;
        let blur = (strength > 0.0).then_some(|| strength * noise.normal());
        self.setup.observations.write(&car.observations, &look, blur, values, &mut self.clipped);
    }

    /// Writes the observation of now once more, which does not count again what was clipped.
    pub fn observe_again(&mut self, values: &mut [f32]) {
        let clipped = self.clipped.clone();
        self.observe(values);
        self.clipped = clipped;
    }

    /// Share of the observations of this trip in which each row was beyond its bounds, and held there.
    #[must_use]
    pub fn clipped_shares(&self) -> Vec<f64> {
        self.clipped.shares(self.setup.observations.rows().len())
    }

    /// Writes which options of the actions would be granted now; all before the first reset.
    pub fn write_mask(&self, mask: &mut [bool]) {
        let Some(current) = &self.current else {
            mask.fill(true);
            return;
        };
        let Current { experiment, car, progress, defaults, .. } = current;
        let disturbance = experiment.next_disturbance(progress.run.steps, &progress.run.pace);
        let (table, state) = (&self.setup.actions, &progress.run.state);
        car.actions.write_mask(table, &experiment.plant, state, &disturbance, defaults, mask);
    }

    /// Command of the rule-based controller for the next control interval; the same until the next step.
    pub fn rule_based_command(&mut self) -> Option<Command> {
        let Current { experiment, progress, .. } = self.current.as_mut()?;
        if progress.ruled.is_none() {
            progress.ruled = Some(experiment.rule_based_command(&mut progress.run));
        }
        progress.ruled
    }

    /// Writes the options nearest to what the rule-based controller wants; nothing before the first reset.
    pub fn rule_based_levels(&mut self, levels: &mut [i64]) {
        let Some(command) = self.rule_based_command() else { return };
        let Some(current) = &self.current else { return };
        for (column, level) in levels.iter_mut().enumerate() {
            *level = current.car.actions.level(&self.setup.actions, column, &command) as i64;
        }
    }

    /// Writes the normalised values that the rule-based controller wants; nothing before the first reset.
    pub fn rule_based_values(&mut self, values: &mut [f32]) {
        let Some(command) = self.rule_based_command() else { return };
        let Some(current) = &self.current else { return };
        for (column, value) in values.iter_mut().enumerate() {
            *value = current.car.actions.value(column, &command);
        }
    }

    /// Origin of the trip in progress, and what it is made of.
    #[must_use]
    pub fn trip(&self) -> Option<(&str, &Experiment)> {
        self.current.as_ref().map(|current| (&*current.origin, &current.experiment))
    }

    /// What the trip in progress is.
    #[must_use]
    pub fn facts(&self) -> Option<Facts> {
        let Current { origin, window, experiment, .. } = self.current.as_ref()?;
        Some(Facts {
            scenario: Arc::clone(origin),
            vehicle: experiment.scenario.vehicle.clone(),
            cycle: experiment.cycle.name().to_owned(),
            window_s: *window,
            duration_s: experiment.cycle.duration_s(),
            ambient_temperature_degc: experiment.climate.ambient_temperature_degc.0,
        })
    }

    /// Totals of the trip so far by name, as `simulate` gives them, and the share of observations in which a value was
    /// clipped; none before the first reset.
    #[must_use]
    pub fn totals(&self) -> Vec<(String, Option<f64>)> {
        let Some(Current { experiment, progress, .. }) = &self.current else { return Vec::new() };
        let mut totals = progress.run.summary.values(experiment.plant.layout());
        totals.push(("clipped_share".to_owned(), Some(self.clipped.share())));
        totals
    }

    /// The run in progress.
    #[must_use]
    pub fn run(&self) -> Option<&Run> {
        self.current.as_ref().map(|current| &current.progress.run)
    }

    /// The command that was driven last, a value for each actuator of the vehicle.
    #[must_use]
    pub fn asked(&self) -> Option<&[f32]> {
        let current = self.current.as_ref()?;
        Some(&current.progress.asked.0[..current.experiment.plant.ranges.count()])
    }

    /// Terms of the trip so far.
    #[must_use]
    pub fn terms(&self) -> Option<&Terms> {
        self.current.as_ref().map(|current| &current.progress.meter.total)
    }

    /// Everything that the future depends on, as bytes, with a clock.
    ///
    /// # Errors
    /// See [`snapshot::pack`].
    pub fn to_bytes(&self, clock: Clock) -> PlantResult<Vec<u8>> {
        let current = self.current.as_ref().map(|current| Driven {
            trip: current.trip(),
            vehicle: vehicle_label(&current.experiment),
            fingerprint: current.car.fingerprint,
            progress: current.progress,
        });
        let (random, noise) = (self.random.clone(), self.noise.clone());
        let snapshot = Snapshot { clock, random, noise, clipped: self.clipped.clone(), current };
        snapshot::pack(&self.setup.identity, &snapshot)
    }

    /// Reads what [`Self::to_bytes`] wrote; changes nothing.
    ///
    /// # Errors
    /// The bytes are not a state of an environment with these settings.
    pub fn read(&self, bytes: &[u8]) -> PlantResult<Restored> {
        let Snapshot { clock, random, noise, clipped, current } =
            snapshot::unpack(&self.setup.identity, bytes)?;
        let current = match current {
            None => None,
            Some(Driven { trip, vehicle, fingerprint, progress }) => {
                let checked = self.setup.garage.check(&trip);
                checked.map_err(|error| snapshot::refused(format!("of a trip that cannot be ({error})")))?;
                let begun = Current::of(&self.setup, trip)?;
                if begun.car.fingerprint != fingerprint {
                    let now = vehicle_label(&begun.experiment);
                    return Err(snapshot::refused(format!(
                        "of {vehicle}, whose parameters were others than {now} has"
                    )));
                }
                Some(Current { progress, ..begun })
            }
        };
        if !clipped.fits(self.setup.observations.rows().len()) {
            return Err(snapshot::refused("with counts of observations that cannot be".to_owned()));
        }
        Ok(Restored { clock, random, noise, clipped, current })
    }

    /// Goes on from what [`Self::to_bytes`] wrote.
    ///
    /// # Errors
    /// See [`Self::read`]; nothing has changed then.
    pub fn restore(&mut self, bytes: &[u8]) -> PlantResult<()> {
        let restored = self.read(bytes)?;
        self.resume(restored);
        Ok(())
    }

    /// Goes on from a state that was read.
    pub fn resume(&mut self, restored: Restored) {
        self.current = restored.current;
        self.random = restored.random;
        self.noise = restored.noise;
        self.clipped = restored.clipped;
    }
}
