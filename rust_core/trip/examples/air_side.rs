//! Prints what the air side comes to: cool-down of a parked cabin, cooling from 50 degC, blower power, recirculation by humidity.
//!
//! `cargo run --release -p hp_trip --example air_side [-- vehicle override ...]`

use hp_plant::command::Demand;
use hp_plant::config::Celsius;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::Override;
use hp_plant::media::air;
use hp_plant::plant::{Disturbance, Plant};
use hp_trip::experiment::Experiment;
use std::io::Write as _;

fn parsed(changes: &[String]) -> Vec<Override> {
    changes.iter().map(|text| Override::parse(text).expect("an assignment")).collect()
}

/// Cabin air after 5 and 30 min at -10 degC, from 20, everything off: time constants of the first 5 min and of the rest [s].
fn cool_down(more: &[String]) {
    let own: Vec<String> =
        more.iter().filter_map(|text| text.strip_prefix("vehicle.")).map(str::to_owned).collect();
    let plant = Plant::load("jeffs2019", &parsed(&own)).expect("a vehicle");
    let still = Disturbance {
        start_speed_m_s: 0.0,
        end_speed_m_s: 0.0,
        air: air::at_temperature(Celsius(-10.0).kelvin()),
        ambient_humidity_ratio: 0.0,
        solar_gain_w: 0.0,
        occupants: 0.0,
        grade: 0.0,
        headwind_m_s: 0.0,
    };
    let mut initial = InitialParameters::soaked(Celsius(-10.0), 80.0);
    initial.set("cabin", Some(Celsius(20.0)));
    let mut state = plant.parked(&initial);
    let mut demand: Demand = plant.ranges.idle();
    demand[plant.layout().cabins[0].blower_row] = 0.0;
    demand[plant.layout().cabins[0].recirculation_row] = plant.vehicle.cabin().maximum_recirculation;
    let command = plant.ranges.encode(&demand);
    let above_k = |state: &hp_plant::state::State| {
        state.temperatures_k[plant.layout().cabins[0].air.index()] - Celsius(-10.0).kelvin()
    };
    let mut after_k = Vec::new();
    for second in 1..=1800 {
        plant.step(&mut state, &command, &still);
        if second == 300 || second == 1800 {
            after_k.push(above_k(&state));
        }
    }
    let constants = [300.0 / (30.0 / after_k[0]).ln(), 1500.0 / (after_k[0] / after_k[1]).ln()];
    println!(
        "cool-down, off: {:.1} and {:.1} degC after 5 and 30 min, time constants {:.0} and {:.0} s",
        after_k[0] - 10.0,
        after_k[1] - 10.0,
        constants[0],
        constants[1]
    );
}

fn constant_speed(speed_km_h: f64, seconds: u32) -> tempfile::NamedTempFile {
    let mut file = tempfile::Builder::new().suffix(".csv").tempfile().expect("a temporary file");
    writeln!(file, "time_s,speed_km_h\n0,{speed_km_h}\n{seconds},{speed_km_h}").expect("written");
    file
}

/// 35 degC, 40 % humidity, 400 W of sun, 40 km/h, from 50 degC, battery isolated: minutes to 25 degC.
fn cooling(rules: &str, more: &[String]) {
    let cycle = constant_speed(40.0, 3600);
    let mut changes = vec![
        format!("scenario.cycle=\"{}\"", cycle.path().display()),
        "scenario.strategy.battery=\"isolate\"".to_owned(),
        "scenario.climate.relative_humidity=0.4".to_owned(),
        "scenario.climate.solar_gain_w=400.0".to_owned(),
    ];
    changes.extend(more.iter().cloned());
    let experiment =
        Experiment::load("ours/hot-soak-plus35", Some(rules), &parsed(&changes)).expect("built in");
    let mut run = experiment.start();
    let (mut reached_s, mut latent_j, mut water_kg) = (None, 0.0, 0.0);
    loop {
        let command = experiment.rule_based_command(&mut run);
        let end = experiment.step(&mut run, &command);
        let record = run.record.as_ref().expect("a step");
        let cabin = experiment.plant.layout().cabins[0];
        latent_j += cabin.latent_flow.map_or(0.0, |flow| record.flows[flow]);
        water_kg += record.water[0].core_kg_s;
        let cabin_degc = run.state.temperatures_k[cabin.air.index()] - 273.15;
        if cabin_degc <= 25.0 && reached_s.is_none() {
            reached_s = Some(run.steps);
            println!(
                "cooling, {rules}: 25 degC after {:.1} min, {:.2} kg of water, latent {:.2} kWh",
                run.steps as f64 / 60.0,
                water_kg,
                latent_j / 3.6e6
            );
        }
        if end.is_some() {
            println!("cooling, {rules}: {cabin_degc:.1} degC after {} min", run.steps / 60);
            return;
        }
    }
}

/// `ours/commute-minus5` and its like with moist air: energy, comfort, fog, carbon dioxide.
fn recirculation(rules: &str, ambient_degc: f64, occupants: u32, more: &[String]) {
    let mut changes = vec![
        format!("scenario.climate.ambient_temperature_degc={ambient_degc}"),
        format!("scenario.initial.soak_temperature_degc={ambient_degc}"),
        "scenario.climate.relative_humidity=0.85".to_owned(),
        format!("scenario.climate.occupants={occupants}"),
        "scenario.strategy.battery=\"isolate\"".to_owned(),
    ];
    changes.extend(more.iter().cloned());
    let experiment =
        Experiment::load("ours/commute-minus5", Some(rules), &parsed(&changes)).expect("built in");
    let mut run = experiment.start();
    let row = experiment.plant.layout().cabins[0].recirculation_row;
    let mut mean = 0.0;
    loop {
        let demand = experiment.demand(&mut run);
        mean += demand[row];
        if experiment.step(&mut run, &experiment.plant.ranges.encode(&demand)).is_some() {
            break;
        }
    }
    let values = run.summary.values(experiment.plant.layout());
    let of = |name: &str| {
        values.iter().find(|(key, _)| key == name).and_then(|(_, value)| *value).unwrap_or(f64::NAN)
    };
    println!(
        "{rules} at {ambient_degc} degC, {occupants} people: {:.2} kWh/100 km, {:.2} K, recirculation {:.2}, fog {:.0} s, CO2 to {:.0} ppm",
        of("energy_kwh_per_100_km"),
        of("discomfort_k"),
        mean / run.steps as f64,
        of("fog_s"),
        of("highest_co2_ppm")
    );
}

fn main() {
    let more: Vec<String> = std::env::args().skip(1).collect();
    cool_down(&more);
    let plant = Plant::load("jeffs2019", &[]).expect("built in");
    for level in [0.0, 0.5, 1.0] {
        let air = plant.vehicle.cabin().ventilation(level, 0.0, 1.0);
        println!(
            "blower level {level}: {:.4} kg/s, {:.1} W",
            air.supply_rate_w_k / 1006.0,
            air.blower_power_w
        );
    }
    for rules in ["hpcu", "hpcu-modern"] {
        cooling(rules, &more);
    }
    for ambient_degc in [-10.0, 0.0, 10.0] {
        for occupants in [1, 4] {
            for rules in ["hpcu", "hpcu-modern"] {
                recirculation(rules, ambient_degc, occupants, &more);
            }
            let closed = [
                "controller.options.recirculation_fog_band_k=0.0",
                "controller.options.recirculation_co2_band_ppm=0.0",
            ];
            let closed: Vec<String> =
                closed.iter().map(|text| (*text).to_owned()).chain(more.iter().cloned()).collect();
            print!("always 0.7: ");
            recirculation("hpcu-modern", ambient_degc, occupants, &closed);
        }
    }
}
