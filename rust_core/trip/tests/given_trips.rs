//! Trips as measured ones are: hills, weather and a driver's settings over time, masses that start warm.

use hp_plant::config::library::Override;
use hp_plant::flows::Flow;
use hp_trip::experiment::Experiment;
use hp_trip::run::{EndReason, Run};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use tempfile::TempDir;

const CASE: &str = "jeffs2019/case1-4";

/// A folder with files.
fn folder(files: &[(&str, String)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

/// A trace of so many seconds with columns as functions of time.
fn trace(seconds: u32, columns: &[(&str, &dyn Fn(f64) -> f64)]) -> String {
    let names: Vec<&str> = columns.iter().map(|&(name, _)| name).collect();
    let mut text = format!("time_s,{}\n", names.join(","));
    for second in 0..=seconds {
        write!(text, "{second}").expect("a string");
        for (_, at) in columns {
            write!(text, ",{}", at(f64::from(second))).expect("a string");
        }
        text.push('\n');
    }
    text
}

fn loaded(folder: &TempDir, lines: &str, overrides: &[&str]) -> Result<Experiment, String> {
    let path = folder.path().join("trip.toml");
    std::fs::write(&path, format!("base = \"{CASE}\"\n{lines}\n")).expect("written");
    let overrides: Vec<_> = overrides.iter().map(|text| Override::parse(text).expect("valid")).collect();
    Experiment::load(path.to_str().expect("plain name"), None, &overrides).map_err(|error| error.to_string())
}

fn experiment(folder: &TempDir, lines: &str) -> Experiment {
    loaded(folder, lines, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Drives to the end; every second must close its ledgers. Returns each second's run.
fn driven(experiment: &Experiment) -> (Vec<Run>, EndReason) {
    let (mut run, mut seconds) = (experiment.start(), Vec::new());
    loop {
        let command = experiment.rule_based_command(&mut run);
        let end = experiment.step(&mut run, &command);
        let record = run.record.expect("a step was made");
        assert!(record.ledger.relative() < 1e-9, "{} s: {:?}", run.steps, record.ledger);
        assert!(record.water_ledger.relative() < 1e-9, "{} s: {:?}", run.steps, record.water_ledger);
        seconds.push(run);
        if let Some(end) = end {
            return (seconds, end);
        }
    }
}

fn totals(experiment: &Experiment) -> BTreeMap<String, f64> {
    let (summary, _) = experiment.totals();
    let values = summary.values(experiment.plant.layout()).into_iter();
    values.map(|(name, value)| (name, value.unwrap_or(f64::NAN))).collect()
}

/// Seen names with their values after a run.
fn seen(experiment: &Experiment, run: &Run, name: &str) -> f64 {
    let mut row = Vec::new();
    experiment.look(run, &mut row);
    let place = experiment.plant.signals.rows().iter().position(|signal| signal.name == name);
    row[place.unwrap_or_else(|| panic!("no `{name}`"))]
}

/// Up for half of the way and down again: the height comes back, what it cost in losses does not.
#[test]
fn a_hill_takes_its_potential_energy_and_gives_it_back() {
    let speed = |time: f64| (3.0 * time).min(20.0).min(3.0 * (200.0 - time)).max(0.0);
    let up = |time: f64| if time < 100.0 { 5.0 } else { -5.0 };
    let folder = folder(&[
        ("level.csv", trace(200, &[("speed_m_s", &speed)])),
        ("hill.csv", trace(200, &[("speed_m_s", &speed), ("grade_pct", &up)])),
        ("up.csv", trace(200, &[("speed_m_s", &speed), ("grade_pct", &|_| 5.0)])),
    ]);
    let level = totals(&experiment(&folder, "cycle = \"level.csv\""));
    let hill = totals(&experiment(&folder, "cycle = \"hill.csv\""));
    let uphill = experiment(&folder, "cycle = \"up.csv\"");
    let (seconds, end) = driven(&uphill);
    assert_eq!(end, EndReason::Arrived);
    let up = totals(&uphill);
    let body = &uphill.plant.vehicle.body;
    let height_m = up["distance_km"] * 1e3 * 0.05 / 1.0025_f64.sqrt();
    assert!((up["climb_energy_kwh"] * 3.6e6 - body.mass_kg * 9.81 * height_m).abs() < 1.0, "{height_m} m");
    assert!(hill["climb_energy_kwh"].abs() < 0.02 * up["climb_energy_kwh"], "{}", hill["climb_energy_kwh"]);
    // Motor, transmission and battery take their share of what goes up.
    assert!(up["energy_kwh"] - level["energy_kwh"] > 1.05 * up["climb_energy_kwh"]);
    assert!(hill["energy_kwh"] > level["energy_kwh"]);
    assert!((seen(&uphill, &seconds[50], "grade_pct") - 5.0).abs() < 1e-9);
}

#[test]
fn a_car_too_weak_for_a_hill_falls_behind_and_has_all_of_it_before_it() {
    let speed = |time: f64| (2.0 * time).min(25.0).min(2.0 * (400.0 - time)).max(0.0);
    let grade = |time: f64| if (100.0..200.0).contains(&time) { 12.0 } else { 0.0 };
    let folder = folder(&[("hill.csv", trace(400, &[("speed_m_s", &speed), ("grade_pct", &grade)]))]);
    let strong = experiment(&folder, "cycle = \"hill.csv\"");
    let weak = loaded(&folder, "cycle = \"hill.csv\"", &["vehicle.motor.maximum_mechanical_power_w=40000.0"]);
    let weak = weak.expect("it loads");
    let (_, end) = driven(&weak);
    assert_eq!(end, EndReason::Arrived);
    let (strong, weak) = (totals(&strong), totals(&weak));
    assert!(weak["furthest_behind_m"] > 200.0, "{}", weak["furthest_behind_m"]);
    assert!((weak["climb_energy_kwh"] / strong["climb_energy_kwh"] - 1.0).abs() < 0.01, "{weak:?}");
}

#[test]
fn a_series_of_the_climate_acts_everywhere_and_starts_the_soak() {
    let ambient = |time: f64| 10.0 - 0.05 * time;
    let columns: &[(&str, &dyn Fn(f64) -> f64)] = &[
        ("ambient_degc", &ambient),
        ("relative_humidity_pct", &|_| 60.0),
        ("solar_w_m2", &|time| if time < 100.0 { 0.0 } else { 500.0 }),
        ("wind_m_s", &|_| 5.0),
        ("occupants", &|time| if time < 100.0 { 1.0 } else { 4.0 }),
        ("measured_cabin_temperature_degc", &|_| 20.0),
    ];
    let folder = folder(&[
        ("way.csv", trace(300, &[("speed_m_s", &|time| if time < 300.0 { 15.0 } else { 0.0 })])),
        ("air.csv", trace(300, columns)),
    ]);
    let trip = experiment(&folder, "cycle = \"way.csv\"\n[climate]\nseries = \"air.csv\"");
    let start = trip.start();
    for node in ["battery_temperature_degc", "cabin_temperature_degc", "ambient_temperature_degc"] {
        assert!((seen(&trip, &start, node) - 10.0).abs() < 1e-9, "{node}");
    }
    let (seconds, end) = driven(&trip);
    assert_eq!(end, EndReason::Arrived);
    let last = seconds.last().expect("driven");
    // The last second began 299 s after the start.
    assert!((seen(&trip, last, "ambient_temperature_degc") - ambient(299.0)).abs() < 1e-9);
    let expected = hp_plant::media::moist_air::humidity_ratio(0.6, 273.15 + ambient(299.0));
    assert!((seen(&trip, last, "ambient_humidity_ratio") - expected).abs() < 1e-12);
    assert_eq!(seen(&trip, last, "headwind_m_s"), 5.0);
    let cabin = &trip.plant.layout().cabins[0];
    let sun_w = |run: &Run| {
        let flows = run.record.expect("driven").flows;
        flows.sum_w(&[cabin.solar_flow, cabin.solar_soft_flow, cabin.solar_hard_flow])
    };
    let aperture_m2 = trip.plant.vehicle.body.solar_aperture_m2;
    assert_eq!(sun_w(&seconds[50]), 0.0);
    assert!((sun_w(last) - 500.0 * aperture_m2).abs() < 1e-9);
    let people_w = |run: &Run| run.record.expect("driven").flows[cabin.occupants_flow];
    assert!((people_w(last) / people_w(&seconds[50]) - 4.0).abs() < 1e-12);
    // Drag of (15 + 5)^2 instead of 15^2, in the same air.
    let calm = loaded(&folder, "cycle = \"way.csv\"", &[]).expect("it loads");
    let drag = |experiment: &Experiment, run: &Run| {
        run.record.expect("driven").flows[Flow::DRAG]
            / experiment.disturbance(run.steps - 1).air.density_kg_m3
    };
    let windless = &driven(&calm).0[200];
    assert!((drag(&trip, &seconds[200]) / drag(&calm, windless) - 16.0 / 9.0).abs() < 1e-9);
}

#[test]
fn what_a_series_lacks_the_constants_of_the_climate_say() {
    let folder = folder(&[
        ("way.csv", trace(60, &[("speed_m_s", &|_| 10.0)])),
        ("sun.csv", trace(90, &[("solar_w_m2", &|_| 400.0)])),
        ("flat.csv", trace(60, &[("ambient_degc", &|_| -5.0), ("relative_humidity_pct", &|_| 70.0)])),
    ]);
    let sunny = "cycle = \"way.csv\"\n[climate]\nseries = \"sun.csv\"\nambient_temperature_degc = 3.0";
    let trip = experiment(&folder, sunny);
    let after = trip.disturbance(30);
    assert_eq!(after.air, trip.climate.air());
    assert_eq!((after.occupants, after.headwind_m_s), (1.0, 0.0));
    // A series that says the same all the time is the same trip to the last bit.
    let series = experiment(&folder, "cycle = \"way.csv\"\n[climate]\nseries = \"flat.csv\"").simulate();
    let constants =
        "cycle = \"way.csv\"\n[climate]\nambient_temperature_degc = -5.0\nrelative_humidity = 0.7";
    let constant = experiment(&folder, constants).simulate();
    assert_eq!(series.values, constant.values);
}

#[test]
fn ram_air_and_outer_surfaces_feel_the_wind() {
    let folder = folder(&[
        ("way.csv", trace(300, &[("speed_m_s", &|_| 10.0)])),
        ("wind.csv", trace(300, &[("wind_m_s", &|_| 15.0)])),
        ("behind.csv", trace(300, &[("wind_m_s", &|_| -10.0)])),
    ]);
    let cabin_degc = |series: &str| {
        let lines = format!(
            "cycle = \"way.csv\"\n{series}\n[initial]\ncabin_temperature_degc = 40.0\n[strategy]\nptc = false\nheat_pump = false"
        );
        let trip = experiment(&folder, &lines);
        seen(&trip, driven(&trip).0.last().expect("driven"), "windscreen_temperature_degc")
    };
    let calm = cabin_degc("");
    assert!(cabin_degc("climate.series = \"wind.csv\"") < calm - 0.1);
    assert!(cabin_degc("climate.series = \"behind.csv\"") > calm + 0.1);
}

#[test]
fn rules_obey_what_a_driver_has_set_while_it_is_given() {
    let folder = folder(&[
        ("way.csv", trace(900, &[("speed_m_s", &|_| 15.0)])),
        (
            "driver.csv",
            trace(
                900,
                &[
                    ("cabin_set_point_degc", &|time| if time < 450.0 { 16.0 } else { 25.0 }),
                    ("blower_level", &|time| if time < 450.0 { 0.4 } else { 0.8 }),
                    ("recirculation", &|time| if time < 450.0 { 0.5 } else { 0.0 }),
                ],
            ),
        ),
    ]);
    for controller in ["hpcu", "hpcu-modern", "thermostat"] {
        let lines = format!(
            "cycle = \"way.csv\"\ncontroller = \"{controller}\"\n[settings]\nseries = \"driver.csv\""
        );
        let trip = experiment(&folder, &lines);
        let (rows, roles) = (&trip.plant.ranges, trip.rules.roles());
        let row = |name: &str| rows.row(name).expect("an actuator");
        let (mut run, mut before) = (trip.start(), 0.0);
        for second in 0..900 {
            let demand = trip.demand(&mut run.clone());
            let (degc, level, share) = if second < 450 { (16.0, 0.4, 0.5) } else { (25.0, 0.8, 0.0) };
            assert_eq!(demand[row("blower_level")], level, "{controller} at {second} s");
            assert_eq!(demand[row("recirculation")], share, "{controller} at {second} s");
            let offset_k = degc + 273.15 - demand[roles.set_point_row.expect("a PTC")];
            let modern = controller == "hpcu-modern";
            assert!((0.0..=if modern { 5.0 } else { 1e-9 }).contains(&(offset_k + 1e-12)), "{offset_k} K");
            let command = trip.rule_based_command(&mut run);
            trip.step(&mut run, &command);
            let cabin_degc = seen(&trip, &run, "cabin_temperature_degc");
            if second == 449 {
                before = cabin_degc;
            }
            if second == 899 {
                assert!((before - 16.0).abs() < 1.5, "{controller}: {before} degC before the change");
                assert!(cabin_degc > before + 3.0, "{controller}: {before}, {cabin_degc} degC");
            }
        }
    }
    // Constants do the same, and a series counts before them.
    let fixed = experiment(&folder, "cycle = \"way.csv\"\n[settings]\nblower_level = 0.3");
    let row = fixed.plant.ranges.row("blower_level").expect("an actuator");
    assert_eq!(fixed.demand(&mut fixed.start())[row], 0.3);
    let both = "cycle = \"way.csv\"\n[settings]\nblower_level = 0.3\nseries = \"driver.csv\"";
    let both = experiment(&folder, both);
    assert_eq!(both.demand(&mut both.start())[row], 0.4);
}

#[test]
fn every_mass_starts_as_told() {
    let folder = folder(&[("way.csv", trace(60, &[("speed_m_s", &|_| 10.0)]))]);
    let whole = experiment(&folder, "cycle = \"way.csv\"\n[initial]\nsoak_temperature_degc = -3.0");
    let start = whole.start();
    let nodes: Vec<String> = whole.plant.layout().nodes.iter().map(|node| node.stem.clone()).collect();
    assert!(nodes.iter().any(|name| name == "soft_furnishings"), "{nodes:?}");
    for name in nodes.iter().map(String::as_str).chain(["windscreen"]) {
        let column = format!("{name}_temperature_degc");
        let line = format!("cycle = \"way.csv\"\n[initial]\nsoak_temperature_degc = -3.0\n{column} = 31.5");
        let trip = experiment(&folder, &line);
        let warm = trip.start();
        assert!((seen(&trip, &warm, &column) - 31.5).abs() < 1e-9, "{name}");
        let others = nodes.iter().filter(|other| *other != name && name != "cabin");
        for other in others.map(|other| format!("{other}_temperature_degc")) {
            assert_eq!(seen(&trip, &warm, &other), seen(&whole, &start, &other), "{name}: {other}");
        }
    }
    let trip = experiment(
        &folder,
        "cycle = \"way.csv\"\n[initial]\nhtc_temperature_degc = 60.0\ncabin_temperature_degc = 20.0\n\
         hard_furnishings_temperature_degc = 15.0",
    );
    let start = trip.start();
    let found = ["htc_supply", "htc_return", "cabin", "exhaust", "soft_furnishings", "hard_furnishings"]
        .map(|name| seen(&trip, &start, &format!("{name}_temperature_degc")).round());
    assert_eq!(found, [60.0, 60.0, 20.0, 20.0, 20.0, 15.0]);
}

#[test]
fn what_is_wrong_with_series_settings_and_masses_is_told_with_file_key_and_rule() {
    let folder = folder(&[
        ("way.csv", trace(60, &[("speed_m_s", &|_| 10.0)])),
        ("short.csv", trace(59, &[("ambient_degc", &|_| 1.0), ("blower_level", &|_| 0.5)])),
        ("gap.csv", "time_s,ambient_degc\n0,1\n1,1\n2,1\n60,1\n".to_owned()),
    ]);
    for (lines, parts) in [
        (
            "[climate]\nseries = \"short.csv\"",
            &["short.csv", "59 s", "lasts 60 s", "as long as its trip"][..],
        ),
        ("[settings]\nseries = \"short.csv\"", &["short.csv", "59 s", "lasts 60 s", "as long as its trip"]),
        ("[climate]\nseries = \"way.csv\"", &["way.csv", "must be one of", "ambient_degc", "wind_m_s"]),
        ("[settings]\nseries = \"way.csv\"", &["way.csv", "must be one of", "cabin_set_point_degc"]),
        ("[climate]\nseries = \"gap.csv\"", &["gap.csv", "line 5", "gap of 58 s"]),
        ("[climate]\nseries = \"none.csv\"", &["none.csv"]),
        ("[climate]\nseries = 3", &["climate.series"]),
        ("[settings]\nblower_level = 70", &["settings.blower_level", "70", "between 0 and 1"]),
        ("[settings]\nblower = 0.5", &["settings", "unknown field", "blower_level"]),
        ("[initial]\nglass_temperature_degc = 3", &["initial", "`glass`", "windscreen"]),
        (
            "[initial]\nmotor_temperature_degc = 300",
            &["motor_temperature_degc", "300", "between -50 and 100"],
        ),
        ("[initial]\nhtc_degc = 30", &["htc_degc", "<mass>_temperature_degc"]),
    ] {
        let message = loaded(&folder, &format!("cycle = \"way.csv\"\n{lines}"), &[]).expect_err(lines);
        assert!(parts.iter().all(|part| message.contains(part)), "{lines}: {message}");
        assert!(message.contains("trip.toml"), "{lines}: {message}");
    }
}

#[test]
fn overrides_reach_series_and_settings() {
    let folder = folder(&[
        ("way.csv", trace(60, &[("speed_m_s", &|_| 10.0)])),
        ("air.csv", trace(60, &[("ambient_degc", &|_| -8.0)])),
    ]);
    let series = format!("scenario.climate.series={}", folder.path().join("air.csv").display());
    let changes = [series.as_str(), "scenario.settings.recirculation=0.4"];
    let trip = loaded(&folder, "cycle = \"way.csv\"", &changes).expect("it loads");
    assert_eq!(trip.climate.ambient_temperature_degc.0, -8.0);
    assert_eq!(trip.scenario.settings.at(5).recirculation, Some(0.4));
}
