//! Water, carbon dioxide and fog of a cabin, each against a calculation by hand, and what of it reaches the energy balance.

use hp_plant::command::Command;
use hp_plant::components::cabin_air::{AMBIENT_CO2, AirConditions, CabinAir};
use hp_plant::components::wet_core::WetSurface;
use hp_plant::config::Celsius;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::Override;
use hp_plant::ledger::WaterEntry;
use hp_plant::media::{air, moist_air};
use hp_plant::plant::{Disturbance, Plant, StepRecord};
use hp_plant::state::State;
use proptest::prelude::*;

fn plant(overrides: &[&str]) -> Plant {
    let overrides: Vec<Override> =
        overrides.iter().map(|text| Override::parse(text).expect("an assignment")).collect();
    Plant::load("jeffs2019", &overrides).expect("built in")
}

fn weather(ambient_degc: f64, relative_humidity: f64, occupants: f64) -> Disturbance {
    let ambient_k = Celsius(ambient_degc).kelvin();
    Disturbance {
        start_speed_m_s: 60.0 / 3.6,
        end_speed_m_s: 60.0 / 3.6,
        air: air::at_temperature(ambient_k),
        ambient_humidity_ratio: moist_air::humidity_ratio(relative_humidity, ambient_k),
        solar_gain_w: 0.0,
        occupants,
        grade: 0.0,
        headwind_m_s: 0.0,
    }
}

/// Everything off but some levels.
fn command(plant: &Plant, levels: &[(&str, f64)]) -> Command {
    let mut demand = plant.ranges.idle();
    for (name, value) in levels {
        demand[plant.ranges.row(name).expect("an actuator")] = *value;
    }
    plant.ranges.encode(&demand)
}

fn drive(
    plant: &Plant,
    state: &mut State,
    command: &Command,
    weather: &Disturbance,
    steps: u32,
) -> StepRecord {
    let mut record = StepRecord::default();
    for _ in 0..steps {
        plant.step_into(state, command, weather, &mut record);
        assert!(record.water_ledger.relative() < 1e-9, "{:?}", record.water_ledger);
        assert!(record.ledger.relative() < 1e-9, "{:?}", record.ledger);
    }
    record
}

/// Two people, 0.04 kg/s of fresh air: 8e-5 / 0.04 = 2 g/kg above ambient, 2 5e-6 1.204 / 0.04 = 301 ppm above 420.
#[test]
fn steady_humidity_and_carbon_dioxide_are_those_of_a_hand_calculation() {
    let plant = plant(&[]);
    let weather = weather(20.0, 0.3, 2.0);
    let cabin = plant.vehicle.cabin();
    let level =
        (0.04 - cabin.minimum_air_flow_kg_s) / (cabin.maximum_air_flow_kg_s - cabin.minimum_air_flow_kg_s);
    let command = command(&plant, &[("blower_level", level), ("recirculation", 0.0)]);
    let initial = InitialParameters::soaked(Celsius(20.0), 80.0);
    let mut state = plant.parked_in(&initial, weather.ambient_humidity_ratio);
    drive(&plant, &mut state, &command, &weather, 3600);
    let found = state.cabin_air[0];
    let expected = weather.ambient_humidity_ratio + 8e-5 / 0.04;
    assert!((found.humidity_ratio / expected - 1.0).abs() < 1e-6, "{found:?} {expected}");
    assert!((found.co2 * 1e6 - (420.0 + 301.0)).abs() < 0.1, "{found:?}");
    assert_eq!(found.film_kg, 0.0);
}

/// PsychroLib: the dew point of 22 degC and 30 % is 3.645 degC.
#[test]
fn fog_margin_is_the_distance_of_the_windscreen_from_the_published_dew_point() {
    let humidity_ratio = moist_air::humidity_ratio(0.3, Celsius(22.0).kelvin());
    let air = CabinAir { humidity_ratio, ..CabinAir::parked(Celsius(2.0).kelvin()) };
    assert!((air.fog_margin_k() - (2.0 - 3.645)).abs() < 0.03, "{}", air.fog_margin_k());
}

/// Recirculated breath fogs a cold windscreen, air blown at it and fresh air clear it again.
#[test]
fn a_windscreen_fogs_up_and_clears() {
    let plant = plant(&[]);
    let weather = weather(0.0, 0.9, 4.0);
    let initial = InitialParameters::soaked(Celsius(0.0), 80.0);
    let mut state = plant.parked_in(&initial, weather.ambient_humidity_ratio);
    let closed = command(&plant, &[("blower_level", 0.4), ("recirculation", 0.7)]);
    let fogged = drive(&plant, &mut state, &closed, &weather, 900);
    assert!(state.cabin_air[0].film_kg > 0.005, "{:?}", state.cabin_air[0]);
    assert!(fogged.water[0].windscreen_kg_s > 0.0, "{fogged:?}");
    let open = [("blower_level", 1.0), ("recirculation", 0.0), ("windscreen_share", 1.0), ("cabin", 1.0)];
    let open = command(&plant, &open);
    let warm = Disturbance { occupants: 1.0, ..weather };
    for _ in 0..900 {
        for node in [plant.layout().loops[0].supply, plant.layout().loops[0].back] {
            state.temperatures_k[node.index()] = Celsius(60.0).kelvin();
        }
        drive(&plant, &mut state, &open, &warm, 1);
    }
    assert!(state.cabin_air[0].fog_margin_k() > 5.0, "{:?}", state.cabin_air[0]);
    assert_eq!(state.cabin_air[0].film_kg, 0.0);
}

/// Water that condenses nowhere changes no temperature, to the last bit.
#[test]
fn moisture_alone_changes_no_temperature() {
    let plant = plant(&[]);
    let command =
        command(&plant, &[("blower_level", 0.5), ("recirculation", 0.5), ("cabin", 1.0), ("ptc", 1.0)]);
    let end = |relative_humidity| {
        let weather = weather(-5.0, relative_humidity, 3.0);
        let initial = InitialParameters::soaked(Celsius(-5.0), 80.0);
        let mut state = plant.parked_in(&initial, weather.ambient_humidity_ratio);
        let record = drive(&plant, &mut state, &command, &weather, 600);
        (state, record)
    };
    let (dry, humid) = (end(0.0), end(0.9));
    assert_eq!(dry.0.temperatures_k, humid.0.temperatures_k);
    assert_eq!(dry.1.flows, humid.1.flows);
    assert!(humid.0.cabin_air[0].humidity_ratio > dry.0.cabin_air[0].humidity_ratio + 0.001);
}

/// The core's latent heat is its water times 2477 kJ/kg, enters the vehicle, and takes from the sensible heat.
#[test]
fn water_that_condenses_on_the_cooling_core_loads_the_chiller() {
    let plant = plant(&[]);
    let command = command(&plant, &[("blower_level", 1.0), ("recirculation", 0.0), ("cabin", 2.0)]);
    let layout = plant.layout();
    let second = |relative_humidity| {
        let weather = weather(35.0, relative_humidity, 1.0);
        let mut state =
            plant.parked_in(&InitialParameters::soaked(Celsius(35.0), 80.0), weather.ambient_humidity_ratio);
        let circuit = &layout.loops[1];
        (0..30)
            .map(|_| {
                for node in [circuit.supply, circuit.back] {
                    state.temperatures_k[node.index()] = Celsius(5.0).kelvin();
                }
                drive(&plant, &mut state, &command, &weather, 1)
            })
            .last()
            .expect("steps")
    };
    let (dry, humid) = (second(0.0), second(0.5));
    let latent = layout.cabins[0].latent_flow.expect("a cooling core");
    let core = layout.branches[layout.cabins[0].cooler.expect("a cooling core")].flow;
    assert_eq!(dry.flows[latent], 0.0);
    let expected_w = humid.water[0].core_kg_s * (2.501e6 - 2370.0 * 10.0);
    assert!((humid.flows[latent] - expected_w).abs() < 1e-9 && expected_w > 300.0, "{expected_w}");
    assert!(humid.flows[core] < 0.95 * dry.flows[core], "{} {}", humid.flows[core], dry.flows[core]);
    assert!(humid.flows[core] + humid.flows[latent] > 1.1 * dry.flows[core]);
}

#[test]
fn sun_on_furnishings_warms_the_air_later_and_is_all_counted() {
    let air_after = |share: &str| {
        let plant = plant(&[share]);
        let weather = Disturbance { solar_gain_w: 600.0, ..weather(20.0, 0.0, 0.0) };
        let mut state = plant.parked(&InitialParameters::soaked(Celsius(20.0), 80.0));
        let command = command(&plant, &[("blower_level", 0.0)]);
        let record = drive(&plant, &mut state, &command, &weather, 120);
        let cabin = &plant.layout().cabins[0];
        let sun = [cabin.solar_flow, cabin.solar_soft_flow, cabin.solar_hard_flow];
        assert!((record.flows.sum_w(&sun) - 600.0).abs() < 1e-9);
        state.temperatures_k[cabin.air.index()]
    };
    let (into_air, onto_furnishings) = (
        air_after("cabin.solar_to_furnishings_share=0.0"),
        air_after("cabin.solar_to_furnishings_share=0.8"),
    );
    assert!(onto_furnishings < into_air - 1.0, "{onto_furnishings} {into_air}");
}

proptest! {
    /// Whatever the air meets, and with any step: the water balances, nothing is negative, and a falsified flow shows.
    #[test]
    fn water_balances_whatever_happens(
        ratios in prop::collection::vec(0.0..0.05_f64, 3), supply_kg_s in 0.01..0.2_f64, recirculation in 0.0..0.95_f64,
        occupants in 0.0..9.0_f64, film_kg in 0.0..0.05_f64, glass_degc in -30.0..60.0_f64, blown in 0.0..1.0_f64,
        touched in 0.0..1.0_f64, step_exponent in -3.0..4.0_f64,
    ) {
        let plant = plant(&[]);
        let cabin = plant.vehicle.cabin();
        let step_s = 10.0_f64.powf(step_exponent);
        let mut air = CabinAir {
            humidity_ratio: ratios[0], co2: AMBIENT_CO2, windscreen_k: Celsius(glass_degc).kelvin(), film_kg,
        };
        let surface = WetSurface {
            surface_k: 280.0, surface_ratio: ratios[1], touched_kg_s: touched * supply_kg_s, sensible_share: 1.0,
        };
        let now = AirConditions {
            supply_kg_s, recirculation, ambient_ratio: ratios[2], occupants, wet: (touched > 0.3).then_some(surface),
            windscreen: cabin.windscreen.conditions(blown * supply_kg_s, 20.0),
            windscreen_air_k: 295.0, ambient_k: 270.0,
        };
        let before_kg = cabin.air.water_kg(&air);
        let flows = cabin.air.step(&cabin.windscreen, &mut air, &now, step_s);
        let stored_kg = cabin.air.water_kg(&air) - before_kg;
        let entry = WaterEntry::balance(&flows, stored_kg, step_s);
        // In a thousandth of a second the change is round-off of what is stored.
        let tolerance = if step_s < 0.1 { 1e-7 } else { 1e-9 };
        prop_assert!(entry.relative() < tolerance, "{entry:?} {flows:?}");
        prop_assert!(air.humidity_ratio >= 0.0 && air.film_kg >= 0.0 && flows.core_kg_s >= 0.0);
        prop_assert!(air.co2 >= AMBIENT_CO2 * (1.0 - 1e-12));
        let falsified = hp_plant::components::cabin_air::WaterFlows { exhaust_kg_s: flows.exhaust_kg_s * 1.01, ..flows };
        if flows.exhaust_kg_s > 1e-6 {
            prop_assert!(WaterEntry::balance(&falsified, stored_kg, step_s).relative() > tolerance);
        }
    }
}
