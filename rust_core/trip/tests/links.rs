//! Kinds of links that the default vehicle does not have, each against a calculation of its own.

#[path = "support/mod.rs"]
mod support;

use hp_plant::command::Command;
use hp_plant::components::heat_exchanger::{counterflow_conductance_w_k, inlet_conductance_w_k};
use hp_plant::components::liquid_plate::LiquidPlateParameters;
use hp_plant::config::Celsius;
use hp_plant::config::initial::InitialParameters;
use hp_plant::flows::Flow;
use hp_plant::media::air;
use hp_plant::plant::{Disturbance, Plant, StepRecord};
use hp_plant::signals::View;
use hp_plant::state::State;
use support::{cars, physics};
use toml::{Table, Value};

const VALVE_OPEN: f64 = 0.99;

fn weather(ambient_degc: f64, speed_m_s: f64) -> Disturbance {
    Disturbance {
        start_speed_m_s: speed_m_s,
        end_speed_m_s: speed_m_s,
        air: air::at_temperature(Celsius(ambient_degc).kelvin()),
        ambient_humidity_ratio: 0.0,
        solar_gain_w: 0.0,
        occupants: 1.0,
        grade: 0.0,
        headwind_m_s: 0.0,
    }
}

fn parked(plant: &Plant, soak_degc: f64, members: &[(&str, f64)]) -> State {
    let mut initial = InitialParameters::soaked(Celsius(soak_degc), 70.0);
    for (member, degc) in members {
        initial.set(member, Some(Celsius(*degc)));
    }
    plant.parked(&initial)
}

/// Everything off but some connections and levels.
fn command(plant: &Plant, options: &[(&str, &str)], levels: &[(&str, f64)]) -> Command {
    let mut command = plant.ranges.encode(&plant.ranges.idle());
    for (name, option) in options {
        plant.ranges.choose(&mut command, name, option).unwrap_or_else(|error| panic!("{error}"));
    }
    for (name, value) in levels {
        plant.ranges.set(&mut command, name, *value).unwrap_or_else(|error| panic!("{error}"));
    }
    command
}

/// A second that begins at `state`, which becomes its end; its physics checked.
fn second(plant: &Plant, state: &mut State, command: &Command, disturbance: &Disturbance) -> StepRecord {
    let before = *state;
    let record = plant.step(state, command, disturbance);
    physics::check(&support::Step {
        plant,
        before: &before,
        after: state,
        command,
        disturbance,
        record: &record,
    });
    record
}

fn column(plant: &Plant, record: &StepRecord, column: &str) -> f64 {
    let row = plant.layout().flows.iter().find(|row| row.column == column);
    record.flows[row.unwrap_or_else(|| panic!("no {column}")).flow]
}

fn node_k(plant: &Plant, state: &State, stem: &str) -> f64 {
    let node = plant.layout().nodes.iter().position(|row| row.stem == stem);
    state.temperatures_k[node.unwrap_or_else(|| panic!("no {stem}"))]
}

fn rate_w_k(plant: &Plant, state: &State, circuit: &str) -> f64 {
    let place = plant.layout().circuit(circuit).expect("a loop");
    state.pumps[place].flow_kg_s * plant.vehicle.loops[place].circuit.coolant_specific_heat_j_kg_k
}

fn close(what: &str, value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs().max(1.0), "{what}: {value}, {expected}");
}

/// The default's architecture with stores in series behind its condenser, in an order.
fn with_stores(order: &[&str]) -> String {
    let mut text = cars::architecture("no-thermal-battery");
    for name in ["first", "second"] {
        text += &format!("\n[[member]]\nname = \"{name}\"\nkind = \"store\"\n");
    }
    for name in order {
        text += &format!(
            "\n[[branch]]\nmember = \"{name}\"\nloop = \"htc\"\nseries = true\ndirection = \"into-loop\"\n"
        );
    }
    text
}

/// Flows of two stores in series, hot and less hot, and what they should be by the temperatures at the end of the step.
fn series(order: [&str; 2], compressor_w: f64) -> [f64; 2] {
    let plant = cars::plant(&with_stores(&order), |_| {}).expect("a sound architecture");
    let mut state = parked(&plant, -5.0, &[("first", 85.0), ("second", 60.0)]);
    let connections =
        [("first", "htc"), ("second", "htc"), ("cabin", "htc"), ("motor", "chiller"), ("ambient", "chiller")];
    let levels = [("compressor_power", compressor_w), ("htc_flow", 0.2), ("chiller_flow", 0.2)];
    let command = command(&plant, &connections, &levels);
    let mut flows_w = [0.0; 2];
    for time_s in 0..60 {
        let record = second(&plant, &mut state, &command, &weather(-5.0, 10.0));
        flows_w = order.map(|name| column(&plant, &record, &format!("{name}_htc_heat_flow_w")));
        // Their switches are open all the way after a while.
        if time_s < 40 {
            continue;
        }
        assert_eq!(record.refrigeration.running(), compressor_w > 0.0);
        let rate_w_k = rate_w_k(&plant, &state, "htc");
        let conductance_w_k =
            inlet_conductance_w_k(VALVE_OPEN * rate_w_k, plant.vehicle.stores[0].coolant_ua_w_k);
        let mut coolant_k = node_k(&plant, &state, "htc_return") + record.flows[Flow::CONDENSER] / rate_w_k;
        for (name, flow_w) in order.iter().zip(flows_w) {
            let expected_w = conductance_w_k * (node_k(&plant, &state, name) - coolant_k);
            close(&format!("{order:?} {name} at {time_s} s"), flow_w, expected_w, 1e-7);
            coolant_k += expected_w / rate_w_k;
        }
    }
    flows_w
}

#[test]
fn stores_in_series_meet_the_coolant_as_the_one_before_left_it() {
    for compressor_w in [0.0, 1500.0] {
        let [hot_first, cool_second] = series(["first", "second"], compressor_w);
        let [cool_first, hot_second] = series(["second", "first"], compressor_w);
        // The order matters: behind the hot one the other meets warmer coolant.
        assert!(cool_second < cool_first - 100.0, "{cool_second} {cool_first}");
        assert!(hot_second < hot_first - 100.0, "{hot_second} {hot_first}");
    }
}

/// Series in two loops, the later loop's first in the file.
#[test]
fn series_of_two_loops_do_not_mix_up_their_weights() {
    let mut text = cars::architecture("no-thermal-battery");
    for name in ["a", "b", "c", "d"] {
        text += &format!("\n[[member]]\nname = \"{name}\"\nkind = \"store\"\n");
    }
    for (name, circuit) in [("a", "chiller"), ("b", "chiller"), ("c", "htc"), ("d", "htc")] {
        text += &format!(
            "\n[[branch]]\nmember = \"{name}\"\nloop = \"{circuit}\"\nseries = true\ndirection = \"into-loop\"\n"
        );
    }
    let plant = cars::plant(&text, |_| {}).expect("a sound architecture");
    let mut state = parked(&plant, 0.0, &[("a", 80.0), ("b", 60.0), ("c", 85.0), ("d", 50.0)]);
    let connections = [("a", "chiller"), ("b", "chiller"), ("c", "htc"), ("d", "htc")];
    let command = command(&plant, &connections, &[("htc_flow", 0.3), ("chiller_flow", 0.1)]);
    for time_s in 0..60 {
        let record = second(&plant, &mut state, &command, &weather(0.0, 0.0));
        if time_s < 40 {
            continue;
        }
        for (circuit, stores) in [("chiller", ["a", "b"]), ("htc", ["c", "d"])] {
            let rate_w_k = rate_w_k(&plant, &state, circuit);
            let conductance_w_k =
                inlet_conductance_w_k(VALVE_OPEN * rate_w_k, plant.vehicle.stores[0].coolant_ua_w_k);
            let mut coolant_k = node_k(&plant, &state, &format!("{circuit}_return"));
            for name in stores {
                let flow_w = column(&plant, &record, &format!("{name}_{circuit}_heat_flow_w"));
                let expected_w = conductance_w_k * (node_k(&plant, &state, name) - coolant_k);
                close(&format!("{name} at {time_s} s"), flow_w, expected_w, 1e-7);
                coolant_k += expected_w / rate_w_k;
            }
        }
    }
}

/// Counterflow: the heat is `UA` times the logarithmic mean of the differences at both ends.
fn logarithmic_mean_k(hot_k: (f64, f64), cold_k: (f64, f64)) -> f64 {
    let (one_k, other_k) = (hot_k.0 - cold_k.1, hot_k.1 - cold_k.0);
    if (one_k - other_k).abs() < 1e-6 { one_k } else { (one_k - other_k) / (one_k / other_k).ln() }
}

#[test]
fn a_plate_passes_what_the_logarithmic_mean_says() {
    let plate = LiquidPlateParameters { ua_w_k: 600.0 };
    for (first_w_k, second_w_k) in
        [(100.0, 900.0), (900.0, 100.0), (500.0, 500.0), (1300.0, 1200.0), (200.0, 1400.0)]
    {
        let heat_w = plate.conductance_w_k(first_w_k, second_w_k) * 30.0;
        let hot_k = (310.0, 310.0 - heat_w / first_w_k);
        let cold_k = (280.0, 280.0 + heat_w / second_w_k);
        close("plate", plate.ua_w_k * logarithmic_mean_k(hot_k, cold_k), heat_w, 1e-6);
    }
}

#[test]
fn the_plate_between_two_loops_passes_that_heat_from_return_to_supply() {
    let plant = Plant::load("jeffs2019-three-loops", &[]).expect("built in");
    let mut state = parked(&plant, 30.0, &[("battery", 45.0)]);
    let connections =
        [("battery", "battery_loop"), ("battery_plate", "chiller"), ("cabin", "htc"), ("ambient", "htc")];
    let levels =
        [("compressor_power", 2000.0), ("chiller_flow", 0.3), ("battery_loop_flow", 0.2), ("htc_flow", 0.3)];
    let command = command(&plant, &connections, &levels);
    let mut at_work = 0;
    for time_s in 0..200 {
        let record = second(&plant, &mut state, &command, &weather(30.0, 10.0));
        let heat_w = column(&plant, &record, "battery_plate_chiller_heat_flow_w");
        if time_s < 100 || heat_w == 0.0 {
            continue;
        }
        at_work += 1;
        let share = plant.vehicle.loops[1].circuit.branch_shares.of("battery_plate");
        let cold_w_k = VALVE_OPEN * share * rate_w_k(&plant, &state, "chiller");
        let hot_w_k = rate_w_k(&plant, &state, "battery_loop");
        let (hot_k, cold_k) =
            (node_k(&plant, &state, "battery_loop_return"), node_k(&plant, &state, "chiller_supply"));
        let mean_k =
            logarithmic_mean_k((hot_k, hot_k - heat_w / hot_w_k), (cold_k, cold_k + heat_w / cold_w_k));
        close("plate", heat_w, 600.0 * mean_k, 1e-5);
    }
    assert!(at_work > 50, "{at_work}");
}

#[test]
fn the_second_exchanger_of_an_air_stream_gets_what_the_first_left() {
    let plant = Plant::load("jeffs2019-three-loops", &[]).expect("built in");
    let heat_w = |radiates: bool| {
        let mut state = parked(&plant, 5.0, &[("battery", 50.0)]);
        let mut connections = vec![("battery", "battery_loop"), ("ambient", "chiller"), ("cabin", "htc")];
        if radiates {
            connections.push(("radiator", "battery_loop"));
        }
        let levels = [("compressor_power", 1500.0), ("chiller_flow", 0.3), ("battery_loop_flow", 0.4)];
        let command = command(&plant, &connections, &levels);
        // Too fast for the fan: ram air of 0.25 m2 at 18 % of the speed.
        let (mut last_w, mut heat_w, speed_m_s) = (0.0, 0.0, 16.0_f64);
        let flow_kg_s =
            air::at_temperature(Celsius(5.0).kelvin()).density_kg_m3 * 0.25 * (0.18 * speed_m_s).hypot(0.1);
        let air_w_k = 1006.0 * flow_kg_s;
        for time_s in 0..200 {
            let record = second(&plant, &mut state, &command, &weather(5.0, speed_m_s));
            heat_w = column(&plant, &record, "ambient_chiller_heat_flow_w");
            let share = plant.vehicle.loops[1].circuit.branch_shares.of("ambient");
            let ua_w_k = plant.vehicle.front_ends[0].ua_w_k * flow_kg_s.powf(0.6);
            let coolant_w_k = VALVE_OPEN * share * rate_w_k(&plant, &state, "chiller");
            let air_k = Celsius(5.0).kelvin() + last_w / air_w_k;
            let expected_w = counterflow_conductance_w_k(coolant_w_k, air_w_k, ua_w_k)
                * (air_k - node_k(&plant, &state, "chiller_supply"));
            assert_eq!(record.flows[Flow::FAN], 0.0);
            if time_s > 150 {
                close("front-end exchanger", heat_w, expected_w, 1e-7);
            }
            last_w = column(&plant, &record, "radiator_battery_loop_heat_flow_w");
            assert!(time_s < 20 || (last_w > 100.0) == radiates, "{last_w} W from the radiator");
        }
        heat_w
    };
    let (warmed_w, plain_w) = (heat_w(true), heat_w(false));
    assert!(warmed_w > plain_w + 20.0, "{warmed_w} {plain_w}");
}

#[test]
fn a_heater_on_a_mass_stops_at_its_cut_off() {
    let text = cars::architecture("jeffs2019") + "\n[[heater]]\nname = \"mat\"\nheats = \"battery\"\n";
    let plant = cars::plant(&text, |car| {
        let mat = car.get_mut("mat").and_then(Value::as_table_mut).expect("a section");
        mat.insert("cutoff_degc".into(), Value::Float(20.0));
    });
    let plant = plant.expect("a sound architecture");
    let capacity_j_k = plant.vehicle.battery.heat_capacity_j_k();
    let mut state = parked(&plant, -5.0, &[("battery", 19.97)]);
    let command = command(&plant, &[("mat", "allowed")], &[]);
    let (mut limited, mut full, mut off) = (0, 0, 0);
    for _ in 0..30 {
        let before_k = node_k(&plant, &state, "battery");
        let record = second(&plant, &mut state, &command, &weather(-5.0, 0.0));
        let power_w = column(&plant, &record, "mat_power_w");
        let to_cutoff_w = ((Celsius(20.0).kelvin() - before_k) * capacity_j_k).max(0.0);
        let largest_w = plant.vehicle.heaters[1].maximum_power_w;
        close("mat", power_w, largest_w.min(to_cutoff_w), 1e-9);
        let gained_w = (node_k(&plant, &state, "battery") - before_k) * capacity_j_k;
        let lost_w = column(&plant, &record, "battery_ambient_heat_flow_w");
        close("battery", gained_w, power_w + record.flows[Flow::BATTERY_LOSS] - lost_w, 1e-6);
        full += u32::from(power_w == largest_w);
        limited += u32::from(power_w > 0.0 && power_w < largest_w);
        off += u32::from(power_w == 0.0);
        // Warmer than the cut-off: nothing.
        if full > 0 && limited > 3 {
            state.temperatures_k[plant.layout().battery.index()] = Celsius(20.5).kelvin();
        }
    }
    assert!(full > 0 && limited > 0 && off > 0, "{full} {limited} {off}");
}

fn condensers(names: &[&str]) -> String {
    let mut text = "description = \"condensers at the front end\"\n".to_owned();
    for name in names {
        text += &format!("[[exchanger]]\nname = \"at_{name}\"\nlevel = \"condensing\"\nair = \"{name}\"\n");
        text += &format!("[[member]]\nname = \"{name}\"\nkind = \"front-end\"\n");
    }
    text += "[[exchanger]]\nname = \"at_cabin\"\nlevel = \"evaporating\"\nair = \"cabin\"\n";
    for kind in ["battery", "motor", "transmission", "cabin"] {
        text += &format!("[[member]]\nname = \"{kind}\"\nkind = \"{kind}\"\n");
    }
    text
}

#[test]
fn two_condensers_at_the_same_air_are_one_with_twice_the_conductance() {
    let conductance = |factor: f64| {
        move |car: &mut Table| {
            for (_, section) in car.iter_mut() {
                let Some(section) =
                    section.as_table_mut().filter(|table| table.contains_key("frost_interlock_degc"))
                else {
                    continue;
                };
                // Twice the core has twice the air; its conductance goes with that to the power of 0.6.
                section.insert("ua_w_k".into(), Value::Float(450.0 * f64::powf(factor, 0.4)));
                let air = section.get_mut("air").and_then(Value::as_table_mut).expect("not shared");
                for (key, value) in
                    [("core_area_m2", 0.15), ("fan_air_flow_m3_s", 0.4), ("fan_power_w", 100.0)]
                {
                    air.insert(key.into(), Value::Float(value * factor));
                }
                air.insert("fan_approach_k".into(), Value::Float(20.0 / factor));
            }
        }
    };
    let two = cars::plant(&condensers(&["left", "right"]), conductance(1.0)).expect("a sound architecture");
    let one = cars::plant(&condensers(&["front"]), conductance(2.0)).expect("a sound architecture");
    let mut states = [parked(&two, 35.0, &[]), parked(&one, 35.0, &[])];
    let mut ran = 0;
    for _ in 0..300 {
        let [of_two, of_one] = &mut states;
        let weather = weather(35.0, 8.0);
        let two_record = second(&two, of_two, &command(&two, &[], &[("compressor_power", 1500.0)]), &weather);
        let one_record = second(&one, of_one, &command(&one, &[], &[("compressor_power", 1500.0)]), &weather);
        let (a, b) = (&two_record.refrigeration, &one_record.refrigeration);
        assert_eq!(a.status, b.status);
        close("power", a.electric_power_w, b.electric_power_w, 1e-9);
        close("condensing", a.condensing_temperature_k, b.condensing_temperature_k, 1e-9);
        close("heat", a.condenser_heat_flow_w, b.condenser_heat_flow_w, 1e-9);
        let halves =
            ["left", "right"].map(|name| column(&two, &two_record, &format!("at_{name}_heat_flow_w")));
        close("half", halves[0], halves[1], 1e-12);
        close("both", halves[0] + halves[1], column(&one, &one_record, "at_front_heat_flow_w"), 1e-9);
        ran += u32::from(a.running());
    }
    assert!(ran > 100, "{ran}");
}

/// Several exchangers on both levels: each passes `G_i (T - T_i)`; `physics::check` works that out again for every second.
#[test]
fn a_condenser_that_would_run_backwards_closes_and_the_other_goes_on() {
    let plant = Plant::load("jeffs2019-cabin-condenser", &[]).expect("built in");
    // Coolant far hotter than what the cabin's condenser works at.
    let mut state = parked(&plant, 0.0, &[]);
    let htc = &plant.layout().loops[0];
    for node in [htc.supply, htc.back] {
        state.temperatures_k[node.index()] = Celsius(75.0).kelvin();
    }
    let connections = [("motor", "chiller"), ("ambient", "chiller"), ("cabin_condenser", "open")];
    let command = command(&plant, &connections, &[("compressor_power", 800.0), ("chiller_flow", 0.3)]);
    let (mut alone, mut ran) = (0, 0);
    for _ in 0..120 {
        let record = second(&plant, &mut state, &command, &weather(0.0, 10.0));
        let heats_w = ["htc_condenser", "cabin_condenser"]
            .map(|name| column(&plant, &record, &format!("{name}_heat_flow_w")));
        ran += u32::from(record.refrigeration.running());
        alone += u32::from(heats_w[0] == 0.0 && heats_w[1] > 0.0);
        assert!(heats_w[0] >= 0.0);
    }
    assert!(ran > 60 && alone > 60, "{ran} {alone}");
}

/// The same exchanger as heat source and as radiator: `UA` of its air times the logarithmic mean, at the fan's power by the fan laws.
#[test]
fn the_front_end_exchanger_passes_the_same_both_ways_and_its_fan_follows_the_request() {
    let plant = Plant::load("jeffs2019", &[]).expect("built in");
    let air = air::at_temperature(Celsius(10.0).kelvin());
    for (circuit, soak_degc, opposite) in [("chiller", -15.0, "htc"), ("htc", 40.0, "chiller")] {
        // Speed, request, lowest and highest power of the fan.
        for (speed_m_s, request_w, fan_w) in [
            (60.0 / 3.6, 20_000.0, (0.0, 0.0)),
            (0.0, 20_000.0, (199.9, 200.1)),
            (0.0, 1500.0, (0.1, 100.0)),
            (7.5, 20_000.0, (24.9, 25.1)),
            (5.0, 500.0, (0.0, 0.0)),
            (0.0, 0.0, (0.0, 0.0)),
        ] {
            let mut state = parked(&plant, soak_degc, &[]);
            let flow = format!("{circuit}_flow");
            let levels = [(flow.as_str(), 0.35), ("ambient_request", request_w)];
            let command = command(&plant, &[("ambient", circuit)], &levels);
            for time_s in 0..25 {
                let record = second(&plant, &mut state, &command, &weather(10.0, speed_m_s));
                let used_w = record.flows[Flow::FAN];
                assert!(
                    (fan_w.0..=fan_w.1).contains(&used_w),
                    "{circuit} {speed_m_s} {request_w}: {used_w} W"
                );
                let heat_w = column(&plant, &record, &format!("ambient_{circuit}_heat_flow_w"));
                assert_eq!(column(&plant, &record, &format!("ambient_{opposite}_heat_flow_w")), 0.0);
                if time_s < 20 || request_w < 20_000.0 {
                    assert!(heat_w < request_w.max(1.0) * 1.3);
                    continue;
                }
                let fan_m3_s = 0.6 * (used_w / 200.0).cbrt();
                let air_kg_s = air.density_kg_m3 * (0.25 * (0.2 * speed_m_s).hypot(0.1)).hypot(fan_m3_s);
                let ua_w_k = plant.vehicle.front_ends[0].ua_w_k * air_kg_s.powf(0.6);
                let place = plant.layout().circuit(circuit).expect("a loop");
                let share = plant.vehicle.loops[place].circuit.branch_shares.of("ambient");
                // Rejection has the whole flow, as closed branches hand theirs on.
                let share = if circuit == "htc" { 1.0 } else { share };
                let coolant_w_k = VALVE_OPEN * share * rate_w_k(&plant, &state, circuit);
                let coolant_k = node_k(&plant, &state, &format!("{circuit}_supply"));
                let (out_w, ambient_k) =
                    (if circuit == "htc" { heat_w } else { -heat_w }, Celsius(10.0).kelvin());
                let coolants_k = (coolant_k, coolant_k - out_w / coolant_w_k);
                let airs_k = (ambient_k, ambient_k + out_w / (1006.0 * air_kg_s));
                let mean_k = if out_w > 0.0 {
                    logarithmic_mean_k(coolants_k, airs_k)
                } else {
                    logarithmic_mean_k(airs_k, coolants_k)
                };
                close(&format!("{circuit} at {speed_m_s} m/s"), heat_w, ua_w_k * mean_k, 1e-5);
            }
        }
    }
}

fn signal(plant: &Plant, state: &State, record: &StepRecord, disturbance: &Disturbance, name: &str) -> f64 {
    let signal = plant.signals.rows().iter().find(|signal| signal.name == name).expect("a signal");
    signal.reader.read(&View { plant, state, record: Some(record), disturbance })
}

#[test]
fn the_coefficient_of_performance_is_of_the_evaporator_while_a_cabin_is_cooled() {
    for (vehicle, cools, heats) in [
        (
            "jeffs2019",
            vec![("cabin", "chiller"), ("ambient", "htc")],
            vec![("cabin", "htc"), ("ambient", "chiller"), ("motor", "chiller")],
        ),
        (
            "jeffs2019-direct",
            vec![("cabin_evaporator", "open"), ("front_condenser", "open")],
            vec![("cabin_condenser", "open"), ("front_evaporator", "open")],
        ),
    ] {
        let plant = Plant::load(vehicle, &[]).expect("built in");
        for (connections, degc, useful) in [(cools, 35.0, Flow::EVAPORATOR), (heats, 5.0, Flow::CONDENSER)] {
            let mut state = parked(&plant, degc, &[]);
            let mut levels = vec![("compressor_power", 1500.0), ("blower_level", 0.6)];
            if vehicle == "jeffs2019" {
                levels.extend([("htc_flow", 0.3), ("chiller_flow", 0.3)]);
            }
            let command = command(&plant, &connections, &levels);
            let mut ran = 0;
            for time_s in 0..60 {
                let weather = weather(degc, 12.0);
                let record = second(&plant, &mut state, &command, &weather);
                // By then the coolant is cold or warm enough for the cabin to be connected.
                if record.refrigeration.running() && time_s >= 30 {
                    let expected = record.flows[useful] / record.flows[Flow::COMPRESSOR];
                    assert_eq!(
                        signal(&plant, &state, &record, &weather, "cop"),
                        expected,
                        "{vehicle} {degc}"
                    );
                    ran += 1;
                }
            }
            assert!(ran > 20, "{vehicle} at {degc} degC ran {ran} s");
        }
    }
}
