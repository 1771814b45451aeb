//! Files that name files: a path inside a file counts from its folder, any other path from the working folder.

use hp_plant::config::kinds::REFRIGERANT;
use hp_plant::config::library::{self, Override};
use hp_plant::media::refrigerant::RefrigerantTable;
use hp_trip::experiment::Experiment;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const CYCLE: &str = "time_s,speed_km_h\n0,0\n60,40\n120,0\n";

/// A folder with a vehicle, its refrigerant, a cycle, a controller and a scenario that names them.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    };
    write("my-table.csv", &library::text(REFRIGERANT, "r1234yf").expect("built in"));
    let car = "base = \"jeffs2019\"\nrefrigerant = \"my-table.csv\"\n[body]\nmass_kg = 1234.0\n";
    write("my-car.toml", car);
    write("trips/round-the-block.csv", CYCLE);
    write("rules/mine.toml", "base = \"hpcu\"\nblower_level = 0.5\n");
    write("mine.toml", "base = \"trips/base.toml\"\nvehicle = \"my-car.toml\"\n");
    write(
        "trips/base.toml",
        "base = \"jeffs2019/case1-1\"\ncycle = \"round-the-block.csv\"\ncontroller = \"../rules/mine.toml\"\n",
    );
    folder
}

fn table(experiment: &Experiment) -> &RefrigerantTable {
    experiment.plant.refrigeration.as_ref().expect("it has a heat pump").table()
}

fn check(experiment: &Experiment) {
    let pressure_pa =
        |name: &str| RefrigerantTable::load(name).expect("built in").saturation_pressure_pa(280.0);
    assert_eq!(experiment.plant.vehicle.body.mass_kg, 1234.0);
    assert_eq!(table(experiment).saturation_pressure_pa(280.0), pressure_pa("R1234yf"));
    assert_eq!(experiment.cycle.duration_s(), 120);
    assert_eq!(experiment.rules.constant_settings().blower_level, 0.5);
}

/// The same file as seen from the working folder.
fn relative(path: &Path) -> PathBuf {
    let here = std::env::current_dir().expect("a working folder");
    let up: PathBuf = here.components().skip(1).map(|_| "..").collect();
    up.join(path.components().skip(1).collect::<PathBuf>())
}

#[test]
fn a_scenario_finds_the_files_beside_it_and_beside_its_base_from_any_working_folder() {
    let folder = folder();
    let path = folder.path().join("mine.toml");
    for path in [relative(&path), path] {
        let name = path.to_str().expect("plain name");
        check(&Experiment::load(name, None, &[]).unwrap_or_else(|error| panic!("{error}")));
    }
}

#[test]
fn paths_of_overrides_count_from_the_working_folder_and_absolute_ones_stay() {
    let folder = folder();
    let scenario = folder.path().join("mine.toml");
    let load = |vehicle: &Path| {
        let change = Override::parse(&format!("scenario.vehicle={}", vehicle.display())).expect("assignment");
        Experiment::load(scenario.to_str().expect("plain name"), None, &[change])
    };
    let car = folder.path().join("my-car.toml");
    check(&load(&relative(&car)).expect("from the working folder"));
    check(&load(&car).expect("absolute"));
    let error = load(Path::new("my-car.toml")).expect_err("not in the working folder").to_string();
    assert!(error.contains("my-car.toml"), "{error}");
    // A name that is no path stays a name.
    assert_eq!(table(&load(Path::new("jeffs2019")).expect("built in")).name(), "r134a");
}

#[test]
fn a_file_that_is_not_beside_the_one_that_names_it_is_named_with_its_place() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("my-table.csv")).expect("removed");
    let scenario = folder.path().join("mine.toml");
    let error = Experiment::load(scenario.to_str().expect("plain name"), None, &[]).expect_err("gone");
    let place = folder.path().join("my-table.csv");
    assert!(error.to_string().contains(place.to_str().expect("plain name")), "{error}");
}
