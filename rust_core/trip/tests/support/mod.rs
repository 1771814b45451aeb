//! Scenarios that no sane driver would make, and what must hold in every step of them; shared by tests of all vehicles.
#![allow(dead_code, reason = "not every user of this folder needs all of it")]

pub mod cars;
pub mod physics;

use hp_plant::architecture::declaration::MemberKind;
use hp_plant::command::Command;
use hp_plant::config::Celsius;
use hp_plant::config::initial::InitialParameters;
use hp_plant::media::{air, moist_air};
use hp_plant::plant::{Disturbance, Plant, StepRecord};
use hp_plant::state::State;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Residual of the energy ledger allowed, as a share of the power in play.
pub const TOLERANCE: f64 = 1e-9;

/// Length of a random scenario [s].
pub const STEPS_EACH: usize = 300;
/// A command is held this long [s].
const HOLD_S: usize = 10;

/// A scenario that no sane driver would make.
#[derive(Debug, Clone)]
pub struct RandomScenario {
    ambient_degc: f64,
    soak_degc: f64,
    battery_degc: f64,
    store_degc: f64,
    state_of_charge_pct: f64,
    solar_gain_w: f64,
    occupants: f64,
    relative_humidity: f64,
    speeds_m_s: Vec<f64>,
    commands: Vec<Vec<f32>>,
    /// Level, without wind and in constant weather where there is none.
    roads: Vec<Road>,
}

/// A piece of road and its weather.
#[derive(Debug, Clone, Copy)]
struct Road {
    grade: f64,
    headwind_m_s: f64,
    warmer_k: f64,
    sun_share: f64,
}

/// Scenarios for a vehicle with so many actuators.
pub fn random_scenario(actuators: usize) -> impl Strategy<Value = RandomScenario> {
    let segments = STEPS_EACH / HOLD_S;
    // Half of all demands are extremes: that is where limits are.
    let value = prop_oneof![2 => -1.0_f32..1.0, 1 => Just(-1.0_f32), 1 => Just(1.0_f32)];
    let command = prop::collection::vec(value, actuators);
    (
        (-30.0..45.0_f64, -30.0..60.0_f64, -30.0..45.0_f64, -20.0..90.0_f64),
        (3.0..100.0_f64, 0.0..800.0_f64, 0.0..5.0_f64, 0.0..1.0_f64),
        prop::collection::vec(0.0..40.0_f64, segments + 1),
        prop::collection::vec(command, segments),
    )
        .prop_map(
            |(
                temperatures,
                (state_of_charge_pct, solar_gain_w, occupants, relative_humidity),
                speeds_m_s,
                commands,
            )| {
                RandomScenario {
                    ambient_degc: temperatures.0,
                    soak_degc: temperatures.1,
                    battery_degc: temperatures.2,
                    store_degc: temperatures.3,
                    state_of_charge_pct,
                    solar_gain_w,
                    occupants: occupants.floor(),
                    relative_humidity,
                    speeds_m_s,
                    commands,
                    roads: Vec::new(),
                }
            },
        )
}

const LEVEL: Road = Road { grade: 0.0, headwind_m_s: 0.0, warmer_k: 0.0, sun_share: 1.0 };

fn road() -> impl Strategy<Value = Road> {
    let any = |low: f64, high: f64| prop_oneof![Just(0.0), low..high];
    (any(-0.2, 0.2), any(-15.0, 15.0), any(-5.0, 5.0), 0.0..1.0_f64).prop_map(
        |(grade, headwind_m_s, warmer_k, sun_share)| Road { grade, headwind_m_s, warmer_k, sun_share },
    )
}

/// The same so many scenarios for a vehicle at every call.
pub fn random_scenarios(plant: &Plant, count: u32) -> Vec<RandomScenario> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[19; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let strategy = random_scenario(plant.ranges.count());
    (0..count).map(|_| strategy.new_tree(&mut runner).expect("strategy without filters").current()).collect()
}

/// The same with hills, wind and weather that changes under way; the same at every call.
pub fn on_hills(scenarios: Vec<RandomScenario>) -> Vec<RandomScenario> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[23; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let strategy = prop::collection::vec(road(), STEPS_EACH / HOLD_S);
    let mut roads = || strategy.new_tree(&mut runner).expect("strategy without filters").current();
    scenarios.into_iter().map(|scenario| RandomScenario { roads: roads(), ..scenario }).collect()
}

/// A step with what it began from.
pub struct Step<'a> {
    pub plant: &'a Plant,
    pub before: &'a State,
    pub after: &'a State,
    pub command: &'a Command,
    pub disturbance: &'a Disturbance,
    pub record: &'a StepRecord,
}

impl RandomScenario {
    fn initial(&self, plant: &Plant) -> InitialParameters {
        let mut initial = InitialParameters::soaked(Celsius(self.soak_degc), self.state_of_charge_pct);
        for member in &plant.layout().members {
            match member.kind {
                MemberKind::Battery => initial.set(&member.name, Some(Celsius(self.battery_degc))),
                MemberKind::Store => initial.set(&member.name, Some(Celsius(self.store_degc))),
                _ => {}
            }
        }
        initial
    }

    /// Humidity ratio of ambient air that is so much warmer than at the start [kg/kg].
    fn ambient_humidity_ratio(&self, warmer_k: f64) -> f64 {
        moist_air::humidity_ratio(self.relative_humidity, Celsius(self.ambient_degc + warmer_k).kelvin())
    }

    fn disturbance(&self, step: usize) -> Disturbance {
        let segment = step / HOLD_S;
        let (from, to) = (self.speeds_m_s[segment], self.speeds_m_s[segment + 1]);
        let Road { grade, headwind_m_s, warmer_k, sun_share } =
            self.roads.get(segment).copied().unwrap_or(LEVEL);
        let at = |second: usize| from + (to - from) * (second % HOLD_S) as f64 / HOLD_S as f64;
        Disturbance {
            start_speed_m_s: at(step),
            end_speed_m_s: if (step + 1).is_multiple_of(HOLD_S) { to } else { at(step + 1) },
            air: air::at_temperature(Celsius(self.ambient_degc + warmer_k).kelvin()),
            ambient_humidity_ratio: self.ambient_humidity_ratio(warmer_k),
            solar_gain_w: self.solar_gain_w * sun_share,
            occupants: self.occupants,
            grade,
            headwind_m_s,
        }
    }

    fn command(&self, step: usize) -> Command {
        let mut command = Command::default();
        let values = &self.commands[step / HOLD_S];
        command.0[..values.len()].copy_from_slice(values);
        command
    }

    /// Drives the scenario and shows every step.
    pub fn drive(&self, plant: &Plant, mut look: impl FnMut(usize, &Step<'_>)) {
        let mut state = plant.parked_in(&self.initial(plant), self.ambient_humidity_ratio(0.0));
        for step in 0..STEPS_EACH {
            let (before, command, disturbance) = (state, self.command(step), self.disturbance(step));
            let record = plant.step(&mut state, &command, &disturbance);
            let seen = Step {
                plant,
                before: &before,
                after: &state,
                command: &command,
                disturbance: &disturbance,
                record: &record,
            };
            look(step, &seen);
        }
    }
}
