//! Cars in a folder of their own: an architecture and a vehicle file whose sections are those of the default's like parts.

use hp_plant::architecture::declaration::{Declaration, MemberKind};
use hp_plant::config::kinds::{ARCHITECTURE, VEHICLE};
use hp_plant::config::library;
use hp_plant::error::PlantResult;
use hp_plant::plant::Plant;
use tempfile::TempDir;
use toml::{Table, Value};

/// Text of a built-in architecture.
pub fn architecture(name: &str) -> String {
    library::text(ARCHITECTURE, name).expect("built in")
}

/// Writes an architecture and a vehicle into a folder and loads it.
pub fn load(architecture: &str, vehicle: &str) -> PlantResult<Plant> {
    let folder = folder(architecture, vehicle);
    Plant::load(folder.path().join("car.toml").to_str().expect("plain name"), &[])
}

/// A folder with an architecture and a vehicle.
pub fn folder(architecture: &str, vehicle: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("arch.toml"), architecture).expect("written");
    std::fs::write(folder.path().join("car.toml"), vehicle).expect("written");
    folder
}

/// The default's section of a name.
fn like(section: &str) -> Table {
    let mut table = library::table(VEHICLE, "jeffs2019", &[]).expect("built in");
    match table.remove(section) {
        Some(Value::Table(section)) => section,
        other => panic!("{section}: {other:?}"),
    }
}

/// A vehicle for an architecture: each part has the numbers of the default's part of its kind.
pub fn vehicle(declaration: &Declaration) -> Table {
    let mut car = Table::new();
    car.insert("base".into(), "jeffs2019".into());
    car.insert("architecture".into(), "arch.toml".into());
    for circuit in &declaration.loops {
        car.insert(circuit.name.clone(), Value::Table(loop_section(declaration, &circuit.name)));
    }
    for member in &declaration.members {
        let section = match member.kind {
            MemberKind::Battery | MemberKind::Motor | MemberKind::Transmission => continue,
            MemberKind::Store => like("thermal_battery"),
            MemberKind::FrontEnd => {
                let mut section = like("ambient_exchanger");
                if declaration.air_streams.iter().any(|stream| stream.through.contains(&member.name)) {
                    section.remove("air");
                }
                section
            }
            MemberKind::Plate => Table::from_iter([("ua_w_k".to_owned(), Value::Float(600.0))]),
            MemberKind::Cabin => {
                let mut cabin = like("cabin");
                let cabins =
                    declaration.members.iter().filter(|member| member.kind == MemberKind::Cabin).count();
                if cabins > 1 && !member.comfort {
                    cabin.insert("solar_share".into(), Value::Float(0.3));
                    cabin.insert("occupant_share".into(), Value::Float(0.5));
                }
                cabin
            }
        };
        car.insert(member.section().to_owned(), Value::Table(section));
    }
    for heater in &declaration.heaters {
        car.insert(heater.name.clone(), Value::Table(like("ptc")));
    }
    for stream in &declaration.air_streams {
        let air = like("ambient_exchanger").remove("air").expect("the default has one");
        car.insert(stream.name.clone(), air);
    }
    let mut refrigeration = Table::new();
    for exchanger in &declaration.exchangers {
        let on_air_at = exchanger.air.as_ref().and_then(|name| declaration.member(name));
        let front_end =
            on_air_at.is_some_and(|member| declaration.members[member].kind == MemberKind::FrontEnd);
        if !front_end {
            let ua_w_k = if exchanger.circuit.is_some() { 800.0 } else { 180.0 };
            refrigeration.insert(format!("{}_ua_w_k", exchanger.name), Value::Float(ua_w_k));
        }
    }
    if !refrigeration.is_empty() {
        car.insert("refrigeration".into(), Value::Table(refrigeration));
    }
    car
}

fn loop_section(declaration: &Declaration, name: &str) -> Table {
    let mut section = like("htc");
    section.insert("minimum_supply_degc".into(), Value::Float(-10.0));
    let parallel = declaration.branches.iter().filter(|branch| branch.circuit == name && !branch.series);
    let members: Vec<&String> = parallel.map(|branch| &branch.member).collect();
    let mut shares =
        Table::from_iter([("closed_branches".to_owned(), Value::String("redistribute-in-cooling".into()))]);
    let share = 1.0 / members.len().max(1) as f64;
    shares.extend(members.into_iter().map(|member| (member.clone(), Value::Float(share))));
    if let Some(Value::Table(circuit)) = section.get_mut("circuit") {
        circuit.insert("branch_shares".into(), Value::Table(shares));
    }
    section
}

/// A plant of an architecture, its vehicle's sections changed.
pub fn plant(architecture: &str, change: impl FnOnce(&mut Table)) -> PlantResult<Plant> {
    let declaration: Declaration = toml::from_str(architecture).expect("TOML of an architecture");
    let mut car = vehicle(&declaration);
    change(&mut car);
    load(architecture, &toml::to_string(&car).expect("a table"))
}
