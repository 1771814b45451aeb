//! Physically impossible values: one clear error each, with file, key, value and rule.

use hp_plant::config::kinds::{REFRIGERANT, VEHICLE};
use hp_plant::config::library::{self, Kind, Override};
use hp_trip::drive_cycle::DriveCycle;
use hp_trip::experiment::Experiment;
use hp_trip::kinds::{CONTROLLER, SCENARIO};
use toml::{Table, Value};

const CASE: &str = "jeffs2019/case1-1";

fn told(controller: Option<&str>, key: &str, value: &str) -> String {
    let change = Override::parse(&format!("{key}={value}")).expect("an assignment");
    match Experiment::load(CASE, controller, &[change]) {
        Ok(_) => panic!("{key} = {value} was accepted"),
        Err(error) => error.in_one_line(),
    }
}

/// File that is named, key, value, words that must be in the message besides these.
const LIST: [(&str, &str, &str, &[&str]); 33] = [
    ("jeffs2019", "vehicle.body.mass_kg", "-5", &["must be between 300 and 40000"]),
    ("jeffs2019", "vehicle.body.rolling_resistance_coefficient", "-0.01", &["must be between 0.001"]),
    ("jeffs2019", "vehicle.body.drag_area_m2", "0", &["must be between 0.1"]),
    ("jeffs2019", "vehicle.motor.heat_capacity_j_k", "0", &["must be between 1000"]),
    ("jeffs2019", "vehicle.motor.proportional_loss", "1.2", &["must be between 0 and 0.5"]),
    ("jeffs2019", "vehicle.transmission.mesh_loss_share", "1.1", &["must be between 0 and 0.2"]),
    ("jeffs2019", "vehicle.regeneration.maximum_share", "1.01", &["must be between 0 and 1"]),
    ("jeffs2019", "vehicle.refrigeration.compressor.electrical_efficiency", "1.2", &["between 0.3 and 1"]),
    ("jeffs2019", "vehicle.refrigeration.compressor.isentropic_efficiency_peak", "1.2", &["and 0.95"]),
    ("jeffs2019", "vehicle.refrigeration.compressor.minimum_speed_rev_s", "90", &["maximum_speed_rev_s"]),
    ("jeffs2019", "vehicle.refrigeration.compressor.maximum_power_w", "90", &["must be between 100"]),
    (
        "jeffs2019",
        "vehicle.refrigeration.maximum_pressure_bar",
        "42",
        &["at most 35.91", "r134a", "critical point"],
    ),
    ("jeffs2019", "vehicle.refrigeration.minimum_suction_pressure_bar", "0", &["must be between 0.2"]),
    ("jeffs2019", "vehicle.refrigeration.condenser_ua_w_k", "-1", &["must be between 10"]),
    (
        "jeffs2019",
        "vehicle.refrigeration.injection",
        "{ pressure_position = 2.0 }",
        &["pressure_position", "is 2,"],
    ),
    ("jeffs2019", "vehicle.refrigerant", "r744", &["supercritical", "31 degC", "r290"]),
    ("jeffs2019", "vehicle.refrigerant", "r12", &["must be one of", "r134a", ".csv"]),
    ("jeffs2019", "vehicle.cabin.exhaust_recovery_share", "1.2", &["must be between 0 and 0.95"]),
    ("jeffs2019", "vehicle.cabin.minimum_air_flow_kg_s", "0.2", &["must not exceed maximum_air_flow_kg_s"]),
    ("jeffs2019", "vehicle.htc.circuit.branch_shares.cabin", "1.4", &["between 0 and 1"]),
    ("jeffs2019", "vehicle.htc.circuit.branch_shares.cabin", "0.55", &["1.15 in sum", "must add up to 1"]),
    ("jeffs2019", "vehicle.htc.circuit.valve_open", "1.5", &["must be between 0.01 and 1"]),
    (
        "jeffs2019",
        "vehicle.htc.circuit.pump.minimum_flow_kg_s",
        "0.9",
        &["must not exceed maximum_flow_kg_s"],
    ),
    (
        "jeffs2019",
        "vehicle.battery.minimum_cell_voltage_v",
        "3.5",
        &["must not exceed maximum_cell_voltage_v"],
    ),
    (
        "jeffs2019",
        "vehicle.battery.open_circuit_voltage.voltage_v[3]",
        "3.0",
        &["must be larger than the value"],
    ),
    ("jeffs2019", "vehicle.battery.circuit.temperature_degc[2]", "-35.0", &["must be larger than the value"]),
    ("jeffs2019", "vehicle.battery.circuit.series_resistance_ohm[0][1]", "-0.1", &["must be between"]),
    (
        "jeffs2019",
        "vehicle.battery.circuit.series_resistance_ohm",
        "[[1.0]]",
        &["1 rows", "must hold 9 rows"],
    ),
    ("jeffs2019", "vehicle.battery.usable_capacity.share[1]", "1.5", &["must be between 0.05 and 1.2"]),
    (
        "jeffs2019",
        "vehicle.battery.usable_capacity.temperature_degc[1]",
        "-50.0",
        &["must be larger than the value"],
    ),
    (CASE, "scenario.initial.state_of_charge_pct", "120", &["must be between 0 and 100"]),
    (CASE, "scenario.climate.ambient_temperature_degc", "-300", &["must be between -50 and 60"]),
    (CASE, "scenario.climate.occupants", "-1", &["invalid value", "u32"]),
];

#[test]
fn impossible_values_are_told_with_file_key_value_and_rule() {
    for (file, key, value, words) in LIST {
        // Ranges of a pair overlap only with another value of the other.
        let wanted = match key {
            "vehicle.battery.minimum_cell_voltage_v" => {
                Some(Override::parse("vehicle.battery.maximum_cell_voltage_v=3.2").expect("an assignment"))
            }
            "vehicle.refrigeration.compressor.minimum_speed_rev_s" => Some(
                Override::parse("vehicle.refrigeration.compressor.maximum_speed_rev_s=50")
                    .expect("an assignment"),
            ),
            _ => None,
        };
        let change = Override::parse(&format!("{key}={value}")).expect("an assignment");
        let changes: Vec<Override> = wanted.into_iter().chain([change]).collect();
        let message = match Experiment::load(CASE, None, &changes) {
            Ok(_) => panic!("{key} = {value} was accepted"),
            Err(error) => error.to_string(),
        };
        let name = key.split_once('.').expect("of a file").1;
        // What is wrong with a list or with values together is told of their section.
        let section = name.rsplit_once('.').map_or(name, |(section, _)| section);
        let named = message.contains(name) || (message.contains("in sum") && message.contains(section));
        assert!(message.contains(file) && named, "{key}: {message}");
        // Of what is wrong with a whole its sum or size is told, which the words have.
        let whole = message.contains("in sum") || message.contains(" rows") || value.starts_with('{');
        let said = whole || message.contains(value) || message.contains(value.trim_end_matches(".0"));
        assert!(said, "{key} = {value} is not in: {message}");
        assert!(words.iter().all(|word| message.contains(word)), "{key}: {message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

/// Keys of all numbers of a table, elements of lists included.
fn numbers(prefix: &str, value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Table(table) => {
            table.iter().for_each(|(key, inner)| numbers(&format!("{prefix}.{key}"), inner, found))
        }
        Value::Array(list) => {
            // Places of sections in a list cannot be reached by an override.
            for (place, inner) in list.iter().enumerate().take(2).filter(|(_, inner)| !inner.is_table()) {
                numbers(&format!("{prefix}[{place}]"), inner, found);
            }
        }
        Value::Float(_) | Value::Integer(_) => found.push(prefix.to_owned()),
        _ => {}
    }
}

fn numbers_of(word: &str, kind: Kind, name: &str) -> Vec<String> {
    let table: Table = library::table(kind, name, &[]).expect("built in");
    let mut found = Vec::new();
    numbers(word, &Value::Table(table), &mut found);
    found
}

/// Whoever adds a number without a range hears of it here.
#[test]
fn no_number_of_any_built_in_file_may_be_anything() {
    let mut files = vec![("vehicle", VEHICLE, "jeffs2019", None), ("scenario", SCENARIO, CASE, None)];
    for name in library::names(CONTROLLER) {
        files.push(("controller", CONTROLLER, name, Some(name)));
    }
    for (word, kind, name, controller) in files {
        let keys = numbers_of(word, kind, name);
        assert!(keys.len() > 3, "{word} {name}: {keys:?}");
        for key in keys {
            let plain = key.split_once('.').expect("of a file").1;
            for value in ["nan", "1e30", "-1e30"] {
                let message = told(controller, &key, value);
                assert!(message.contains(name) && message.contains(plain), "{key} = {value}: {message}");
                let rule = ["must ", "expected"].iter().any(|word| message.contains(word));
                assert!(rule, "{key} = {value}: {message}");
            }
        }
    }
}

#[test]
fn impossible_tables_are_told_with_file_line_and_rule() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
        folder.path().join(name).to_str().expect("plain name").to_owned()
    };
    let table = library::text(REFRIGERANT, "r290").expect("built in");
    let second = |change: fn(&mut Vec<&str>)| {
        let mut lines: Vec<String> = table.lines().map(str::to_owned).collect();
        let row = lines.iter().position(|line| line.starts_with("214")).expect("the second row");
        let text = lines[row].clone();
        let mut fields: Vec<&str> = text.split(',').collect();
        change(&mut fields);
        lines[row] = fields.join(",");
        lines.join("\n")
    };
    let mine = write("mine.toml", "base = \"jeffs2019\"\nrefrigerant = \"mine.csv\"\n");
    for (text, words) in [
        (second(|row| row[13] = "1.0"), ["`pressure_pa` is 1", "must rise with temperature_k"]),
        (second(|row| row[13] = "x"), ["line 19", "finite numbers"]),
        (second(|row| row[0] = "213.2"), ["temperature_k must rise", "equal steps"]),
        (
            table.replace("#: critical_temperature_degc = 96.74", "#: critical_temperature_degc = 31.1"),
            ["31.1", "supercritical"],
        ),
        (table.replace("bar = 30.0", "bar = 43.0"), ["`maximum_pressure_bar` is 43", "must be between"]),
    ] {
        write("mine.csv", &text);
        let change = Override::parse(&format!("scenario.vehicle=\"{mine}\"")).expect("an assignment");
        let message = Experiment::load(CASE, None, &[change]).expect_err("refused").to_string();
        assert!(message.contains("mine.csv") && message.contains("mine.toml"), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    for (rows, words) in [
        ("0,0\n1,-3", ["line 3", "`speed_km_h` is -3, but must be between"]),
        ("0,0\n0,3", ["line 3", "rise"]),
    ] {
        let text = format!("time_s,speed_km_h\n{rows}\n");
        let message = DriveCycle::from_csv("mine.csv", &text).expect_err("refused").to_string();
        assert!(
            message.starts_with("mine.csv") && words.iter().all(|word| message.contains(word)),
            "{message}"
        );
    }
}
