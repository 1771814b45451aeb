//! A compressor with vapour injection: balances, what injection gains, and that every problem is solved.

#[path = "support/refrigeration.rs"]
mod support;

use hp_plant::circuits::refrigeration_cycle::{RefrigerationCycle, RefrigerationParameters};
use hp_plant::circuits::refrigeration_loop::{Limit, LoopBoundary, LoopDemand, LoopResult, LoopStatus};
use hp_plant::circuits::vapour_injection::{EconomiserParameters, InjectionParameters};
use hp_plant::components::heat_exchanger::inlet_conductance_w_k;
use hp_plant::config::{Validate, library::Override, vehicle::VehicleParameters};
use hp_plant::media::refrigerant::RefrigerantTable;
use hp_plant::numerics::dual::{Dual, Real};
use support::{CONDENSER_UA_W_K, EVAPORATOR_UA_W_K, boundary, injection, parameters};

const FLUIDS: [&str; 4] = ["r134a", "r1234yf", "r290", "r152a"];

fn cycle(fluid: &str, injection: Option<InjectionParameters>) -> RefrigerationCycle {
    let table = RefrigerantTable::load(fluid).expect("built in");
    let limits = *table.limits().expect("it has them");
    let lowest_bar = table.saturation_pressure_pa(table.lowest_saturation_k()) / 1e5;
    let parameters = RefrigerationParameters {
        injection,
        maximum_pressure_bar: limits.maximum_pressure_bar,
        minimum_suction_pressure_bar: parameters().minimum_suction_pressure_bar.max(lowest_bar),
        ..parameters()
    };
    parameters.validate().expect("in range");
    RefrigerationCycle::new(parameters, table).expect("they fit the table")
}

fn demand(power_limit_w: f64) -> LoopDemand {
    LoopDemand { power_limit_w, speed_limit_rev_s: 140.0, hold_minimum_speed: false }
}

/// Numbers between 0 and 1, the same in every run.
fn random() -> impl FnMut() -> f64 {
    let mut state = 2016_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn check_running(cycle: &RefrigerationCycle, b: &LoopBoundary, r: &LoopResult) {
    let evaporator = inlet_conductance_w_k(b.cold_capacity_rate_w_k, EVAPORATOR_UA_W_K);
    let condenser = inlet_conductance_w_k(b.hot_capacity_rate_w_k, CONDENSER_UA_W_K);
    let taken = evaporator * (b.cold_return_k - r.evaporating_temperature_k);
    let given = condenser * (r.condensing_temperature_k - b.hot_return_k);
    assert!((taken - r.evaporator_heat_flow_w).abs() < 0.1, "{taken}: {r:?}");
    assert!((given - r.condenser_heat_flow_w).abs() < 0.1, "{given}: {r:?}");
    let shaft_w = r.electric_power_w - r.loss_to_ambient_w;
    assert!((r.condenser_heat_flow_w - r.evaporator_heat_flow_w - shaft_w).abs() < 1e-6, "{r:?}");
    // Near the critical point most of the liquid flashes.
    assert!(r.injected_mass_flow_kg_s > 0.0 && r.injected_mass_flow_kg_s < 1.5 * r.mass_flow_kg_s, "{r:?}");
    if b.hot_return_k > b.cold_return_k {
        let carnot = b.hot_return_k / (b.hot_return_k - b.cold_return_k);
        assert!(r.condenser_heat_flow_w / shaft_w < carnot, "{r:?}");
    }
    for margin in cycle.stream_margins_k(b, r) {
        assert!(margin > -1e-9, "{:?} {r:?}", cycle.stream_margins_k(b, r));
    }
    assert!(r.discharge_temperature_k <= 130.0 + 273.15 + 1e-4, "{r:?}");
}

#[test]
fn every_operating_point_of_every_fluid_is_solved_and_nearly_always_by_newton() {
    for fluid in FLUIDS {
        for economiser in [true, false] {
            let cycle = cycle(fluid, Some(injection(economiser)));
            let mut next = random();
            let (mut ran, mut solved, mut bracketed, mut iterations) = (0, 0, 0, 0);
            for _ in 0..4000 {
                let b = boundary(
                    -40.0 + 130.0 * next(),
                    -40.0 + 80.0 * next(),
                    50.0 + 1950.0 * next(),
                    50.0 + 1950.0 * next(),
                );
                let result = cycle.solve(&b, &demand(5000.0 * next()), None);
                assert_ne!(result.status, LoopStatus::NotConverged, "{fluid}: {b:?} {result:?}");
                if result.running() {
                    check_running(&cycle, &b, &result);
                    ran += 1;
                }
                if result.iterations > 0 && result.limited_by != Limit::Discharge {
                    solved += 1;
                    bracketed += u32::from(result.bracketed);
                    iterations += if result.bracketed { 0 } else { result.iterations };
                }
            }
            println!(
                "{fluid} {economiser}: {ran} ran, {bracketed} of {solved} bracketed, {iterations} iterations"
            );
            assert!(ran > 500, "{fluid}: {ran}");
            assert!(f64::from(bracketed) < 0.01 * f64::from(solved), "{fluid}: {bracketed} of {solved}");
            assert!(f64::from(iterations) < 8.0 * f64::from(solved), "{fluid}: {iterations} of {solved}");
        }
    }
}

#[test]
fn injection_gives_more_heat_for_the_same_power_and_cooler_gas() {
    let cycle = cycle("r134a", Some(injection(false)));
    let b = boundary(40.0, -15.0, 900.0, 800.0);
    let with = cycle.solve(&b, &demand(1500.0), None);
    let without = self::cycle("r134a", None).solve(&b, &demand(1500.0), None);
    assert!(with.running() && without.running());
    // At the same electrical power injection gives more heat, and the gas is cooler.
    assert!(with.condenser_heat_flow_w > 1.02 * without.condenser_heat_flow_w, "{with:?} {without:?}");
    assert!(with.discharge_temperature_k < without.discharge_temperature_k - 3.0, "{with:?} {without:?}");
}

#[test]
fn an_economiser_that_passes_no_heat_injects_nothing() {
    let idle = InjectionParameters {
        pressure_position: 0.5,
        economiser: Some(EconomiserParameters { effectiveness: 0.0, superheat_k: 0.0 }),
    };
    let b = boundary(40.0, -15.0, 900.0, 800.0);
    let (with, without) = (
        cycle("r134a", Some(idle)).solve(&b, &demand(1500.0), None),
        cycle("r134a", None).solve(&b, &demand(1500.0), None),
    );
    assert_eq!(with.injected_mass_flow_kg_s, 0.0);
    let heat = with.condenser_heat_flow_w / without.condenser_heat_flow_w;
    assert!(
        (heat - 1.0).abs() < 1e-3,
        "two stages of the same gas are not the one that they stand for: {heat}"
    );
}

#[test]
fn inverse_properties_have_the_right_values_and_slopes() {
    for fluid in FLUIDS {
        let table = RefrigerantTable::load(fluid).expect("built in");
        for temperature_k in [230.0, 268.4, 301.7, 340.2] {
            let pressure = table.saturation_pressure_pa(Dual::variable(temperature_k));
            let found = table.saturation_near_k(Dual::variable(pressure.value), temperature_k + 7.0);
            assert!((found.value - temperature_k).abs() < 1e-9, "{fluid} {found:?}");
            assert!((found.gradient * pressure.gradient - 1.0).abs() < 1e-9, "{fluid} {found:?}");
            let isobar = table.condensing_isobar(Dual::variable(temperature_k));
            let range = table.entropy_range_j_kg_k();
            for excess in [-30.0, 15.0, 90.0, 170.0, 600.0] {
                let entropy = isobar.dew_entropy_j_kg_k + excess;
                let enthalpy = isobar.enthalpy_at_any_entropy_j_kg(entropy, range);
                let back = isobar.entropy_at_enthalpy_j_kg_k(enthalpy, range);
                assert!((back.value - entropy.value).abs() < 1e-9, "{fluid} {back:?}");
                assert!((back.gradient - entropy.gradient).abs() < 1e-9, "{fluid} {back:?} {entropy:?}");
            }
        }
    }
}

/// CoolProp 8.0.0: enthalpies of liquid at 25 bar less that of saturated liquid at 0 degC [J/kg].
#[test]
fn liquid_far_below_saturation_agrees_with_coolprop() {
    for (fluid, exact) in LIQUID_RISE_J_KG {
        let table = RefrigerantTable::load(fluid).expect("built in");
        let under = table.liquid_under_pressure();
        let base: f64 = table.condensing_isobar(273.15_f64).liquid_enthalpy_j_kg(0.0);
        for (degc, exact) in [0.0, 20.0, 40.0, 55.0].into_iter().zip(exact) {
            let rise = table.liquid_at_pressure_j_kg(&under, degc + 273.15, 25e5) - base;
            assert!((rise - exact).abs() < 150.0, "{fluid} at {degc} degC: {rise} against {exact}");
        }
    }
}

const LIQUID_RISE_J_KG: [(&str, [f64; 4]); 4] = [
    ("r134a", [527.1, 27665.8, 56185.6, 78938.3]),
    ("r1234yf", [517.6, 26843.8, 54668.5, 76977.0]),
    ("r290", [1165.4, 51988.5, 106598.9, 151286.9]),
    ("r152a", [842.9, 35226.5, 71304.2, 99902.9]),
];

#[test]
fn a_vehicle_has_injection_by_a_section_of_its_file() {
    let load = |changes: &[&str]| {
        let changes: Vec<Override> =
            changes.iter().map(|change| Override::parse(change).expect("an assignment")).collect();
        VehicleParameters::load("jeffs2019", &changes)
    };
    assert_eq!(load(&[]).expect("built in").refrigeration.expect("it has one").injection, None);
    let whole = "refrigeration.injection={ pressure_position = 0.5, economiser = { effectiveness = 0.85, superheat_k = 5.0 } }";
    assert_eq!(
        load(&[whole]).expect("allowed").refrigeration.expect("it has one").injection,
        Some(injection(true))
    );
    let flash = load(&["refrigeration.injection={ pressure_position = 0.5 }"]).expect("allowed");
    assert_eq!(flash.refrigeration.expect("it has one").injection, Some(injection(false)));
    let message =
        load(&["refrigeration.injection={ pressure_position = 1.5 }"]).expect_err("refused").to_string();
    let parts = ["jeffs2019", "refrigeration.injection.pressure_position", "1.5", "between 0.2 and 0.8"];
    assert!(parts.iter().all(|part| message.contains(part)), "{message}");
}

#[test]
fn derivatives_of_the_cycle_with_injection_are_those_of_its_values() {
    // The third derivative-free check of the duals: saturation, entropy and mixing in one function.
    fn mixed<T: Real>(table: &RefrigerantTable, pressure_pa: T) -> T {
        let middle_k = table.saturation_near_k(pressure_pa, 280.0);
        let middle = table.condensing_isobar(middle_k.alone()).of(middle_k);
        middle.entropy_at_enthalpy_j_kg_k(middle.dew_enthalpy_j_kg + 12_000.0, 180.0)
            + table.superheated_enthalpy_j_kg(middle_k, T::constant(4.0))
            + table.liquid_at_pressure_j_kg(&table.liquid_under_pressure(), middle_k + 5.0, pressure_pa * 3.0)
    }
    let table = RefrigerantTable::load("r290").expect("built in");
    let (pressure_pa, step) = (6e5, 10.0);
    let exact = mixed(&table, Dual::variable(pressure_pa)).gradient;
    let by_difference =
        (mixed(&table, pressure_pa + step) - mixed(&table, pressure_pa - step)) / (2.0 * step);
    assert!((exact - by_difference).abs() < 1e-6 * exact.abs(), "{exact} {by_difference}");
}
