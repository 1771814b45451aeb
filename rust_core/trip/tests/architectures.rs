//! Architectures as files: any that makes sense runs and conserves energy, any other is refused with what is wrong.

#[path = "support/mod.rs"]
mod support;

use hp_plant::plant::Plant;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use support::{cars, physics, random_scenarios};

const RANDOM_ARCHITECTURES: usize = if cfg!(debug_assertions) { 150 } else { 2000 };

/// Parts of an architecture, drawn without care for what makes sense; most are then given what they lack.
#[derive(Debug, Clone)]
struct Parts {
    hot: Vec<bool>,
    stores: usize,
    front_ends: usize,
    plate_from: Option<usize>,
    rear: bool,
    recovery: Option<usize>,
    /// Place among loops, cabins and front-end exchangers; condensing; valve; name.
    exchangers: Vec<(usize, bool, bool, &'static str)>,
    heaters: Vec<usize>,
    /// Member, loop, in series, against the loop's side.
    branches: Vec<(usize, usize, bool, bool)>,
    shared_air: bool,
}

fn parts() -> impl Strategy<Value = Parts> {
    let names = prop_oneof![
        9 => Just(""),
        1 => prop::sample::select(vec!["condenser", "evaporator", "battery_request", "cabin_l0", "compressor"]),
    ];
    let exchanger = (0_usize..7, any::<bool>(), any::<bool>(), names);
    let branch = (0_usize..9, 0_usize..3, prop::bool::weighted(0.5), prop::bool::weighted(0.2));
    (
        (prop::collection::vec(any::<bool>(), 0..4), 0_usize..3, 0_usize..3),
        (
            prop::option::weighted(0.3, 0_usize..3),
            prop::bool::weighted(0.3),
            prop::option::weighted(0.3, 0_usize..3),
        ),
        (prop::collection::vec(exchanger, 0..5), prop::collection::vec(0_usize..8, 0..3)),
        (prop::collection::vec(branch, 0..14), prop::bool::weighted(0.4)),
    )
        .prop_map(
            |(
                (hot, stores, front_ends),
                (plate_from, rear, recovery),
                (exchangers, heaters),
                (branches, shared_air),
            )| {
                Parts {
                    hot,
                    stores,
                    front_ends,
                    plate_from,
                    rear,
                    recovery,
                    exchangers,
                    heaters,
                    branches,
                    shared_air,
                }
            },
        )
        .prop_flat_map(|parts| (Just(parts), prop::bool::weighted(0.8)))
        .prop_map(|(parts, completed)| if completed { parts.completed() } else { parts })
}

impl Parts {
    /// With branches wherever something would be without, each once, and exchangers on both levels or none.
    fn completed(mut self) -> Self {
        let loops = self.hot.len();
        self.plate_from = self.plate_from.filter(|from| *from < loops && loops > 1);
        self.recovery = self.recovery.filter(|circuit| self.hot.get(*circuit) == Some(&false));
        if loops == 0 {
            (self.stores, self.front_ends) = (0, 0);
        }
        let members = self.members();
        for (member, (_, kind)) in members.iter().enumerate() {
            if ["store", "front-end", "plate"].contains(kind) {
                let other = self.plate_from.map_or(0, |from| usize::from(from == 0));
                self.branches.push((member, other, false, false));
            }
        }
        self.branches.extend((0..loops).map(|circuit| (0, circuit, false, false)));
        let mut kept: Vec<(usize, usize, bool, bool)> = Vec::new();
        for &(member, circuit, series, against) in &self.branches {
            let Some((_, kind)) = members.get(member).filter(|_| circuit < loops) else { continue };
            let series = series && ["battery", "motor", "transmission", "store"].contains(kind);
            let again = kept.iter().any(|other| (other.0, other.1) == (member, circuit));
            let itself = *kind == "plate" && self.plate_from == Some(circuit);
            let out = |circuit: usize, against: bool| self.hot[circuit] != against;
            let core = *kind == "cabin"
                && kept
                    .iter()
                    .any(|other| other.0 == member && out(other.1, other.3) == out(circuit, against));
            if !(again || itself || core) {
                kept.push((member, circuit, series, against));
            }
        }
        self.branches = kept;
        let mut taken: Vec<(usize, bool)> = Vec::new();
        self.exchangers.retain_mut(|(target, condensing, _, _)| {
            if let Some(hot) = self.hot.get(*target) {
                *condensing = *hot;
            } else {
                // Air of the cabin that counts for comfort, which is the last.
                *target = loops
                    + members.iter().filter(|(_, kind)| ["cabin", "front-end"].contains(kind)).count()
                    - 1;
            }
            let new = !taken.contains(&(*target, *condensing));
            taken.push((*target, *condensing));
            new
        });
        let levels = [true, false].map(|hot| self.exchangers.iter().any(|exchanger| exchanger.1 == hot));
        if levels[0] != levels[1] {
            self.exchangers.clear();
        }
        self
    }

    fn members(&self) -> Vec<(String, &'static str)> {
        let mut members: Vec<(String, &'static str)> =
            ["battery", "motor", "transmission"].map(|name| (name.to_owned(), name)).to_vec();
        members.extend((0..self.stores).map(|place| (format!("s{place}"), "store")));
        members.extend((0..self.front_ends).map(|place| (format!("f{place}"), "front-end")));
        members.extend(self.plate_from.map(|_| ("plate".to_owned(), "plate")));
        members.extend(self.rear.then(|| ("rear".to_owned(), "cabin")));
        members.push(("cabin".to_owned(), "cabin"));
        members
    }

    /// The file; what names something that is not there is mostly left out.
    fn text(&self) -> String {
        let mut text = "description = \"drawn\"\n".to_owned();
        let members = self.members();
        for (place, hot) in self.hot.iter().enumerate() {
            let side = if *hot { "hot" } else { "cold" };
            let _ = writeln!(text, "[[loop]]\nname = \"l{place}\"\nside = \"{side}\"");
        }
        let airs: Vec<&String> = members
            .iter()
            .filter(|(_, kind)| ["cabin", "front-end"].contains(kind))
            .map(|(name, _)| name)
            .collect();
        for (place, (target, condensing, valve, name)) in self.exchangers.iter().enumerate() {
            let name = if name.is_empty() { format!("e{place}") } else { (*name).to_owned() };
            let (other, condensing) = match target.checked_sub(self.hot.len()) {
                None => (format!("loop = \"l{target}\""), self.hot[*target]),
                Some(air) => (format!("air = \"{}\"", airs[air % airs.len()]), *condensing),
            };
            let level = if condensing { "condensing" } else { "evaporating" };
            let _ = writeln!(
                text,
                "[[exchanger]]\nname = \"{name}\"\nlevel = \"{level}\"\n{other}\nvalve = {valve}"
            );
        }
        for (place, target) in self.heaters.iter().enumerate() {
            let heats = match target.checked_sub(self.hot.len()) {
                None => format!("l{target}"),
                Some(member) => members[member % members.len()].0.clone(),
            };
            let _ = writeln!(text, "[[heater]]\nname = \"h{place}\"\nheats = \"{heats}\"");
        }
        for (name, kind) in &members {
            let _ = writeln!(text, "[[member]]\nname = \"{name}\"\nkind = \"{kind}\"");
            match (*kind, self.plate_from, self.recovery) {
                ("plate", Some(from), _) => text += &format!("from = \"l{from}\"\n"),
                ("cabin", _, Some(circuit)) if name == "cabin" => {
                    text += &format!("exhaust_recovery = \"l{circuit}\"\n")
                }
                _ => {}
            }
            if self.rear && name == "cabin" {
                text.push_str("comfort = true\n");
            }
        }
        for (member, circuit, series, against) in &self.branches {
            let (Some((name, _)), Some(hot)) = (members.get(*member), self.hot.get(*circuit)) else {
                continue;
            };
            let _ =
                writeln!(text, "[[branch]]\nmember = \"{name}\"\nloop = \"l{circuit}\"\nseries = {series}");
            if *against {
                let direction = if *hot { "into-loop" } else { "out-of-loop" };
                let _ = writeln!(text, "direction = \"{direction}\"");
            }
        }
        if self.shared_air && self.front_ends == 2 {
            text.push_str("[[air_stream]]\nname = \"front\"\nthrough = [\"f0\", \"f1\"]\n");
        }
        text
    }
}

/// Loads a drawn architecture and drives it; nothing if it is refused, for a reason that names its file and a key.
fn drive(text: &str, seed: usize) -> Option<Plant> {
    let plant = match cars::plant(text, |_| {}) {
        Ok(plant) => plant,
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains(".toml: `"), "{message}\n{text}");
            return None;
        }
    };
    let layout = plant.layout();
    let unique = |names: Vec<&str>| names.iter().collect::<BTreeSet<_>>().len() == names.len();
    assert!(unique(layout.actuators.iter().map(|row| row.name.as_str()).collect()), "{text}");
    assert!(unique(plant.signals.rows().iter().map(|row| row.name.as_str()).collect()), "{text}");
    let scenarios = random_scenarios(&plant, 1 + (seed % 5) as u32);
    scenarios.last()?.drive(&plant, |_, step| physics::check(step));
    Some(plant)
}

#[test]
fn any_architecture_is_refused_with_a_reason_or_runs_and_conserves_energy() {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let texts: Vec<String> = (0..RANDOM_ARCHITECTURES)
        .map(|_| parts().new_tree(&mut runner).expect("strategy without filters").current().text())
        .collect();
    let plants: Vec<Plant> = texts
        .par_iter()
        .enumerate()
        .filter_map(|(seed, text)| {
            std::panic::catch_unwind(|| drive(text, seed)).unwrap_or_else(|_| panic!("with\n{text}"))
        })
        .collect();
    let count = |fits: fn(&Plant) -> bool| plants.iter().filter(|plant| fits(plant)).count();
    let series = count(|plant| plant.layout().series_weights() > 0);
    let (pumped, rear) =
        (count(|plant| plant.layout().refrigerates()), count(|plant| plant.layout().cabins.len() > 1));
    let all = texts.len();
    println!(
        "{} of {all} run: {pumped} with a heat pump, {rear} with two cabins, {series} with a series of several",
        plants.len()
    );
    assert!(plants.len() > all / 4 && plants.len() < all, "{} of {all}", plants.len());
    assert!(pumped > all / 20 && rear > all / 20 && series > all / 40);
}

/// What loading an architecture with a vehicle says.
fn refusal(architecture: &str, vehicle: &str) -> String {
    cars::load(architecture, vehicle).expect_err("must be refused").to_string()
}

const CAR: &str = "base = \"jeffs2019\"\narchitecture = \"arch.toml\"\n";

fn replaced(name: &str, from: &str, to: &str) -> String {
    let text = cars::architecture(name);
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_flawed_architecture_is_refused_with_file_key_value_and_what_is_allowed() {
    let default = |from: &str, to: &str| replaced("jeffs2019", from, to);
    let added = |more: &str| cars::architecture("jeffs2019") + more;
    let cases: Vec<(String, &[&str])> = vec![
        // A member that is not there.
        (
            default("[[branch]]\nmember = \"motor\"", "[[branch]]\nmember = \"moter\""),
            &["`branch[3].member` is `moter`", "nearest: motor"],
        ),
        (default("heats = \"htc\"", "heats = \"htk\""), &["`heater[0].heats` is `htk`", "htc, chiller"]),
        // A branch to no loop.
        (
            default("member = \"cabin\"\nloop = \"chiller\"", "member = \"cabin\"\nloop = \"chiler\""),
            &["`branch[7].loop` is `chiler`", "htc, chiller", "nearest: chiller"],
        ),
        // Masses and exchangers without any link.
        (
            added("\n[[member]]\nname = \"buffer\"\nkind = \"store\"\n"),
            &["`member[6]` is `buffer` without any link", "must have a branch"],
        ),
        (added("\n[[member]]\nname = \"roof\"\nkind = \"front-end\"\n"), &["`roof` without any link"]),
        (
            added("\n[[member]]\nname = \"plate\"\nkind = \"plate\"\nfrom = \"htc\"\n"),
            &["`plate` without any link"],
        ),
        (added("\n[[loop]]\nname = \"spare\"\nside = \"hot\"\n"), &["`loop[2]` is `spare` without a branch"]),
        // A loop with itself.
        (
            added("\n[[member]]\nname = \"plate\"\nkind = \"plate\"\nfrom = \"htc\"\n[[branch]]\nmember = \"plate\"\nloop = \"htc\"\n"),
            &["`branch[10].loop` is `htc`", "connect a loop with itself"],
        ),
        (added("\n[[member]]\nname = \"plate\"\nkind = \"plate\"\n"), &["`member[6].from` is missing"]),
        // A second evaporating pressure.
        (
            added("\n[[exchanger]]\nname = \"deep\"\nlevel = \"evaporating-low\"\nair = \"ambient\"\n"),
            &["exchanger[2].level", "evaporating-low", "a second evaporating pressure is not modelled"],
        ),
        (
            added("\n[[exchanger]]\nname = \"deep\"\nlevel = \"evaporating\"\nair = \"ambeint\"\n"),
            &["`exchanger[2].air` is `ambeint`", "ambient, cabin"],
        ),
        (
            added("\n[[exchanger]]\nname = \"deep\"\nlevel = \"evaporating\"\nloop = \"htc\"\n"),
            &["`exchanger[2].loop` is `htc`", "a cold one for an evaporator"],
        ),
        (
            default("level = \"evaporating\"\nloop = \"chiller\"", "level = \"condensing\"\nair = \"cabin\""),
            &["exchanger.level", "2 condensing, 0 evaporating"],
        ),
        // Names that something else has.
        (
            added("\n[[exchanger]]\nname = \"deep\"\nlevel = \"evaporating\"\nair = \"ambient\"\n"),
            &["`exchanger[1].name` is `evaporator`", "total"],
        ),
        (default("name = \"ptc\"", "name = \"htc_flow\""), &["actuator", "`htc_flow` twice"]),
        (default("name = \"ptc\"", "name = \"controls\""), &["`heater[0].name` is `controls`"]),
        (default("name = \"ptc\"", "name = \"PTC 1\""), &["`heater[0].name` is `PTC 1`", "a-z"]),
        (default("name = \"ptc\"", "name = \"cabin\""), &["`cabin`", "one thing only"]),
        (default("section = \"ambient_exchanger\"", "section = \"cabin\""), &["`member[3].section` is `cabin`"]),
        // Kinds.
        (default("kind = \"motor\"", "kind = \"store\""), &["kind `motor`", "0 times"]),
        (default("kind = \"motor\"", "kind = \"engine\""), &["member[1].kind", "engine", "front-end"]),
        (
            added("\n[[member]]\nname = \"rear\"\nkind = \"cabin\"\n[[branch]]\nmember = \"rear\"\nloop = \"htc\"\n"),
            &["member.comfort", "counts for comfort"],
        ),
        // Too many.
        (
            (0..3).fold(cars::architecture("jeffs2019"), |text, i| {
                text + &format!("\n[[loop]]\nname = \"x{i}\"\nside = \"cold\"\n[[branch]]\nmember = \"battery\"\nloop = \"x{i}\"\n")
            }),
            &["of 5 loops", "at most 4"],
        ),
        (
            (0..3).fold(cars::architecture("three-loops"), |text, i| {
                text + &format!(
                    "\n[[member]]\nname = \"x{i}\"\nkind = \"store\"\n[[branch]]\nmember = \"x{i}\"\nloop = \"htc\"\n\
                     [[branch]]\nmember = \"x{i}\"\nloop = \"chiller\"\n"
                )
            }),
            &["of 18 branches", "at most 16"],
        ),
        (default("side = \"hot\"", "side = \"warm\""), &["loop[0].side", "warm", "hot"]),
        (default("heats = \"htc\"", "heat = \"htc\""), &["heater[0]", "heat"]),
    ];
    for (text, parts) in &cases {
        let message = refusal(text, CAR);
        assert!(message.contains("arch.toml"), "{message}");
        for part in *parts {
            assert!(message.contains(part), "`{part}` is not in: {message}");
        }
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_vehicle_that_does_not_fit_its_architecture_is_refused_with_file_key_and_what_is_allowed() {
    let default = cars::architecture("jeffs2019");
    let bare = cars::architecture("no-thermal-battery");
    let shares = "[chiller.circuit.branch_shares]\nmotor = 0.2\ntransmission = 0.2\nbattery = 0.2\nambient = 0.3\ncabin = 0.1\n";
    let cases: Vec<(String, String, &[&str])> = vec![
        // A section for what is not there, nor known at all.
        (
            bare.clone(),
            format!("{CAR}{shares}[thermal_battery]\nheat_capacity_j_k = 1e5\n"),
            &["`thermal_battery`", "no such part"],
        ),
        (
            default.clone(),
            format!("{CAR}[thermal_batery]\nheat_capacity_j_k = 1e5\n"),
            &["`thermal_batery`", "nearest: thermal_battery"],
        ),
        // Values that are missing, or whose part is not there.
        (
            cars::architecture("three-loops"),
            format!("{CAR}{shares}").replace("battery =", "battery_plate =") + "thermal_battery = 0.0\n",
            &["`battery_loop` is missing"],
        ),
        (
            replaced("jeffs2019", "name = \"condenser\"", "name = \"warm_side\""),
            CAR.to_owned(),
            &["`refrigeration.warm_side_ua_w_k` is missing"],
        ),
        (
            replaced("jeffs2019", "name = \"ptc\"", "name = \"heater\""),
            format!("{CAR}[heater]\nmaximum_power_w = 5000.0\n"),
            &["heater", "cutoff_degc"],
        ),
        (
            bare,
            format!("{CAR}{shares}thermal_battery = 0.0\n"),
            &["chiller.circuit.branch_shares", "thermal_battery"],
        ),
        (default.clone(), format!("{CAR}[cabin]\nsolar_share = 0.2\n"), &["cabin", "solar_share"]),
        (
            default.clone(),
            format!("{CAR}[refrigeration]\ndeep_ua_w_k = 100.0\n"),
            &["refrigeration", "deep_ua_w_k"],
        ),
        // Names of architectures.
        (
            default.clone(),
            "base = \"jeffs2019\"\narchitecture = \"three-lops\"\n".to_owned(),
            &["`architecture` is `three-lops`", "nearest: three-loops"],
        ),
        (default.clone(), "base = \"jeffs2019\"\narchitecture = \"gone.toml\"\n".to_owned(), &["gone.toml"]),
        (default, "base = \"jeffs2019\"\narchitecture = 3\n".to_owned(), &["architecture", "3"]),
    ];
    for (architecture, vehicle, parts) in &cases {
        let message = refusal(architecture, vehicle);
        assert!(message.contains(".toml: `") || message.contains("gone.toml: "), "{message}");
        for part in *parts {
            assert!(message.contains(part), "`{part}` is not in: {message}");
        }
    }
}

/// Air stands where it belongs: in the section of the stream, or in that of an exchanger that shares it with no other.
#[test]
fn air_of_the_front_end_at_the_wrong_place_is_refused() {
    let shared = cars::plant(&cars::architecture("three-loops"), |car| {
        let air = car["front_end"].clone();
        car["radiator"].as_table_mut().expect("a section").insert("air".into(), air);
    });
    let message = shared.expect_err("must be refused").to_string();
    assert!(message.contains("`radiator.air`") && message.contains("`front_end`"), "{message}");
    for (key, value, parts) in [
        ("ram_air_share", 1.5, ["ambient_exchanger.air.ram_air_share", "1.5"]),
        ("blades", 7.0, ["ambient_exchanger.air", "blades"]),
    ] {
        let own = cars::plant(&cars::architecture("jeffs2019"), |car| {
            let air = car["ambient_exchanger"]["air"].as_table_mut().expect("a section");
            air.insert(key.into(), toml::Value::Float(value));
        });
        let message = own.expect_err("must be refused").to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
    let none = cars::plant(&cars::architecture("jeffs2019"), |car| {
        car["ambient_exchanger"]["air"] = toml::Value::Float(1.0);
    });
    assert!(none.expect_err("no section").to_string().contains("ambient_exchanger.air"));
}

/// The path of an architecture counts from its vehicle's file, and is as good as its name.
#[test]
fn the_default_s_architecture_by_path_is_the_same_vehicle() {
    let by_path = cars::load(&cars::architecture("jeffs2019"), CAR).expect("loads");
    let by_name = Plant::load("jeffs2019", &[]).expect("built in");
    assert_eq!(by_path.layout(), by_name.layout());
    assert_eq!(by_path.vehicle.loops, by_name.vehicle.loops);
    assert!(by_path.network.is_compiled(), "the same shape was compiled");
}
