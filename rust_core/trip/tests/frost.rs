//! Frost on the front-end exchanger of whole vehicles: it grows, costs heat, melts, and breaks no law of `physics::check`.

#[path = "support/mod.rs"]
mod support;

use hp_plant::command::Command;
use hp_plant::config::Celsius;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::Override;
use hp_plant::flows::Flow;
use hp_plant::media::{air, moist_air};
use hp_plant::plant::{Disturbance, Plant, StepRecord};
use hp_plant::state::State;
use support::physics;

fn plant(vehicle: &str, changes: &[&str]) -> Plant {
    let changes: Vec<Override> =
        changes.iter().map(|change| Override::parse(change).expect("an assignment")).collect();
    Plant::load(vehicle, &changes).expect("built in")
}

fn weather(ambient_degc: f64, relative_humidity: f64, speed_m_s: f64) -> Disturbance {
    let ambient_k = Celsius(ambient_degc).kelvin();
    Disturbance {
        start_speed_m_s: speed_m_s,
        end_speed_m_s: speed_m_s,
        air: air::at_temperature(ambient_k),
        ambient_humidity_ratio: moist_air::humidity_ratio(relative_humidity, ambient_k),
        solar_gain_w: 0.0,
        occupants: 1.0,
        grade: 0.0,
        headwind_m_s: 0.0,
    }
}

fn command(plant: &Plant, options: &[(&str, &str)], levels: &[(&str, f64)]) -> Command {
    let mut command = plant.ranges.encode(&plant.ranges.idle());
    for (name, option) in options {
        plant.ranges.choose(&mut command, name, option).unwrap_or_else(|error| panic!("{error}"));
    }
    for (name, value) in levels {
        plant.ranges.set(&mut command, name, *value).unwrap_or_else(|error| panic!("{error}"));
    }
    command
}

/// Some seconds with `physics::check` on each; the last one's record.
fn drive(
    plant: &Plant,
    state: &mut State,
    command: &Command,
    disturbance: &Disturbance,
    seconds: usize,
) -> StepRecord {
    let mut last = StepRecord::default();
    for _ in 0..seconds {
        let before = *state;
        last = plant.step(state, command, disturbance);
        let step =
            support::Step { plant, before: &before, after: state, command, disturbance, record: &last };
        physics::check(&step);
    }
    last
}

fn parked(plant: &Plant, degc: f64) -> State {
    plant.parked(&InitialParameters::soaked(Celsius(degc), 70.0))
}

const AREA: &str = "ambient_exchanger.frost.area_m2=7";
const NO_FROST: &str = "ambient_exchanger.frost.area_m2=0";

/// Heat taken from the air in half an hour of heating by refrigerant at the air, and the state then.
fn heated(changes: &[&str], relative_humidity: f64) -> (Vec<f64>, State) {
    let plant = plant("jeffs2019-direct", changes);
    let mut state = parked(&plant, 0.0);
    let command = command(
        &plant,
        &[("cabin_condenser", "open"), ("front_evaporator", "open")],
        &[("compressor_power", 1800.0), ("blower_level", 0.7)],
    );
    let weather = weather(0.0, relative_humidity, 8.0);
    let heats_w =
        (0..30).map(|_| drive(&plant, &mut state, &command, &weather, 60).flows[Flow::EVAPORATOR]).collect();
    (heats_w, state)
}

#[test]
fn frost_grows_in_humid_air_only_and_costs_heat() {
    let (humid_w, humid) = heated(&[AREA], 0.9);
    let (dry_w, dry) = heated(&[AREA], 0.0);
    let (never_w, never) = heated(&[NO_FROST], 0.9);
    assert_eq!(dry.frosts, never.frosts);
    assert_eq!(dry_w, never_w, "dry air is air without frost, to the last bit");
    assert!(humid.frosts[0].mass_kg > 0.2, "{:?}", humid.frosts);
    // At first vapour brings heat of its own; in the end the layer costs more.
    assert!(humid_w[29] < 0.9 * dry_w[29], "{} {}", humid_w[29], dry_w[29]);
}

#[test]
fn mean_effect_of_energyplus_takes_its_share_of_the_conductance() {
    let simple = [AREA, "ambient_exchanger.frost.model=\"multipliers\""];
    let (simple_w, state) = heated(&simple, 0.9);
    let (never_w, _) = heated(&[NO_FROST], 0.9);
    assert_eq!(state.frosts[0].mass_kg, 0.0);
    assert!(
        simple_w[29] < never_w[29] && simple_w[29] > 0.7 * never_w[29],
        "{} {}",
        simple_w[29],
        never_w[29]
    );
}

/// Coolant takes heat from humid air, then frost melts in warm air, by heat of the HTC, or not at all in the cold.
#[test]
fn frost_of_a_coolant_branch_melts_at_rest_above_zero_and_by_heat_of_the_htc() {
    let plant = plant("jeffs2019", &[AREA]);
    let mut state = parked(&plant, 2.0);
    for member in ["chiller_supply", "chiller_return"] {
        let node = plant.layout().nodes.iter().position(|row| row.stem == member).expect("a node");
        state.temperatures_k[node] = Celsius(-8.0).kelvin();
    }
    let levels = [
        ("compressor_power", 2000.0),
        ("htc_flow", 0.35),
        ("chiller_flow", 0.35),
        ("blower_level", 0.8),
        ("ambient_request", 20_000.0),
        ("cabin_request", 20_000.0),
    ];
    let heating = command(&plant, &[("cabin", "htc"), ("ambient", "chiller")], &levels);
    drive(&plant, &mut state, &heating, &weather(2.0, 0.9, 10.0), 1200);
    let frost_kg = state.frosts[0].mass_kg;
    assert!(frost_kg > 0.01, "{frost_kg}");

    let idle = command(&plant, &[], &[]);
    let mut rested = state;
    drive(&plant, &mut rested, &idle, &weather(-3.0, 0.9, 0.0), 600);
    assert_eq!(rested.frosts[0].mass_kg, frost_kg, "no sublimation is modelled");
    drive(&plant, &mut rested, &idle, &weather(4.0, 0.9, 0.0), 3600);
    assert!(rested.frosts[0].mass_kg < 0.5 * frost_kg, "{:?}", rested.frosts);

    let melting = command(
        &plant,
        &[("ambient", "htc"), ("ptc", "allowed")],
        &[("htc_flow", 0.35), ("ambient_request", 20_000.0), ("cabin_set_point", 300.0)],
    );
    drive(&plant, &mut state, &melting, &weather(-3.0, 0.9, 0.0), 300);
    assert_eq!(state.frosts[0].mass_kg, 0.0, "the HTC melts it below 0 degC too");
}

#[test]
fn both_executors_grow_the_same_frost() {
    let compiled = plant("jeffs2019-direct", &[AREA]);
    let planned = compiled.clone().with_planned_network();
    let command = command(
        &compiled,
        &[("cabin_condenser", "open"), ("front_evaporator", "open")],
        &[("compressor_power", 1800.0), ("blower_level", 0.7)],
    );
    let mut states = [parked(&compiled, -2.0), parked(&planned, -2.0)];
    for _ in 0..300 {
        let weather = weather(-2.0, 0.95, 8.0);
        let [a, b] = &mut states;
        assert_eq!(compiled.step(a, &command, &weather), planned.step(b, &command, &weather));
    }
    assert_eq!(states[0], states[1]);
    assert!(states[0].frosts[0].mass_kg > 0.0);
}
