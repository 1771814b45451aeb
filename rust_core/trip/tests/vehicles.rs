//! Every built-in vehicle and every one in `examples/cars`, whatever its architecture: physics holds at every step, and both
//! executors agree to the last bit.

#[path = "support/mod.rs"]
mod support;

use hp_plant::config::kinds::VEHICLE;
use hp_plant::config::library::{self, Override};
use hp_plant::plant::{Plant, StepRecord};
use hp_plant::state::State;
use hp_trip::experiment::Experiment;
use hp_trip::run::EndReason;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;
use support::{Step, on_hills, physics, random_scenarios};

/// Random scenarios for each vehicle besides the default, which has a test of its own with more.
const RANDOM_SCENARIOS: u32 = 150;

const AMBIENTS_DEGC: [f64; 10] = [-30.0, -20.0, -12.0, -7.0, 0.0, 8.0, 20.0, 32.0, 40.0, 45.0];

/// Names of the built-in vehicles, and paths of those that are examples.
fn every_car() -> Vec<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/cars");
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let outside: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .map(|path| path.to_str().expect("plain name").to_owned())
        .collect();
    assert_eq!(outside.len(), 5, "cars in {folder}");
    library::names(VEHICLE).into_iter().map(str::to_owned).chain(outside).collect()
}

/// A trip with everything allowed, heating and cooling, at an ambient temperature.
fn experiment(vehicle: &str, controller: &str, ambient_degc: f64) -> Experiment {
    let mut changes = vec![
        format!("scenario.climate.ambient_temperature_degc={ambient_degc}"),
        format!("scenario.initial.soak_temperature_degc={ambient_degc}"),
        // Dew points up to 16 degC.
        format!("scenario.climate.relative_humidity={}", if ambient_degc > 16.0 { 0.25 } else { 0.9 }),
        "scenario.strategy.climate_control=auto".to_owned(),
        "scenario.strategy.battery=heat".to_owned(),
    ];
    let members = ["motor", "transmission", "ambient", "thermal_battery", "ptc"];
    changes.extend(members.map(|member| format!("scenario.strategy.{member}=true")));
    let changes: Vec<Override> =
        changes.iter().map(|text| Override::parse(text).expect("an assignment")).collect();
    Experiment::with_vehicle("jeffs2019/case1-1", Some(vehicle), Some(controller), &changes)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Drives a trip by its rules and shows every step; the cabin's temperature at the end [degC].
fn drive(experiment: &Experiment, mut look: impl FnMut(&Step<'_>)) -> f64 {
    let mut run = experiment.start();
    loop {
        let command = experiment.rule_based_command(&mut run);
        let (before, disturbance) = (run.state, experiment.disturbance(run.steps));
        let end = experiment.step(&mut run, &command);
        look(&Step {
            plant: &experiment.plant,
            before: &before,
            after: &run.state,
            command: &command,
            disturbance: &disturbance,
            record: run.record.as_ref().expect("a step was made"),
        });
        if let Some(end) = end {
            assert_eq!(end, EndReason::Arrived);
            let values = run.summary.values(experiment.plant.layout());
            let breaches = values.iter().find(|(name, _)| name == "limit_breaches").expect("a total");
            assert_eq!(breaches.1, Some(0.0), "limits were breached");
            return run.state.temperatures_k[experiment.plant.layout().cabins[0].air.index()] - 273.15;
        }
    }
}

#[test]
fn every_architecture_has_a_vehicle_and_every_vehicle_a_compiled_network() {
    let mut architectures = BTreeSet::new();
    for name in library::names(VEHICLE) {
        let plant = Plant::load(name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(plant.network.is_compiled(), "{name}");
        assert!(!plant.clone().with_planned_network().network.is_compiled(), "{name}");
        architectures.insert(plant.vehicle.architecture.clone());
    }
    let known: BTreeSet<String> =
        library::names(hp_plant::config::kinds::ARCHITECTURE).into_iter().map(str::to_owned).collect();
    assert_eq!(architectures, known);
}

#[test]
fn physics_holds_in_every_vehicle_under_the_rules_from_minus_30_to_45_degc() {
    let mut cases = Vec::new();
    let cars = every_car();
    for vehicle in &cars {
        for controller in ["hpcu", "hpcu-modern", "thermostat"] {
            cases.extend(AMBIENTS_DEGC.map(|ambient_degc| (vehicle, controller, ambient_degc)));
        }
    }
    cases.par_iter().for_each(|&(vehicle, controller, ambient_degc)| {
        let experiment = experiment(vehicle, controller, ambient_degc);
        let mut cooled = false;
        let cabin_degc = drive(&experiment, |step| {
            physics::check(step);
            cooled |= step.record.refrigeration.running() && ambient_degc > 30.0;
        });
        println!("{vehicle}, {controller}, {ambient_degc} degC: cabin at {cabin_degc:.2} degC");
        // The HPCU reaches its target where the heaters suffice; everything warms the cabin on the coldest days, and cools it
        // where there is something that cools.
        // A second cabin gets its heat and cold from machines that were made for one.
        let layout = experiment.plant.layout();
        let (least_rise_k, highest_degc) = if layout.cabins.len() == 1 { (15.0, 28.0) } else { (10.0, 32.0) };
        // The paper's HPCU warms the battery before the cabin, and one of 60 kWh takes longer.
        let waits = controller == "hpcu" && vehicle.as_str() == "crossover_ev";
        let least_rise_k = if waits { 12.0 } else { least_rise_k };
        if controller.starts_with("hpcu") && (0.0..=8.0).contains(&ambient_degc) {
            assert!((20.0..24.0).contains(&cabin_degc), "{vehicle}, {ambient_degc}: {cabin_degc} degC");
        }
        if ambient_degc <= -7.0 {
            assert!(
                cabin_degc > ambient_degc + least_rise_k,
                "{vehicle}, {controller}, {ambient_degc}: {cabin_degc} degC"
            );
        }
        let refrigerates = layout.refrigerates();
        if ambient_degc > 30.0 && refrigerates {
            assert!(
                (18.0..highest_degc).contains(&cabin_degc),
                "{vehicle}, {controller}, {ambient_degc}: {cabin_degc} degC"
            );
        }
        assert_eq!(cooled, ambient_degc > 30.0 && refrigerates, "{vehicle}, {controller}, {ambient_degc}");
    });
}

/// A vehicle in whose cabins the sun meets air and furnishings, and some exhaust heat is recovered where a loop can have it.
fn with_every_flow(vehicle: &str, more: &[&str]) -> Plant {
    let plant = Plant::load(vehicle, &[]).unwrap_or_else(|error| panic!("{error}"));
    let sections = plant.layout().cabins.iter().map(|cabin| &plant.layout().members[cabin.member].section);
    let shares = sections.flat_map(|section| {
        ["solar_to_furnishings_share=0.5", "exhaust_recovery_share=0.3"]
            .map(|share| format!("{section}.{share}"))
    });
    let changes = shares.chain(more.iter().map(|text| (*text).to_owned()));
    let changes: Vec<Override> = changes.map(|text| Override::parse(&text).expect("an assignment")).collect();
    Plant::load(vehicle, &changes).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn physics_holds_in_every_vehicle_under_random_commands_and_everything_is_at_work_at_some_time() {
    for vehicle in every_car().iter().filter(|name| *name != "jeffs2019") {
        let plant = with_every_flow(vehicle, &[]);
        // Only a battery that gives nothing leaves pumps and 12 V loads without power.
        let empty = with_every_flow(vehicle, &["battery.discharge_limit.rate_scale=0.0"]);
        let layout = plant.layout();
        let seen: BTreeSet<usize> = on_hills(random_scenarios(&plant, RANDOM_SCENARIOS))
            .par_iter()
            .enumerate()
            .flat_map_iter(|(number, scenario)| {
                let mut seen = BTreeSet::new();
                scenario.drive(if number == 0 { &empty } else { &plant }, |_, step| {
                    physics::check(step);
                    seen.extend(
                        layout
                            .flows
                            .iter()
                            .map(|row| row.flow)
                            .filter_map(|flow| (step.record.flows[flow] != 0.0).then_some(flow.index())),
                    );
                });
                seen
            })
            .collect();
        for row in &layout.flows {
            assert!(seen.contains(&row.flow.index()), "{vehicle}: {} was never at work", row.column);
        }
    }
}

fn bits(state: &State, record: &StepRecord) -> Vec<u64> {
    let values = state.temperatures_k.iter().chain(record.flows.values()).copied();
    let others = [state.battery.charge_drawn_c, record.refrigeration.speed_rev_s, record.ledger.residual_w];
    values.chain(others).map(f64::to_bits).collect()
}

#[test]
fn compiled_and_planned_executors_agree_to_the_last_bit_under_the_rules() {
    library::names(VEHICLE).par_iter().for_each(|vehicle| {
        for ambient_degc in [-12.0, 2.0, 35.0] {
            let compiled = experiment(vehicle, "hpcu", ambient_degc);
            let mut planned = compiled.clone();
            planned.plant = Arc::new((*compiled.plant).clone().with_planned_network());
            let mut expected = Vec::new();
            drive(&compiled, |step| expected.push(bits(step.after, step.record)));
            let mut step_number = 0;
            drive(&planned, |step| {
                assert_eq!(
                    bits(step.after, step.record),
                    expected[step_number],
                    "{vehicle}: step {step_number}"
                );
                step_number += 1;
            });
            assert_eq!(step_number, expected.len());
        }
    });
}

#[test]
fn compiled_and_planned_executors_agree_to_the_last_bit_under_random_commands() {
    library::names(VEHICLE).par_iter().for_each(|vehicle| {
        let compiled = Plant::load(vehicle, &[]).expect("built-in vehicle");
        let planned = compiled.clone().with_planned_network();
        for scenario in random_scenarios(&compiled, 20) {
            let mut expected = Vec::new();
            scenario.drive(&compiled, |_, step| expected.push(bits(step.after, step.record)));
            scenario.drive(&planned, |second, step| {
                assert_eq!(bits(step.after, step.record), expected[second], "{vehicle}: step {second}");
            });
        }
    });
}
