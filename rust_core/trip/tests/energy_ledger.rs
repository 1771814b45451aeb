//! The energy ledger: closed at every step of anything, open as soon as one flow is wrong by 1 %.
//!
//! Its blind spot: what a link inside the vehicle takes from one mass and gives to another is one number, so the
//! ledger cannot see it; the tests of the thermal network hold that both ends are served.

#[path = "support/mod.rs"]
mod support;

use hp_plant::circuits::refrigeration_loop::LoopStatus;
use hp_plant::command::Command;
use hp_plant::components::battery::BatteryState;
use hp_plant::config::Celsius;
use hp_plant::config::library;
use hp_plant::flows::{Crossing, Flow, Flows};
use hp_plant::plant::{Disturbance, Plant, Stage, StepRecord};
use hp_plant::state::State;
use hp_trip::experiment::Experiment;
use hp_trip::kinds::SCENARIO;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use support::{RandomScenario, TOLERANCE, on_hills, physics, random_scenarios};

const RANDOM_SCENARIOS: u32 = 1000;

#[test]
fn residual_is_round_off_at_every_step_of_all_built_in_scenarios() {
    library::names(SCENARIO).par_iter().for_each(|name| {
        let experiment = Experiment::load(name, None, &[]).expect("built-in scenario");
        let mut run = experiment.start();
        loop {
            let command = experiment.rule_based_command(&mut run);
            let end = experiment.step(&mut run, &command);
            let entry = run.record.expect("a step was made").ledger;
            assert!(entry.relative() < TOLERANCE, "{name} at {} s: {entry:?}", run.state.time_s);
            if end.is_some() {
                break;
            }
        }
    });
}

/// Drives one random scenario, checks every step and returns the statuses it visited.
fn drive(plant: &Plant, scenario: &RandomScenario) -> Vec<LoopStatus> {
    let mut statuses = Vec::new();
    scenario.drive(plant, |_, step| {
        physics::check(step);
        let (record, cycle) = (step.record, plant.refrigeration.as_ref().expect("it has a heat pump"));
        if record.refrigeration.running() {
            let margins = cycle.stream_margins_k(&record.boundary, &record.refrigeration);
            assert!(margins.iter().all(|&margin| margin >= -1e-9), "streams cross: {margins:?} {record:?}");
        }
        statuses.push(record.refrigeration.status);
    });
    statuses
}

#[test]
fn ledger_closes_streams_never_cross_and_limits_hold_in_a_thousand_random_scenarios() {
    let plant = Plant::load("jeffs2019", &[]).expect("built-in vehicle");
    let scenarios = random_scenarios(&plant, RANDOM_SCENARIOS);
    let visited: BTreeMap<String, usize> = scenarios
        .par_iter()
        .flat_map_iter(|scenario| drive(&plant, scenario))
        .fold(BTreeMap::new, |mut counts: BTreeMap<String, usize>, status| {
            *counts.entry(format!("{status:?}")).or_default() += 1;
            counts
        })
        .reduce(BTreeMap::new, |mut all, part| {
            for (status, count) in part {
                *all.entry(status).or_default() += count;
            }
            all
        });
    println!("statuses visited: {visited:?}");
    for status in [
        LoopStatus::Off,
        LoopStatus::NoLift,
        LoopStatus::Converged,
        LoopStatus::MinimumSpeed,
        LoopStatus::SpeedLimited,
        LoopStatus::PressureLimited,
        LoopStatus::SuctionLimited,
        LoopStatus::CoolantLimited,
        LoopStatus::DischargeLimited,
    ] {
        assert!(visited.contains_key(&format!("{status:?}")), "{status:?} was never visited: {visited:?}");
    }
}

/// Published values of cold cells, tyres and oil: the battery's rate limits then remember the current.
#[test]
fn ledger_closes_with_a_battery_tyres_and_oil_as_cold_as_real_ones() {
    let vehicle = concat!(env!("CARGO_MANIFEST_DIR"), "/../plant/tests/data/cold.toml");
    let plant = Plant::load(vehicle, &[]).expect("it loads");
    random_scenarios(&plant, RANDOM_SCENARIOS).par_iter().for_each(|scenario| {
        scenario.drive(&plant, |_, step| physics::check(step));
    });
}

/// Grades to 20 %, wind to 15 m/s from either side, air that is up to 5 K warmer or colder from one moment to the next.
#[test]
fn ledger_closes_and_limits_hold_on_hills_in_wind_and_changing_weather() {
    for vehicle in ["jeffs2019", "direct_ev"] {
        let plant = Plant::load(vehicle, &[]).expect("built-in vehicle");
        on_hills(random_scenarios(&plant, RANDOM_SCENARIOS)).par_iter().for_each(|scenario| {
            let mut climbed = false;
            scenario.drive(&plant, |_, step| {
                physics::check(step);
                climbed |= step.record.flows[Flow::CLIMB].abs() > 1000.0;
            });
            assert!(climbed, "{scenario:?}");
        });
    }
}

/// A moment in which some of the flows are at work.
struct Moment {
    experiment: Experiment,
    state: State,
    command: Command,
    disturbance: Disturbance,
}

impl Moment {
    /// A scenario some seconds after its start.
    fn of(scenario: &str, overrides: &[&str], after_s: usize) -> Self {
        let overrides: Vec<_> =
            overrides.iter().map(|text| library::Override::parse(text).expect("valid")).collect();
        let experiment = Experiment::load(scenario, None, &overrides).expect("built-in scenario");
        let mut run = experiment.start();
        for _ in 0..after_s {
            let command = experiment.rule_based_command(&mut run);
            experiment.step(&mut run, &command);
        }
        let command = experiment.rule_based_command(&mut run);
        let disturbance = experiment.next_disturbance(after_s, &run.pace);
        Self { state: run.state, command, disturbance, experiment }
    }

    /// What happens in the next second, one flow perhaps falsified.
    fn step(&self, tamper: impl FnMut(Stage, &mut Flows)) -> StepRecord {
        let mut state = self.state;
        let mut record = StepRecord::default();
        self.experiment.plant.step_with(&mut state, &self.command, &self.disturbance, &mut record, tamper);
        record
    }
}

/// Heating at full swing, hard braking with a cold battery, air conditioning, and a battery that gives next to nothing.
fn moments() -> Vec<Moment> {
    let sun = ["scenario.climate.solar_gain_w=300", "scenario.climate.occupants=2"];
    let humid = ["scenario.climate.relative_humidity=0.6", "vehicle.cabin.solar_to_furnishings_share=0.8"];
    let starved = [
        "scenario.initial.soak_temperature_degc=-36.0",
        "scenario.climate.ambient_temperature_degc=-36.0",
        "vehicle.battery.discharge_limit.rate_scale=0.002",
    ];
    let warm_store =
        ["scenario.initial.thermal_battery_temperature_degc=40", "scenario.strategy.transmission=true"];
    vec![
        Moment::of("jeffs2019/case1-1", &[sun[0], sun[1], warm_store[0], warm_store[1]], 60),
        Moment::of("jeffs2019/case1-3", &[], 1740),
        Moment::of("ours/hot-soak-plus35", &humid, 120),
        Moment::of("jeffs2019/case1-4", &starved, 14),
    ]
}

/// Checks that falsifying each flow by 1 % is noticed in every moment in which it is at work.
fn every_falsification_is_noticed(flows: &[Flow], falsify: impl Fn(Flow, Stage, &mut Flows)) {
    let moments = moments();
    for moment in &moments {
        assert!(moment.step(|_, _| {}).ledger.relative() < TOLERANCE);
    }
    for &flow in flows {
        let mut at_work = 0;
        for moment in &moments {
            if moment.step(|_, _| {}).flows[flow].abs() < 1.0 {
                continue;
            }
            at_work += 1;
            let residual = moment.step(|stage, flows| falsify(flow, stage, flows)).ledger.relative();
            assert!(residual > 10.0 * TOLERANCE, "{flow:?}: {residual:e}");
        }
        assert!(at_work > 0, "{flow:?} is not at work in any of the moments");
    }
}

/// Flows of the default vehicle that a rule picks; as many as there were when each was listed by name.
fn flows_of_the_default(count: usize, pick: impl Fn(&Plant, &mut BTreeSet<Flow>)) -> Vec<Flow> {
    let mut flows = BTreeSet::new();
    pick(&Plant::load("jeffs2019", &[]).expect("built-in vehicle"), &mut flows);
    assert_eq!(flows.len(), count, "{flows:?}");
    flows.into_iter().collect()
}

#[test]
fn scaling_any_load_between_battery_and_its_heat_opens_the_ledger() {
    let loads = flows_of_the_default(7, |plant, flows| {
        let layout = plant.layout();
        flows.extend(&layout.base_loads);
        flows.extend(layout.heaters.iter().map(|heater| heater.flow));
        flows.insert(Flow::COMPRESSOR);
    });
    every_falsification_is_noticed(&loads, |flow, stage, flows| match stage {
        Stage::Loads => flows[flow] *= 1.01,
        Stage::Heat => flows[flow] /= 1.01,
        Stage::Ledger => {}
    });
}

#[test]
fn scaling_the_traction_power_that_the_battery_feeds_opens_the_ledger() {
    every_falsification_is_noticed(&[Flow::TRACTION], |flow, stage, flows| {
        if stage == Stage::Loads {
            flows[flow] *= 1.01;
        }
    });
}

/// What comes from outside is counted where it is scaled, so only heat from inside can be missing.
#[test]
fn scaling_any_heat_source_of_the_network_opens_the_ledger() {
    let sources = flows_of_the_default(9, |plant, flows| {
        let layout = plant.layout();
        let brought = layout.sources.iter().map(|source| source.flow);
        let brought = brought.chain(layout.inlets.iter().map(|inlet| inlet.flow));
        let inside = |flow: &Flow| {
            layout.flows.iter().any(|row| row.flow == *flow && row.crossing == Crossing::Inside)
        };
        flows.extend(brought.filter(inside));
    });
    every_falsification_is_noticed(&sources, |flow, stage, flows| {
        if stage == Stage::Heat {
            flows[flow] *= 1.01;
        }
    });
}

#[test]
fn scaling_any_flow_across_the_boundary_opens_the_ledger() {
    let boundary = flows_of_the_default(24, |plant, flows| {
        let crossing = plant.layout().flows.iter().filter(|row| row.crossing != Crossing::Inside);
        flows.extend(crossing.map(|row| row.flow));
    });
    every_falsification_is_noticed(&boundary, |flow, stage, flows| {
        if stage == Stage::Ledger {
            flows[flow] *= 1.01;
        }
    });
}

#[test]
fn charge_drawn_cold_and_returned_warm_is_conserved() {
    let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built-in scenario");
    let battery = &experiment.plant.battery;
    let start: BatteryState = battery.rested(0.6);
    let cold = battery.during(&start, Celsius(-20.0).kelvin(), 1.0).draw(15_000.0).state;
    let current_a = cold.charge_drawn_c - start.charge_drawn_c;
    let mut power_w = -15_000.0;
    // The charging power that returns exactly the same charge, warm.
    for _ in 0..200 {
        let step = battery.during(&cold, Celsius(25.0).kelvin(), 1.0).draw(power_w);
        power_w *= current_a / (cold.charge_drawn_c - step.state.charge_drawn_c);
    }
    let end = battery.during(&cold, Celsius(25.0).kelvin(), 1.0).draw(power_w).state;
    assert!((battery.state_of_charge(&end) - 0.6).abs() < 1e-12);
    assert!((battery.usable_state_of_charge(&end, Celsius(25.0).kelvin()) - 0.6).abs() < 1e-12);
}
