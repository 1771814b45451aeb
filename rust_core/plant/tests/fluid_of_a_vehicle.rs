//! A vehicle that names another refrigerant has the limits of that fluid, unless it gives its own.

use hp_plant::config::kinds::REFRIGERANT;
use hp_plant::config::library::{self, Override};
use hp_plant::config::vehicle::VehicleParameters;
use hp_plant::media::refrigerant::RefrigerantTable;
use hp_plant::plant::Plant;
use tempfile::TempDir;

/// Highest and lowest pressure [bar], highest discharge temperature [degC].
fn limits(vehicle: &str, overrides: &[&str]) -> [f64; 3] {
    let overrides: Vec<Override> =
        overrides.iter().map(|change| Override::parse(change).expect("an assignment")).collect();
    let vehicle = VehicleParameters::load(vehicle, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let refrigeration = vehicle.refrigeration.expect("it has a heat pump");
    [
        refrigeration.maximum_pressure_bar,
        refrigeration.minimum_suction_pressure_bar,
        refrigeration.compressor.maximum_discharge_temperature_degc,
    ]
}

fn of_fluid(name: &str) -> [f64; 3] {
    let limits = RefrigerantTable::limits_of(name).expect("built in").expect("it has them");
    [
        limits.maximum_pressure_bar,
        limits.minimum_suction_pressure_bar,
        limits.maximum_discharge_temperature_degc,
    ]
}

fn car(folder: &TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("plain name").to_owned()
}

#[test]
fn a_car_with_another_fluid_has_that_fluid_s_limits_and_drives() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for fluid in ["r1234yf", "R290", "r152a"] {
        let mine = car(&folder, "mine.toml", &format!("base = \"jeffs2019\"\nrefrigerant = \"{fluid}\"\n"));
        assert_eq!(limits(&mine, &[]), of_fluid(fluid));
        assert_eq!(limits("jeffs2019", &[&format!("refrigerant=\"{fluid}\"")]), of_fluid(fluid));
        Plant::load(&mine, &[]).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn what_the_file_itself_or_an_override_gives_counts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = "base = \"jeffs2019\"\nrefrigerant = \"r290\"\n[refrigeration]\nmaximum_pressure_bar = 22.0\n";
    let mine = car(&folder, "mine.toml", text);
    let [_, lowest, hottest] = of_fluid("r290");
    assert_eq!(limits(&mine, &[]), [22.0, lowest, hottest]);
    let second = car(&folder, "second.toml", "base = \"mine.toml\"\n[body]\nmass_kg = 2000.0\n");
    assert_eq!(limits(&second, &[]), [22.0, lowest, hottest]);
    let changes = ["refrigeration.compressor.maximum_discharge_temperature_degc=111", "refrigerant=r290"];
    assert_eq!(limits("jeffs2019", &changes)[2], 111.0);
}

#[test]
fn the_paper_s_car_keeps_its_own_limits() {
    let own = limits("jeffs2019", &[]);
    assert_eq!(own[0], 30.0);
    assert_eq!(limits("jeffs2019", &["refrigerant=\"R134a\""]), own, "the same fluid in other letters");
    assert_eq!(limits("jeffs2019-direct", &[]), own);
}

#[test]
fn a_table_of_one_s_own_brings_its_limits_or_the_car_must_give_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let table = library::text(REFRIGERANT, "r152a").expect("built in").replace("bar = 30.0", "bar = 26.5");
    car(&folder, "own.csv", &table);
    let mine = car(&folder, "mine.toml", "base = \"jeffs2019\"\nrefrigerant = \"own.csv\"\n");
    assert_eq!(limits(&mine, &[])[0], 26.5);
    let bare: String =
        table.lines().filter(|line| !line.starts_with("#:")).flat_map(|line| [line, "\n"]).collect();
    car(&folder, "own.csv", &bare);
    let message = VehicleParameters::load(&mine, &[]).expect_err("no limits").to_string();
    for part in ["mine.toml", "refrigeration.maximum_pressure_bar", "missing", "own.csv", "make_table.py"] {
        assert!(message.contains(part), "{message}");
    }
    let given = [
        "refrigeration.maximum_pressure_bar=25",
        "refrigeration.minimum_suction_pressure_bar=1",
        "refrigeration.compressor.maximum_discharge_temperature_degc=120",
    ];
    assert_eq!(limits(&mine, &given), [25.0, 1.0, 120.0]);
}

#[test]
fn a_fluid_that_cannot_condense_or_is_not_known_is_refused_by_the_car_s_file() {
    for (fluid, part) in
        [("r744", "supercritical"), ("CO2", "critical point"), ("r12", "r1234yf, r134a, r152a, r290")]
    {
        let change = Override::parse(&format!("refrigerant={fluid}")).expect("an assignment");
        let message = VehicleParameters::load("jeffs2019", &[change]).expect_err("refused").to_string();
        assert!(
            message.starts_with(&format!("jeffs2019: `refrigerant` is `{fluid}`, but must be")),
            "{message}"
        );
        assert!(message.contains(part), "{message}");
    }
    let change = Override::parse("refrigeration.maximum_pressure_bar=42").expect("an assignment");
    let message = Plant::load("jeffs2019", &[change]).expect_err("supercritical").to_string();
    for part in [
        "jeffs2019",
        "refrigeration.maximum_pressure_bar",
        "42",
        "at most 35.91",
        "critical point is at 40.593",
    ] {
        assert!(message.contains(part), "{message}");
    }
}
