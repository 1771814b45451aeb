//! Vehicles that cannot follow their cycle: they fall behind, go on, and drive the whole way.

#[path = "support/mod.rs"]
mod support;

use hp_plant::config::kinds::VEHICLE;
use hp_plant::config::library::{self, Override};
use hp_plant::flows::Flow;
use hp_trip::experiment::Experiment;
use hp_trip::kinds::CYCLE;
use hp_trip::pace::{ARRIVAL_TOLERANCE_M, LONGEST_DELAY_S, LONGEST_STANDSTILL_S};
use hp_trip::run::{EndReason, Run};
use proptest::prelude::*;
use rayon::prelude::*;
use std::path::Path;
use support::TOLERANCE;

/// Cars of the examples, by path.
fn example_cars() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cars");
    let files = std::fs::read_dir(folder).expect("examples").map(|entry| entry.expect("an entry").path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let mut cars: Vec<String> = files.map(|path| path.to_str().expect("plain name").to_owned()).collect();
    cars.sort();
    cars
}

fn load(vehicle: Option<&str>, overrides: &[&str]) -> Experiment {
    let overrides: Vec<_> = overrides.iter().map(|text| Override::parse(text).expect("valid")).collect();
    Experiment::with_vehicle("jeffs2019/case1-4", vehicle, None, &overrides).expect("built in")
}

/// A trip on a cycle from a soak, with more overrides.
fn trip(cycle: &str, degc: f64, more: &[&str]) -> Experiment {
    let texts = [
        format!("scenario.cycle=\"{cycle}\""),
        format!("scenario.climate.ambient_temperature_degc={degc:.1}"),
        format!("scenario.initial.soak_temperature_degc={degc:.1}"),
        "scenario.initial.state_of_charge_pct=90".to_owned(),
    ];
    let all: Vec<&str> = texts.iter().map(String::as_str).chain(more.iter().copied()).collect();
    load(None, &all)
}

/// Drives to the end, checks every second, and returns the run.
fn driven(experiment: &Experiment) -> (Run, EndReason) {
    let mut run = experiment.start();
    let (duration_s, speeds_m_s) = (experiment.cycle.duration_s(), experiment.cycle.speeds_m_s());
    loop {
        let command = experiment.rule_based_command(&mut run);
        let before_m_s = run.pace.speed_m_s;
        let end = experiment.step(&mut run, &command);
        let record = run.record.expect("a step was made");
        assert!(record.ledger.relative() < TOLERANCE, "{:?} after {} s", record.ledger, run.steps);
        assert_eq!(run.pace.speed_m_s, record.end_speed_m_s);
        if let Some(&speed_m_s) = speeds_m_s.get(run.steps) {
            assert!(run.pace.speed_m_s <= speed_m_s, "faster than the cycle after {} s", run.steps);
        }
        assert!(run.pace.speed_m_s >= 0.0 && run.steps <= duration_s + LONGEST_DELAY_S);
        // Traction takes all that there is before a watt of heat is made.
        let limited = record.flows[Flow::TRACTION] > 0.0 && run.state.short_of_power;
        if limited {
            let heat_w = record.flows[Flow::COMPRESSOR]
                + experiment.plant.layout().heaters.iter().map(|h| record.flows[h.flow]).sum::<f64>();
            assert!(
                heat_w < 1.0,
                "{heat_w} W of heat while the battery limits traction, from {before_m_s} m/s"
            );
        }
        if let Some(reason) = end {
            return (run, reason);
        }
    }
}

fn total(experiment: &Experiment, run: &Run, name: &str) -> f64 {
    let totals = run.summary.values(experiment.plant.layout());
    totals.iter().find(|(found, _)| found == name).and_then(|(_, value)| *value).expect(name)
}

fn assert_whole_way(experiment: &Experiment, run: &Run, reason: EndReason) {
    assert_eq!(reason, EndReason::Arrived, "after {} s, {:?}", run.steps, run.pace);
    let missing_m = experiment.cycle.distance_m() - 1000.0 * total(experiment, run, "distance_km");
    assert!(missing_m.abs() <= ARRIVAL_TOLERANCE_M, "{missing_m} m");
    let delay_s = run.steps - experiment.cycle.duration_s();
    assert_eq!(total(experiment, run, "delay_s"), delay_s as f64);
}

/// Issue 16, show 5.
#[test]
fn us06_at_minus_seven_degrees_is_driven_to_its_end_at_most_30_s_late() {
    for controller_heats in [true, false] {
        let more: &[&str] = if controller_heats { &[] } else { &["scenario.strategy.ptc=false"] };
        let experiment = trip("us06", -7.0, more);
        let (run, reason) = driven(&experiment);
        assert_whole_way(&experiment, &run, reason);
        let delay_s = run.steps - experiment.cycle.duration_s();
        println!(
            "US06 at -7 degC: {delay_s} s late, {:.0} m behind at most",
            total(&experiment, &run, "furthest_behind_m")
        );
        assert!(delay_s <= 30, "{delay_s} s late");
    }
}

#[test]
fn a_weak_motor_falls_behind_and_drives_the_whole_way() {
    for (power_w, force_n) in [(20_000.0, 12_000.0), (50_000.0, 12_000.0), (180_000.0, 2500.0)] {
        let weak = [
            format!("vehicle.motor.maximum_mechanical_power_w={power_w:.1}"),
            format!("vehicle.motor.maximum_tractive_force_n={force_n:.1}"),
        ];
        let experiment = trip("us06", 20.0, &[&weak[0], &weak[1]]);
        let (run, reason) = driven(&experiment);
        assert_whole_way(&experiment, &run, reason);
        assert!(total(&experiment, &run, "furthest_behind_m") > 100.0);
        assert!(run.steps > experiment.cycle.duration_s() + 10, "{} s", run.steps);
    }
}

#[test]
fn a_vehicle_that_follows_is_not_late_and_never_behind() {
    library::names(hp_trip::kinds::SCENARIO).par_iter().for_each(|name| {
        let experiment = Experiment::load(name, None, &[]).expect("built in");
        let (run, reason) = driven(&experiment);
        assert_eq!(reason, EndReason::Arrived);
        assert_eq!(run.steps, experiment.cycle.duration_s());
        assert_eq!((run.pace.behind_m, total(&experiment, &run, "furthest_behind_m")), (0.0, 0.0), "{name}");
        assert_eq!(total(&experiment, &run, "delay_s"), 0.0);
    });
}

#[test]
fn a_snapshot_taken_while_behind_goes_on_with_the_same_bits() {
    let experiment = trip("us06", -15.0, &["vehicle.motor.maximum_mechanical_power_w=25000.0"]);
    let (whole, _) = driven(&experiment);
    let mut run = experiment.start();
    let mut copies = Vec::new();
    let mut end = None;
    while end.is_none() {
        if run.pace.behind_m > 0.0 && run.steps.is_multiple_of(20) {
            copies.push(run);
        }
        let command = experiment.rule_based_command(&mut run);
        end = experiment.step(&mut run, &command);
    }
    assert!(copies.len() > 5 && copies.iter().any(|copy| copy.steps > experiment.cycle.duration_s()));
    for mut copy in copies {
        let mut end = None;
        while end.is_none() {
            let command = experiment.rule_based_command(&mut copy);
            end = experiment.step(&mut copy, &command);
        }
        assert_eq!((copy.steps, copy.pace, copy.state), (whole.steps, whole.pace, whole.state));
        assert_eq!(
            copy.summary.values(experiment.plant.layout()),
            whole.summary.values(experiment.plant.layout())
        );
    }
}

#[test]
fn substeps_and_whole_seconds_fall_behind_alike() {
    let weak = ["vehicle.motor.maximum_mechanical_power_w=50000.0"];
    let whole = trip("us06", 10.0, &weak);
    let fine = trip("us06", 10.0, &weak).with_substeps(10);
    let ((whole_run, whole_end), (fine_run, fine_end)) = (driven(&whole), driven(&fine));
    assert_whole_way(&whole, &whole_run, whole_end);
    assert_whole_way(&fine, &fine_run, fine_end);
    assert!(whole_run.steps.abs_diff(fine_run.steps) <= 3, "{} and {} s", whole_run.steps, fine_run.steps);
    let energies = [&whole_run, &fine_run].map(|run| run.summary.energy_j(Flow::BATTERY));
    assert!((energies[0] / energies[1] - 1.0).abs() < 0.01, "{energies:?} J");
}

#[test]
fn a_car_that_cannot_move_ends_as_immobile_and_one_far_too_slow_as_late() {
    let dead = trip("udds", 0.0, &["vehicle.battery.discharge_limit.rate_scale=0.0"]);
    let (run, reason) = driven(&dead);
    assert_eq!((reason, run.pace.stuck_s), (EndReason::Immobile, LONGEST_STANDSTILL_S));
    let slow = trip("artemis-motorway-150", 0.0, &["vehicle.motor.maximum_mechanical_power_w=3000.0"]);
    let (run, reason) = driven(&slow);
    assert_eq!((reason, run.steps), (EndReason::Late, slow.cycle.duration_s() + LONGEST_DELAY_S));
    let empty = trip("wltc-class3b", 0.0, &["scenario.initial.state_of_charge_pct=4"]);
    assert_eq!(driven(&empty).1, EndReason::BatteryEmpty);
}

/// Every vehicle on every cycle in every climate.
#[test]
fn all_cars_arrive_on_all_cycles_in_all_climates() {
    let built_in: Vec<String> = library::names(VEHICLE).into_iter().map(str::to_owned).collect();
    let all: Vec<String> = built_in.into_iter().chain(example_cars()).collect();
    let late: Vec<(f64, String)> = all
        .par_iter()
        .flat_map_iter(|vehicle| {
            let cycles = library::names(CYCLE).into_iter();
            cycles.flat_map(move |cycle| {
                [-30.0, -20.0, -7.0, 0.0, 15.0, 45.0].map(move |degc: f64| (vehicle.clone(), cycle, degc))
            })
        })
        .map(|(vehicle, cycle, degc)| {
            let texts = [
                format!("scenario.cycle=\"{cycle}\""),
                format!("scenario.climate.ambient_temperature_degc={degc:.1}"),
                format!("scenario.initial.soak_temperature_degc={degc:.1}"),
                "scenario.initial.state_of_charge_pct=90".to_owned(),
            ];
            let experiment = load(Some(&vehicle), &texts.each_ref().map(String::as_str));
            let (run, reason) = driven(&experiment);
            let name = format!("{vehicle} on {cycle} at {degc} degC");
            assert_eq!(reason, EndReason::Arrived, "{name} after {} s", run.steps);
            assert_whole_way(&experiment, &run, reason);
            (total(&experiment, &run, "delay_s"), name)
        })
        .filter(|(delay_s, _)| *delay_s > 0.0)
        .collect();
    let mut late = late;
    late.sort_by(|one, other| other.0.total_cmp(&one.0));
    println!("{} trips late, the latest: {:?}", late.len(), &late);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_weak_car_drives_the_whole_way_or_says_why_not(
        power_w in 5e3..8e4_f64, force_n in 1e3..6e3_f64, degc in -25.0..40.0_f64, scale in 0.05..1.0_f64,
        cycle in 0_usize..12,
    ) {
        let cycles = library::names(CYCLE);
        let weak = [
            format!("vehicle.motor.maximum_mechanical_power_w={power_w}"),
            format!("vehicle.motor.maximum_tractive_force_n={force_n}"),
            format!("vehicle.battery.discharge_limit.rate_scale={scale}"),
        ];
        let experiment = trip(cycles[cycle % cycles.len()], degc, &weak.each_ref().map(String::as_str));
        let (run, reason) = driven(&experiment);
        if reason == EndReason::Arrived {
            assert_whole_way(&experiment, &run, reason);
        } else {
            prop_assert!(run.pace.behind_m > ARRIVAL_TOLERANCE_M, "{reason:?}");
        }
    }
}
