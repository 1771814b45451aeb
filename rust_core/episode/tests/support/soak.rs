//! Adversarial steps: every vehicle, extreme weather and charge, commands made to upset it; and what must never happen.

use hp_episode::action::GROUPS;
use hp_episode::episode::Episode;
use hp_episode::garage::Trip;
use hp_episode::random::Random;
use hp_episode::setup::{Origin, Settings, Setup, Source};
use hp_plant::circuits::refrigeration_loop::LoopStatus;
use hp_plant::config::library;
use hp_plant::config::{Celsius, kinds::VEHICLE};
use hp_trip::experiment::Experiment;
use hp_trip::kinds::CYCLE;
use hp_trip::run::Run;
use rayon::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Residual of the ledgers of energy and water that counts as round-off, relative.
pub const LEDGER_TOLERANCE: f64 = 1e-9;

/// Residual with which a refrigerant solve counts as checked.
pub const SOLVE_TOLERANCE: f64 = 1e-5;

/// What was seen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seen {
    /// Steps of a second.
    pub steps: u64,
    /// Trips.
    pub trips: u64,
    /// Values that are no finite number: signals, observations, rewards, totals of trips that must exist.
    pub not_finite: u64,
    /// Steps in which a limit was passed by a machine that runs and moves away from it.
    pub limit_breaches: u64,
    /// Largest residual of the ledgers of energy and water, relative.
    pub worst_ledger: f64,
    /// Steps with a state of charge outside 0..1.
    pub charge_outside: u64,
    /// Refrigerant solves.
    pub solves: u64,
    /// Those by bracketing.
    pub bracketed: u64,
    /// Those that found no solution, and said so.
    pub not_converged: u64,
    /// Those that took a state whose residual is too large.
    pub unchecked: u64,
    /// Largest residual of a solve that was taken.
    pub worst_solve: f64,
}

impl Seen {
    fn and(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            trips: self.trips + other.trips,
            not_finite: self.not_finite + other.not_finite,
            limit_breaches: self.limit_breaches + other.limit_breaches,
            worst_ledger: self.worst_ledger.max(other.worst_ledger),
            charge_outside: self.charge_outside + other.charge_outside,
            solves: self.solves + other.solves,
            bracketed: self.bracketed + other.bracketed,
            not_converged: self.not_converged + other.not_converged,
            unchecked: self.unchecked + other.unchecked,
            worst_solve: self.worst_solve.max(other.worst_solve),
        }
    }

    /// Whether nothing happened that must not.
    #[must_use]
    pub fn sound(&self) -> bool {
        let never =
            [self.not_finite, self.limit_breaches, self.charge_outside, self.not_converged, self.unchecked];
        never == [0; 5] && self.worst_ledger <= LEDGER_TOLERANCE
    }

    /// Looks at a run after a step.
    fn look(&mut self, experiment: &Experiment, run: &Run, row: &mut Vec<f64>) {
        row.clear();
        experiment.look(run, row);
        self.not_finite += row.iter().filter(|value| !value.is_finite()).count() as u64;
        let Some(record) = &run.record else { return };
        // Of energy and of water: the larger, or the one that is no number.
        let (energy, water) = (record.ledger.relative(), record.water_ledger.relative());
        let ledger = if water <= energy { energy } else { water + 0.0 * energy };
        // A comparison that no NaN passes.
        self.worst_ledger = if ledger <= self.worst_ledger { self.worst_ledger } else { ledger };
        let signals = experiment.plant.signals.rows().iter().zip(&*row);
        let charges: Vec<f64> = signals
            .filter(|(signal, _)| matches!(signal.name.as_str(), "soc" | "charge_soc"))
            .map(|(_, &value)| value)
            .collect();
        let inside = charges.len() == 2 && charges.iter().all(|charge| (0.0..=1.0).contains(charge));
        self.charge_outside += u64::from(!inside);
        let solve = &record.refrigeration;
        if solve.iterations > 0 {
            self.solves += 1;
            self.bracketed += u64::from(solve.bracketed);
            self.not_converged += u64::from(solve.status == LoopStatus::NotConverged);
        }
        if solve.running() {
            let checked = solve.iterations > 0 && solve.residual <= SOLVE_TOLERANCE;
            self.unchecked += u64::from(!checked);
            self.worst_solve = self.worst_solve.max(solve.residual);
        }
    }

    /// Looks at the totals of a trip.
    fn sum_up(&mut self, experiment: &Experiment, run: &Run) {
        self.trips += 1;
        let totals = run.summary.values(experiment.plant.layout());
        let of = |name: &str| totals.iter().find(|(found, _)| found == name).and_then(|(_, value)| *value);
        self.limit_breaches += of("limit_breaches").unwrap_or(f64::INFINITY) as u64;
        let missing = totals.iter().filter(|(name, value)| {
            let may_be_missing = match name.as_str() {
                "energy_kwh_per_100_km" => of("distance_km") == Some(0.0),
                "heat_pump_cop" => of("compressor_kwh").is_none_or(|energy_kwh| energy_kwh == 0.0),
                "time_to_comfort_s" => of("comfortable_share") == Some(0.0),
                "time_to_near_comfort_s" | "discomfort_afterwards_k" => {
                    of("time_to_near_comfort_s").is_none()
                }
                "equivalent_time_to_near_comfort_s" | "equivalent_discomfort_afterwards_k" => {
                    of("equivalent_time_to_near_comfort_s").is_none()
                }
                _ => false,
            };
            value.is_none() && !may_be_missing
        });
        self.not_finite += missing.count() as u64;
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} steps on {} trips", self.steps, self.trips)?;
        writeln!(f, "values that are not finite: {}", self.not_finite)?;
        writeln!(f, "limit breaches: {}", self.limit_breaches)?;
        writeln!(f, "largest ledger residual: {:.2e} (at most {LEDGER_TOLERANCE:e})", self.worst_ledger)?;
        writeln!(f, "steps with a charge outside 0..1: {}", self.charge_outside)?;
        writeln!(
            f,
            "refrigerant solves: {}, of which bracketed {}, not converged {}, unchecked {}; largest residual {:.2e}",
            self.solves, self.bracketed, self.not_converged, self.unchecked, self.worst_solve
        )
    }
}

/// How commands are made; each is kept for a while.
#[derive(Clone, Copy)]
enum Mood {
    /// Anything, anew each second.
    Anything,
    /// Ends of all ranges, anew each second.
    Ends,
    /// All that there is.
    Everything,
    /// Nothing at all.
    Nothing,
    /// From one end to the other and back, each second.
    ToAndFro,
    /// One command, held.
    Held,
}

const MOODS: [Mood; 6] =
    [Mood::Anything, Mood::Ends, Mood::Everything, Mood::Nothing, Mood::ToAndFro, Mood::Held];

fn command(values: &mut [f32], mood: Mood, random: &mut Random, second: u64) {
    for value in values {
        *value = match mood {
            Mood::Anything => random.between(-1.0, 1.0) as f32,
            Mood::Ends => {
                if random.chance(0.5) {
                    1.0
                } else {
                    -1.0
                }
            }
            Mood::Everything => 1.0,
            Mood::Nothing => -1.0,
            Mood::ToAndFro => {
                if second.is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                }
            }
            Mood::Held => *value,
        };
    }
}

/// A trip at the ends of what scenarios may say, or anywhere between.
fn trip(template: &Trip, members: &[String], random: &mut Random) -> Trip {
    fn within(random: &mut Random, low: f64, high: f64) -> f64 {
        match random.index(4) {
            0 => low,
            1 => high,
            _ => random.between(low, high),
        }
    }
    let cycles = library::names(CYCLE);
    let mut trip = template.clone();
    trip.cycle = cycles[random.index(cycles.len())].into();
    trip.climate.ambient_temperature_degc = Celsius(within(random, -40.0, 50.0));
    trip.climate.solar_gain_w = within(random, 0.0, 3000.0);
    trip.climate.occupants = random.index(10) as u32;
    trip.climate.relative_humidity = within(random, 0.0, 1.0);
    trip.initial.soak_temperature_degc = Celsius(within(random, -40.0, 50.0));
    trip.initial.state_of_charge_pct = within(random, 1.0, 100.0);
    for member in members {
        let own = random.chance(0.3).then(|| Celsius(within(random, -40.0, 60.0)));
        trip.initial.set(member, own);
    }
    trip
}

/// Drives one vehicle.
fn drive(vehicle: &str, steps: u64, seed: u64) -> Seen {
    let settings = Settings { continuous: true, actions: vec![GROUPS[2].to_owned()], ..Settings::default() };
    let scenario = "jeffs2019/case1-4".to_owned();
    let origin = Origin { scenario: Some(scenario), distribution: None, vehicle: Some(vehicle.to_owned()) };
    let (setup, sources) = Setup::new(&settings, &[origin]).expect("built in");
    let Source::Scenario(template) = &sources[0] else { panic!("a scenario was asked for") };
    let mut values = vec![0.0_f32; setup.actions.rows().len()];
    let mut observation = vec![0.0_f32; setup.observations.rows().len()];
    let mut episode = Episode::new(setup, sources[0].clone());
    episode.reset(None).expect("built in");
    let names = episode.trip().map(|(_, experiment)| experiment.plant.layout().members.clone());
    let members: Vec<String> = names.unwrap_or_default().into_iter().map(|member| member.name).collect();
    let (mut random, mut seen, mut row) = (Random::seeded(seed), Seen::default(), Vec::new());
    while seen.steps < steps {
        let next = trip(template, &members, &mut random);
        episode.reset(Some(&Source::Scenario(Arc::new(next)))).expect("within what scenarios may say");
        let (mut mood, mut until) = (Mood::Anything, 0);
        let begun = seen.steps;
        loop {
            if seen.steps >= until {
                mood = MOODS[random.index(MOODS.len())];
                until = seen.steps + [3, 30, 300][random.index(3)];
            }
            command(&mut values, mood, &mut random, seen.steps);
            let Some(outcome) = episode.step(&values) else { break };
            seen.steps += 1;
            episode.observe(&mut observation);
            let observed = observation.iter().filter(|value| !value.is_finite()).count();
            seen.not_finite += observed as u64 + u64::from(!outcome.reward.is_finite());
            let (Some((_, experiment)), Some(run)) = (episode.trip(), episode.run()) else { break };
            seen.look(experiment, run, &mut row);
            // Trips are not driven to their ends only, so that there are many.
            if outcome.end.is_some()
                || seen.steps >= steps
                || seen.steps - begun > 1200 && random.chance(0.01)
            {
                seen.sum_up(experiment, run);
                break;
            }
        }
    }
    seen
}

/// Drives every built-in vehicle its share of so many steps.
#[must_use]
pub fn soak(steps: u64, seed: u64) -> Seen {
    // Parts of a vehicle's share, so that no thread waits for the slowest.
    const PARTS: u64 = 8;
    let vehicles = library::names(VEHICLE);
    let share = steps.div_ceil(vehicles.len() as u64 * PARTS);
    let jobs: Vec<(&str, u64)> =
        vehicles.iter().flat_map(|&vehicle| (0..PARTS).map(move |part| (vehicle, part))).collect();
    let seeded = |place: usize| seed ^ (place as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let each = jobs.par_iter().enumerate();
    each.map(|(place, (vehicle, _))| drive(vehicle, share, seeded(place))).reduce(Seen::default, Seen::and)
}
