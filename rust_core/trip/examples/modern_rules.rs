//! What the options of `hpcu-modern` do, as tables in Markdown.
//!
//! `cargo run --release -p hp_trip --example modern_rules -- steady hpcu hpcu-modern`: electrical power at a constant 60 km/h
//! after two hours, for cabins that began warm or cold. `cold-start`: the first 18 minutes at -15 degC with a PTC of 7 kW, the
//! battery heated. `ptc-alone`: energy of each with the heat pump and with the PTC alone at equal comfort. `climates`: energy and
//! discomfort of each over three trips at 13 ambient temperatures. Rules by name or path.

use hp_plant::config::library::Override;
use hp_plant::flows::Flow;
use hp_trip::experiment::Experiment;
use hp_trip::run::{EndReason, Run};
use std::io::Write as _;

/// Scenario with all heat sources, PTC, heating and air conditioning.
const SCENARIO: &str = "ours/commute-minus5";

fn main() {
    let mut arguments = std::env::args().skip(1);
    let what = arguments.next().unwrap_or_else(|| "steady".to_owned());
    let mut rules: Vec<String> = arguments.collect();
    if rules.is_empty() {
        rules = ["hpcu", "hpcu-modern"].map(str::to_owned).into();
    }
    for rules in &rules {
        println!("\n{rules}\n");
        match what.as_str() {
            "steady" => steady(rules),
            "cold-start" => cold_start(rules),
            "ptc-alone" => ptc_alone(rules),
            "climates" => climates(rules),
            other => panic!("`{other}` is no table; there are steady, cold-start, ptc-alone and climates"),
        }
    }
}

fn load(rules: &str, changes: &[String]) -> Experiment {
    let changes: Vec<Override> =
        changes.iter().map(|text| Override::parse(text).expect("an assignment")).collect();
    Experiment::load(SCENARIO, Some(rules), &changes).unwrap_or_else(|error| panic!("{error}"))
}

/// Drives for so many seconds or to the end, and shows every second.
fn drive(experiment: &Experiment, seconds: usize, mut look: impl FnMut(&Run)) -> Run {
    let mut run = experiment.start();
    for _ in 0..seconds {
        let command = experiment.rule_based_command(&mut run);
        let end = experiment.step(&mut run, &command);
        look(&run);
        if let Some(end) = end {
            assert_eq!(end, EndReason::Arrived);
            break;
        }
    }
    run
}

fn celsius(experiment: &Experiment, run: &Run, node: usize) -> f64 {
    let layout = experiment.plant.layout();
    let nodes = [layout.cabins[0].air, layout.battery, experiment.rules.roles().hot_supplies[0]];
    run.state.temperatures_k[nodes[node].index()] - 273.15
}

/// Mean electrical power of everything but traction and constant loads in the last 10 of 120 minutes at 60 km/h.
fn steady(rules: &str) {
    println!(
        "| ambient, degC | cabin began at | power, W | compressor | PTC | blower level | cabin, degC | HTC |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut cycle = tempfile::Builder::new().suffix(".csv").tempfile().expect("a temporary file");
    writeln!(cycle, "time_s,speed_km_h\n0,60.0\n7200,60.0").expect("written");
    for ambient_degc in [-7.0, 0.0, 5.0] {
        let mut powers_w: Vec<f64> = Vec::new();
        for cabin_degc in [0.0, 5.0, 10.0, 15.0, 22.0] {
            let experiment = load(
                rules,
                &[
                    format!("scenario.cycle=\"{}\"", cycle.path().display()),
                    format!("scenario.climate.ambient_temperature_degc={ambient_degc}"),
                    format!("scenario.initial.soak_temperature_degc={ambient_degc}"),
                    format!("scenario.initial.cabin_temperature_degc={cabin_degc}"),
                    "scenario.initial.state_of_charge_pct=95.0".to_owned(),
                    "scenario.strategy.battery=\"isolate\"".to_owned(),
                    // So that two hours do not empty it; isolated, it has no part in the heating.
                    "vehicle.battery.strings_in_parallel=4".to_owned(),
                ],
            );
            let (mut sums, mut seconds) = ([0.0; 6], 0.0);
            let blower_row = experiment.rules.roles().blower_rows[0];
            drive(&experiment, 7200, |run| {
                if run.steps <= 6600 {
                    return;
                }
                let flows = &run.record.as_ref().expect("a step").flows;
                let level = experiment.demand(&mut run.clone())[blower_row];
                let power_w = flows[Flow::BATTERY] - flows[Flow::TRACTION] - flows[Flow::AUXILIARY];
                let now = [
                    power_w,
                    flows[Flow::COMPRESSOR],
                    run.state.heater_power_w,
                    level,
                    celsius(&experiment, run, 0),
                    celsius(&experiment, run, 2),
                ];
                sums.iter_mut().zip(now).for_each(|(sum, value)| *sum += value);
                seconds += 1.0;
            });
            let [power, compressor, ptc, level, cabin, htc] = sums.map(|sum| sum / seconds);
            println!(
                "| {ambient_degc} | {cabin_degc} | {power:.0} | {compressor:.0} | {ptc:.0} | {level:.2} | {cabin:.2} | {htc:.1} |"
            );
            powers_w.push(power);
        }
        let (low, high) = powers_w.iter().fold((f64::MAX, 0.0_f64), |(l, h), &p| (l.min(p), h.max(p)));
        println!("| {ambient_degc} | apart by | {:.1} % | | | | | |", 100.0 * (high / low - 1.0));
    }
}

/// Cabin and battery in the first 18 minutes of WLTC class 3b, soaked at -15 degC.
fn cold_start(rules: &str) {
    let mut changes = [
        "scenario.cycle=\"wltc-class3b\"",
        "scenario.climate.ambient_temperature_degc=-15.0",
        "scenario.initial.soak_temperature_degc=-15.0",
        "scenario.initial.state_of_charge_pct=90.0",
        "scenario.strategy.battery=\"heat\"",
    ]
    .map(str::to_owned)
    .to_vec();
    println!("| PTC, kW | minutes | cabin, degC | battery | HTC | energy so far, kWh |");
    println!("|---|---|---|---|---|---|");
    for ptc_w in [5377.0, 7000.0] {
        changes.push(format!("vehicle.ptc.maximum_power_w={ptc_w}"));
        let experiment = load(rules, &changes);
        let mut energy_j = 0.0;
        drive(&experiment, 1800, |run| {
            energy_j += run.record.as_ref().expect("a step").flows[Flow::BATTERY];
            if run.steps.is_multiple_of(360) {
                let (minutes, kwh) = (run.steps / 60, energy_j / 3.6e6);
                let [cabin, battery, htc] = [0, 1, 2].map(|node| celsius(&experiment, run, node));
                let kilowatts = ptc_w / 1e3;
                println!("| {kilowatts:.1} | {minutes} | {cabin:.1} | {battery:.1} | {htc:.1} | {kwh:.3} |");
            }
        });
    }
}

/// Energy and discomfort over trips at an ambient temperature.
fn trips(rules: &str, ambient_degc: f64, changes: &[String]) -> (f64, f64) {
    let (mut energy_kwh, mut distance_km, mut discomfort_k_s, mut duration_s) = (0.0, 0.0, 0.0, 0.0);
    for (cycle, battery_degc) in [("hwfet", -50.0), ("artemis-road", -10.0), ("artemis-motorway-130", -5.0)] {
        let battery_degc = f64::max(battery_degc, ambient_degc);
        let mut all = vec![
            format!("scenario.cycle=\"{cycle}\""),
            format!("scenario.climate.ambient_temperature_degc={ambient_degc}"),
            format!("scenario.initial.soak_temperature_degc={ambient_degc}"),
            format!("scenario.initial.battery_temperature_degc={battery_degc}"),
            "scenario.initial.state_of_charge_pct=90.0".to_owned(),
        ];
        all.extend_from_slice(changes);
        let experiment = load(rules, &all);
        let run = drive(&experiment, usize::MAX, |_| ());
        let values = run.summary.values(experiment.plant.layout());
        let of = |name: &str| {
            values.iter().find(|(known, _)| known == name).and_then(|&(_, value)| value).expect("a total")
        };
        energy_kwh += of("energy_kwh");
        distance_km += of("distance_km");
        discomfort_k_s += of("discomfort_k") * of("duration_s");
        duration_s += of("duration_s");
    }
    (100.0 * energy_kwh / distance_km, discomfort_k_s / duration_s)
}

/// With the heat pump at the discomfort of the PTC alone: at lower cabin set points or, where the cabin does not get there in
/// time, with a smaller PTC. Battery isolated, and heated.
fn ptc_alone(rules: &str) {
    println!(
        "| battery | ambient, degC | PTC alone, kWh/100 km | K | with heat pump | K | at equal comfort | excess |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let set_points = [22.0, 21.0, 20.0, 19.0, 18.0, 16.0, 14.0, 12.0, 10.0]
        .map(|degc| format!("controller.cabin_set_point_degc={degc}"));
    let heaters = [5377.0, 5000.0, 4500.0, 4000.0, 3500.0, 3000.0]
        .map(|power_w| format!("vehicle.ptc.maximum_power_w={power_w}"));
    for battery in ["isolate", "heat"] {
        for ambient_degc in [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0] {
            let with = |change: &str| {
                let treated = format!("scenario.strategy.battery=\"{battery}\"");
                trips(rules, ambient_degc, &[treated, change.to_owned()])
            };
            let alone = with("scenario.strategy.heat_pump=false");
            let equal = [&set_points[..], &heaters[..]].into_iter().find_map(|changes| {
                let swept: Vec<_> = changes.iter().map(|change| with(change)).collect();
                let pair = swept.windows(2).find(|pair| pair[0].1 <= alone.1 && alone.1 <= pair[1].1)?;
                let share = (alone.1 - pair[0].1) / (pair[1].1 - pair[0].1).max(1e-9);
                Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
            });
            let (equal, excess) = equal.map_or(("none".to_owned(), "none".to_owned()), |equal| {
                (format!("{equal:.2}"), format!("{:+.1} %", 100.0 * (equal / alone.0 - 1.0)))
            });
            let (energy, discomfort) = with(&set_points[0]);
            println!(
                "| {battery} | {ambient_degc} | {:.2} | {:.2} | {energy:.2} | {discomfort:.2} | {equal} | {excess} |",
                alone.0, alone.1
            );
        }
    }
}

/// Energy and discomfort from -20 to 40 degC.
fn climates(rules: &str) {
    println!("| ambient, degC | kWh/100 km | discomfort, K |\n|---|---|---|");
    for step in -4..=8 {
        let ambient_degc = 5.0 * f64::from(step);
        let (energy, discomfort) = trips(rules, ambient_degc, &[]);
        println!("| {ambient_degc} | {energy:.2} | {discomfort:.2} |");
    }
}
