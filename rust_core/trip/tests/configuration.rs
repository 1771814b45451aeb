//! Configuration: what is built in loads, what is wrong is named.

use hp_plant::config::library::{self, Override};
use hp_plant::flows::Flow;
use hp_trip::controllers::Rules;
use hp_trip::drive_cycle::DriveCycle;
use hp_trip::experiment::Experiment;
use hp_trip::kinds::SCENARIO;
use hp_trip::run::EndReason;
use std::collections::BTreeMap;

fn error_with(assignment: &str) -> String {
    let overrides = [Override::parse(assignment).expect("assignment")];
    Experiment::load("jeffs2019/case1-1", None, &overrides).expect_err("must be refused").to_string()
}

#[test]
fn every_built_in_scenario_loads() {
    let names = library::names(SCENARIO);
    assert!(names.len() >= 9);
    for name in names {
        Experiment::load(name, None, &[]).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn unknown_key_is_named_with_file_and_section() {
    let message = error_with("vehicle.body.mas_kg=1500");
    assert!(
        message.contains("jeffs2019") && message.contains("body") && message.contains("mas_kg"),
        "{message}"
    );
}

#[test]
fn value_out_of_range_is_named_with_what_is_allowed() {
    let message = error_with("vehicle.body.mass_kg=-5");
    assert!(message.contains("jeffs2019") && message.contains("body.mass_kg"), "{message}");
    assert!(message.contains("-5") && message.contains("between 300 and 40000"), "{message}");
    let nan = error_with("vehicle.body.mass_kg=nan");
    assert!(nan.contains("NaN") && nan.contains("body.mass_kg"), "{nan}");
}

#[test]
fn value_of_the_wrong_type_is_named() {
    let message = error_with("vehicle.body.mass_kg=heavy");
    assert!(message.contains("body.mass_kg") && message.contains("heavy"), "{message}");
}

#[test]
fn table_that_does_not_rise_is_named_with_its_position() {
    let message = error_with("vehicle.battery.open_circuit_voltage.voltage_v[3]=3.0");
    assert!(message.contains("battery.open_circuit_voltage.voltage_v[3]"), "{message}");
}

#[test]
fn override_without_a_known_prefix_or_section_is_refused() {
    assert!(error_with("body.mass_kg=1500").contains("vehicle., controller., scenario."));
    assert!(error_with("vehicle.bdy.mass_kg=1500").contains("bdy"));
    assert!(Override::parse("vehicle.body.mass_kg").is_err());
}

#[test]
fn unknown_scenario_lists_the_known_ones() {
    let error = Experiment::load("jeffs2019/case9-9", None, &[]).expect_err("unknown").to_string();
    assert!(error.contains("case9-9") && error.contains("jeffs2019/case1-1"), "{error}");
}

#[test]
fn a_scenario_without_a_soak_temperature_starts_at_its_ambient() {
    let soaked_degc = |scenario: &str, changes: &[&str]| {
        let changes: Vec<Override> =
            changes.iter().map(|change| Override::parse(change).expect("an assignment")).collect();
        let experiment = Experiment::load(scenario, None, &changes).unwrap_or_else(|error| panic!("{error}"));
        experiment.initial.soak_temperature_degc.0
    };
    let cold = "scenario.climate.ambient_temperature_degc=-7";
    assert_eq!(soaked_degc("jeffs2019/case1-1", &[]), 0.0);
    assert_eq!(soaked_degc("jeffs2019/case1-1", &[cold]), -7.0);
    assert_eq!(soaked_degc("jeffs2019/case1-1", &[cold, "scenario.initial.soak_temperature_degc=5"]), 5.0);
    assert_eq!(soaked_degc("ours/cold-start-minus20", &[]), -20.0);
}

#[test]
fn connection_that_a_member_does_not_have_is_refused() {
    let message =
        error_with(r#"scenario.connection_schedule=[{ from_s = 0, member = "motor", connection = "htc" }]"#);
    assert!(message.contains("connection_schedule[0].connection"), "{message}");
}

#[test]
fn schedule_out_of_order_is_refused() {
    let message = error_with(
        r#"scenario.heat_demand.schedule=[{ from_s = 9, member = "cabin", heat_flow_w = 1 }, { from_s = 3, member = "cabin", heat_flow_w = 2 }]"#,
    );
    assert!(message.contains("schedule[1].from_s"), "{message}");
}

#[test]
fn wltc_class_3b_has_its_published_distance_and_length() {
    let cycle = DriveCycle::load("wltc-class3b").expect("built-in cycle");
    assert_eq!(cycle.duration_s(), 1800);
    assert!((cycle.distance_m() - 23_266.28).abs() < 0.01, "{}", cycle.distance_m());
}

#[test]
fn broken_cycle_files_are_refused_with_the_line() {
    for (text, part) in [
        ("time_s,speed_km_h\n0,0\n1,x\n", "line 3"),
        ("time_s,speed_km_h\n0,0\n0,10\n", "line 3"),
        ("time_s,speed_km_h\n0,0\n1,900\n", "900"),
        ("time_s,speed_km_h\n0,0\n", "at least two rows"),
    ] {
        let error = DriveCycle::from_csv("broken.csv", text).expect_err("must be refused").to_string();
        assert!(error.contains("broken.csv") && error.contains(part), "{error}");
    }
}

#[test]
fn another_rule_set_drives_by_its_file_s_name_and_warms_the_cabin() {
    let discomfort_k = |controller: &str| {
        let experiment = Experiment::load("jeffs2019/case1-4", Some(controller), &[]).expect("built in");
        assert_eq!(matches!(*experiment.rules, Rules::Thermostat(_)), controller == "thermostat");
        let (summary, end) = experiment.totals();
        assert_eq!(end, EndReason::Arrived);
        let values: BTreeMap<String, Option<f64>> =
            summary.values(experiment.plant.layout()).into_iter().collect();
        let values = |name: &str| values[name].expect("exists");
        assert!(values("worst_relative_residual") < 1e-9 && values("limit_breaches") == 0.0);
        values("discomfort_k")
    };
    // Unheated, the cabin would stay about 22 K too cold.
    let (thermostat_k, hpcu_k) = (discomfort_k("thermostat"), discomfort_k("hpcu"));
    assert!(thermostat_k != hpcu_k && (thermostat_k - hpcu_k).abs() < 1.0, "{thermostat_k}, {hpcu_k}");
}

#[test]
fn overrides_reach_the_parameters_of_the_chosen_rules_only() {
    let loaded = |key: &str| {
        let change = Override::parse(&format!("controller.{key}=1500")).expect("assignment");
        Experiment::load("jeffs2019/case1-4", Some("thermostat"), &[change])
    };
    assert!(loaded("compressor_power_w").is_ok());
    let error = loaded("htc_set_point_degc").expect_err("the HPCU's").to_string();
    assert!(error.contains("thermostat") && error.contains("htc_set_point_degc"), "{error}");
}

#[test]
fn cycles_out_of_bounds_get_one_clear_error() {
    let told = |rows: &str| {
        let text = format!("time_s,speed_km_h\n{rows}\n");
        DriveCycle::from_csv("mine.csv", &text).expect_err(rows).to_string()
    };
    for (rows, part) in [
        (
            "0,0\n1e10,3",
            "line 3: `time_s` is 10000000000, 10000000000 s after the first row, but must be at most 1000000",
        ),
        ("0,0\ninf,3", "line 3: `time_s` is inf, but must be a finite number"),
        ("0,0\n1e300,3", "line 3: `time_s` is 1"),
        ("0,0\nnan,3", "line 3: `time_s` is NaN, but must be a finite number"),
        ("0,0\n10,inf", "line 3: `speed_km_h` is inf, but must be a finite number"),
        ("0,0\n10,nan", "line 3: `speed_km_h` is NaN, but must be a finite number"),
        ("0,0\n0,3", "line 3: `time_s` is 0 after 0: it stands there twice, but must rise"),
        ("0,0\n0.5,3", "has no full second"),
    ] {
        let message = told(rows);
        assert!(message.starts_with("mine.csv: ") && message.contains(part), "{rows}: {message}");
    }
    let longest = DriveCycle::from_csv("mine.csv", "time_s,speed_km_h\n0,0\n1e6,3\n").expect("allowed");
    assert_eq!(longest.duration_s(), 1_000_000);
}

#[test]
fn a_message_names_the_file_asked_for_and_the_one_that_asked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
        folder.path().join(name).to_str().expect("plain name").to_owned()
    };
    let told = |scenario: &str| Experiment::load(scenario, None, &[]).expect_err("refused").to_string();
    let base = "base = \"jeffs2019/case1-1\"\n";
    for (line, part) in [
        ("cycle = \"none.csv\"", "none.csv: "),
        ("cycle = \"nowhere\"", "unknown drive cycle `nowhere`"),
        ("vehicle = \"mine.toml\"", "mine.toml: "),
        ("controller = \"nobody\"", "unknown controller `nobody`"),
    ] {
        let scenario = write("trip.toml", &format!("{base}{line}\n"));
        let message = told(&scenario);
        assert!(message.contains(part) && message.ends_with(&format!("(named by {scenario})")), "{message}");
    }
    let mine = write("mine.toml", "base = \"jeffs2019\"\nrefrigerant = \"none.csv\"\n");
    let scenario = write("trip.toml", &format!("{base}vehicle = \"mine.toml\"\n"));
    let message = told(&scenario);
    assert!(message.contains("none.csv") && message.ends_with(&format!("(named by {mine})")), "{message}");
    let own = write("own.toml", "base = \"own.toml\"\n");
    let message = told(&own);
    assert!(message.contains("too long or closed") && message.matches("named by").count() == 1, "{message}");
}

#[test]
fn what_a_trip_of_0_km_does_not_have_is_none() {
    let mut experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
    experiment.cycle =
        DriveCycle::from_csv("standing.csv", "time_s,speed_km_h\n0,0\n60,0\n").expect("a cycle");
    let (summary, _) = experiment.totals();
    let values: BTreeMap<String, Option<f64>> =
        summary.values(experiment.plant.layout()).into_iter().collect();
    assert_eq!((values["distance_km"], values["energy_kwh_per_100_km"]), (Some(0.0), None));
    assert!(values["energy_kwh"].is_some_and(|energy_kwh| energy_kwh > 0.0));
}

#[test]
fn the_first_row_shows_the_voltage_of_the_resting_battery() {
    for (charge_pct, cell_v) in [(100.0, 4.18), (50.0, 3.71)] {
        let change = Override::parse(&format!("scenario.initial.state_of_charge_pct={charge_pct}"));
        let change = change.expect("an assignment");
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[change]).expect("built in");
        let rows = experiment.plant.signals.rows();
        let column = rows.iter().position(|signal| signal.name == "battery_voltage_v").expect("a column");
        let mut row = Vec::new();
        experiment.look(&experiment.start(), &mut row);
        assert!((row[column] - 108.0 * cell_v).abs() < 1e-9, "{} V", row[column]);
    }
}

/// 0.008 for each of 32 K: 25.6 % more at -7 than at 25 degC.
#[test]
fn tyres_of_a_cold_trip_roll_harder() {
    let rolling_kwh = |degc: f64, rise: f64| {
        let changes = [
            format!("scenario.climate.ambient_temperature_degc={degc}"),
            format!("vehicle.body.rolling_resistance_rise_per_k={rise}"),
        ];
        let changes = changes.map(|text| Override::parse(&text).expect("an assignment"));
        let experiment = Experiment::load("jeffs2019/case1-1", None, &changes).expect("built in");
        experiment.totals().0.energy_j(Flow::ROLLING) / 3.6e6
    };
    let ratio = rolling_kwh(-7.0, 0.008) / rolling_kwh(25.0, 0.008);
    assert!((ratio - 1.256).abs() < 1e-9, "{ratio}");
    assert_eq!(rolling_kwh(-7.0, 0.0).to_bits(), rolling_kwh(25.0, 0.0).to_bits());
}
