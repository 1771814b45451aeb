//! The refrigeration loop over its whole range: convergence, balances, second law, limits, envelope.

#[path = "support/refrigeration.rs"]
mod support;

use hp_plant::circuits::refrigeration_cycle::RefrigerationCycle;
use hp_plant::circuits::refrigeration_loop::{
    CompressorAllowance, Limit, LoopBoundary, LoopDemand, LoopResult, LoopStatus, RefrigerationState,
    SupplyLimit, WarmStart,
};
use hp_plant::components::heat_exchanger::inlet_conductance_w_k;
use hp_plant::config::Validate;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::Cell;
use support::{CONDENSER_UA_W_K, EVAPORATOR_UA_W_K, boundary, cycle, parameters};

const CASES: u32 = if cfg!(debug_assertions) { 5_000 } else { 50_000 };
const SPEED_LIMIT: f64 = 140.0;

fn demand(power_limit_w: f64) -> LoopDemand {
    LoopDemand { power_limit_w, speed_limit_rev_s: SPEED_LIMIT, hold_minimum_speed: false }
}

/// Everything that the plant may ask for, hot colder than cold included.
fn any_boundary() -> impl Strategy<Value = LoopBoundary> {
    let temperatures = (-40.0..95.0_f64, -40.0..50.0_f64);
    let rates = (50.0..2000.0_f64, 50.0..2000.0_f64);
    let sensitivities = (0.0..3e-3_f64, 0.0..3e-3_f64);
    (temperatures, rates, sensitivities, any::<bool>()).prop_map(
        |((hot, cold), (hot_w_k, cold_w_k), s, capped)| {
            let mut boundary = boundary(hot, cold, hot_w_k, cold_w_k);
            if capped {
                let (base_k, limit_k) = (boundary.hot_return_k - 1.0, 90.0 + 273.15);
                boundary.hot_supply = SupplyLimit { base_k, sensitivity_k_w: s.0, limit_k };
                let (base_k, limit_k) = (boundary.cold_return_k + 1.0, -10.0 + 273.15);
                boundary.cold_supply = SupplyLimit { base_k, sensitivity_k_w: s.1, limit_k };
            }
            boundary
        },
    )
}

fn any_demand() -> impl Strategy<Value = LoopDemand> {
    (0.0..5000.0_f64, 14.0..SPEED_LIMIT, any::<bool>()).prop_map(
        |(power_limit_w, speed_limit_rev_s, hold_minimum_speed)| LoopDemand {
            power_limit_w,
            speed_limit_rev_s,
            hold_minimum_speed,
        },
    )
}

fn any_warm_start() -> impl Strategy<Value = Option<WarmStart>> {
    let places = (200.0..330.0_f64, 220.0..370.0_f64, 0.0..200.0_f64);
    proptest::option::of(places.prop_map(|(evaporating_k, condensing_k, speed_rev_s)| WarmStart {
        evaporating_k,
        condensing_k,
        speed_rev_s,
    }))
}

fn for_all<S: Strategy>(strategy: S, check: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
    let rng = proptest::test_runner::TestRng::deterministic_rng(prop::test_runner::RngAlgorithm::ChaCha);
    if let Err(error) = TestRunner::new_with_rng(config, rng).run(&strategy, check) {
        panic!("{error}");
    }
}

/// Balances, second law and limits of a running loop.
fn check_running(
    cycle: &RefrigerationCycle,
    b: &LoopBoundary,
    d: &LoopDemand,
    r: &LoopResult,
) -> Result<(), TestCaseError> {
    let p = parameters();
    let evaporator = inlet_conductance_w_k(b.cold_capacity_rate_w_k, EVAPORATOR_UA_W_K);
    let condenser = inlet_conductance_w_k(b.hot_capacity_rate_w_k, CONDENSER_UA_W_K);
    let taken = evaporator * (b.cold_return_k - r.evaporating_temperature_k);
    let given = condenser * (r.condensing_temperature_k - b.hot_return_k);
    prop_assert!((taken - r.evaporator_heat_flow_w).abs() < 0.1, "evaporator {taken}: {r:?}");
    prop_assert!((given - r.condenser_heat_flow_w).abs() < 0.1, "condenser {given}: {r:?}");
    let shaft_w = r.electric_power_w - r.loss_to_ambient_w;
    let balance = r.condenser_heat_flow_w - r.evaporator_heat_flow_w - shaft_w;
    prop_assert!(balance.abs() < 1e-6, "balance {balance}: {r:?}");
    if b.hot_return_k > b.cold_return_k {
        let carnot = b.hot_return_k / (b.hot_return_k - b.cold_return_k);
        prop_assert!(r.condenser_heat_flow_w / shaft_w < carnot, "{r:?}");
    }
    for margin in cycle.stream_margins_k(b, r) {
        prop_assert!(margin > -1e-9, "{:?} {r:?}", cycle.stream_margins_k(b, r));
    }
    prop_assert!(r.speed_rev_s >= p.compressor.minimum_speed_rev_s * (1.0 - 1e-6), "{r:?}");
    prop_assert!(r.speed_rev_s <= d.speed_limit_rev_s * (1.0 + 1e-6), "{r:?}");
    prop_assert!(r.condensing_pressure_pa <= 30.01e5, "{r:?}");
    prop_assert!(r.evaporating_pressure_pa >= 0.2e5 * (1.0 - 1e-4), "{r:?}");
    prop_assert!(r.discharge_temperature_k <= 130.0 + 273.15 + 1e-4, "{r:?}");
    let hot = b.hot_supply.base_k + b.hot_supply.sensitivity_k_w * r.condenser_heat_flow_w;
    let cold = b.cold_supply.base_k - b.cold_supply.sensitivity_k_w * r.evaporator_heat_flow_w;
    prop_assert!(hot <= b.hot_supply.limit_k + 1e-4 && cold >= b.cold_supply.limit_k - 1e-4, "{r:?}");
    if r.status != LoopStatus::MinimumSpeed {
        prop_assert!(r.electric_power_w <= d.power_limit_w + 1e-3, "{r:?}");
    }
    let at_limit = match r.limited_by {
        Limit::Power => (r.electric_power_w - d.power_limit_w).abs() < 1e-3,
        Limit::Speed => (r.speed_rev_s - d.speed_limit_rev_s).abs() < 1e-6,
        Limit::MinimumSpeed => (r.speed_rev_s - p.compressor.minimum_speed_rev_s).abs() < 1e-6,
        Limit::Pressure => (r.condensing_pressure_pa - 30e5).abs() < 1e3,
        Limit::Suction => (r.evaporating_pressure_pa - 0.2e5).abs() < 10.0,
        Limit::HotCoolant => (hot - b.hot_supply.limit_k).abs() < 1e-4,
        Limit::ColdCoolant => (cold - b.cold_supply.limit_k).abs() < 1e-4,
        Limit::Discharge => (r.discharge_temperature_k - 403.15).abs() < 1e-4,
        Limit::CoolantFlow => false,
    };
    prop_assert!(at_limit, "not at the limit that is reported: {r:?}");
    Ok(())
}

#[test]
fn every_operating_point_is_solved_within_all_limits() {
    let cycle = cycle();
    parameters().validate().expect("the test parameters are in range");
    for_all((any_boundary(), any_demand(), any_warm_start()), |(b, d, warm)| {
        let result = cycle.solve(&b, &d, warm.as_ref());
        if result.running() {
            check_running(&cycle, &b, &d, &result)?;
        } else {
            prop_assert_eq!(
                result.electric_power_w + result.condenser_heat_flow_w + result.mass_flow_kg_s,
                0.0
            );
            prop_assert!(result.limited_by != Limit::CoolantFlow);
        }
        Ok(())
    });
}

#[test]
fn the_start_values_do_not_matter() {
    let cycle = cycle();
    for_all((any_boundary(), any_demand(), any_warm_start()), |(b, d, warm)| {
        let (cold, warm) = (cycle.solve(&b, &d, None), cycle.solve(&b, &d, warm.as_ref()));
        prop_assert_eq!(cold.status, warm.status, "{:?} {:?}", cold, warm);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(1.0);
        prop_assert!(close(cold.electric_power_w, warm.electric_power_w), "{:?} {:?}", cold, warm);
        prop_assert!(close(cold.condenser_heat_flow_w, warm.condenser_heat_flow_w), "{:?} {:?}", cold, warm);
        prop_assert!(close(cold.evaporating_temperature_k, warm.evaporating_temperature_k));
        prop_assert!(close(cold.speed_rev_s, warm.speed_rev_s), "{:?} {:?}", cold, warm);
        Ok(())
    });
}

#[test]
fn more_demand_never_gives_less_power_or_heat() {
    let cycle = cycle();
    for_all((any_boundary(), any_demand(), 0.0..1000.0_f64), |(b, d, more)| {
        let stronger = LoopDemand { power_limit_w: d.power_limit_w + more, ..d };
        let (low, high) = (cycle.solve(&b, &d, None), cycle.solve(&b, &stronger, None));
        prop_assert!(high.electric_power_w >= low.electric_power_w - 1e-4, "{:?} {:?}", low, high);
        prop_assert!(high.condenser_heat_flow_w >= low.condenser_heat_flow_w - 1e-2, "{:?} {:?}", low, high);
        Ok(())
    });
}

#[test]
fn the_same_question_has_the_same_answer_to_the_last_bit() {
    let cycle = cycle();
    let warm = WarmStart { evaporating_k: 260.0, condensing_k: 330.0, speed_rev_s: 40.0 };
    let b = boundary(45.0, -5.0, 900.0, 700.0);
    let first = cycle.solve(&b, &demand(1500.0), Some(&warm));
    assert_eq!(first, cycle.solve(&b, &demand(1500.0), Some(&warm)));
}

#[test]
fn every_status_is_reached() {
    let cycle = cycle();
    let solve = |b: &LoopBoundary, d: LoopDemand| cycle.solve(b, &d, None);
    let ordinary = boundary(40.0, 0.0, 800.0, 700.0);
    assert_eq!(solve(&ordinary, demand(1500.0)).status, LoopStatus::Converged);
    assert_eq!(solve(&ordinary, demand(0.0)).status, LoopStatus::Off);
    assert_eq!(solve(&ordinary, demand(40.0)).limited_by, Limit::Power);
    let slow = LoopDemand { speed_limit_rev_s: 20.0, ..demand(5000.0) };
    assert_eq!(solve(&ordinary, slow).status, LoopStatus::SpeedLimited);
    let held = LoopDemand { hold_minimum_speed: true, ..demand(0.0) };
    assert_eq!(solve(&ordinary, held).status, LoopStatus::MinimumSpeed);
    assert_eq!(solve(&boundary(5.0, 40.0, 800.0, 700.0), demand(60.0)).status, LoopStatus::NoLift);
    assert_eq!(
        solve(&boundary(78.0, 20.0, 300.0, 900.0), demand(5000.0)).status,
        LoopStatus::PressureLimited
    );
    let mut guarded = parameters();
    guarded.minimum_suction_pressure_bar = 1.0;
    let guarded =
        RefrigerationCycle::new(guarded, cycle.table().clone()).expect("the parameters fit the table");
    let result = guarded.solve(&boundary(10.0, -22.0, 900.0, 900.0), &demand(3000.0), None);
    assert_eq!(result.status, LoopStatus::SuctionLimited);
    let hot = solve(&boundary(40.0, -15.0, 900.0, 900.0), demand(5000.0));
    assert_eq!(hot.status, LoopStatus::DischargeLimited);
    let mut capped = ordinary;
    capped.cold_supply = SupplyLimit { base_k: 271.0, sensitivity_k_w: 2e-3, limit_k: 263.15 };
    let result = solve(&capped, demand(5000.0));
    assert_eq!((result.status, result.limited_by), (LoopStatus::CoolantLimited, Limit::ColdCoolant));
    let mut capped = ordinary;
    capped.hot_supply = SupplyLimit { base_k: 355.0, sensitivity_k_w: 2e-3, limit_k: 363.15 };
    let result = solve(&capped, demand(5000.0));
    assert_eq!((result.status, result.limited_by), (LoopStatus::CoolantLimited, Limit::HotCoolant));
}

#[test]
fn what_is_beyond_a_limit_already_stays_off_and_says_why() {
    let cycle = cycle();
    let off = |b: &LoopBoundary| {
        let result = cycle.solve(b, &demand(3000.0), None);
        assert_eq!(result.status, LoopStatus::Off);
        result.limited_by
    };
    assert_eq!(off(&boundary(86.3, 20.0, 800.0, 700.0)), Limit::Pressure);
    assert_eq!(off(&boundary(20.0, -57.0, 800.0, 700.0)), Limit::Suction);
    assert_eq!(off(&boundary(20.0, 0.0, 0.0, 700.0)), Limit::CoolantFlow);
    assert_eq!(off(&boundary(f64::NAN, 0.0, 800.0, 700.0)), Limit::CoolantFlow);
    let mut cold = boundary(40.0, -10.0, 800.0, 700.0);
    cold.cold_supply.limit_k = cold.cold_supply.base_k + 0.1;
    assert_eq!(off(&cold), Limit::ColdCoolant);
}

#[test]
fn start_waits_for_a_whole_second_and_for_the_minimum_off_time() {
    let (cycle, b) = (cycle(), boundary(30.0, 0.0, 800.0, 700.0));
    let mut state = RefrigerationState::parked();
    assert!(!cycle.step(&mut state, &b, &allowed(1000.0, false), 0.1).running());
    assert!(cycle.step(&mut state, &b, &allowed(1000.0, true), 0.1).running());
    let mut on_s = 0.1;
    while cycle.step(&mut state, &b, &allowed(0.0, false), 0.1).running() {
        on_s += 0.1;
    }
    assert!((on_s - parameters().compressor.minimum_on_time_s).abs() < 0.01, "{on_s}");
    let mut off_s = 0.1;
    while !cycle.step(&mut state, &b, &allowed(1000.0, true), 0.1).running() {
        off_s += 0.1;
    }
    assert!((off_s - parameters().compressor.minimum_off_time_s).abs() < 0.01, "{off_s}");
    assert_eq!((state.compressor.starts, state.compressor.protection_trips), (2, 0));
}

#[test]
fn start_loss_is_the_same_energy_at_every_step_length() {
    let (cycle, b) = (cycle(), boundary(30.0, 0.0, 800.0, 700.0));
    for step_s in [1.0, 0.5, 0.3, 0.05] {
        let mut state = RefrigerationState::parked();
        let mut loss_j = 0.0;
        for _ in 0..60 {
            let result = cycle.step(&mut state, &b, &allowed(1000.0, true), step_s);
            let balance = result.condenser_heat_flow_w + result.loss_to_ambient_w
                - result.evaporator_heat_flow_w
                - result.electric_power_w;
            assert!(balance.abs() < 1e-6);
            loss_j += result.start_loss_w * step_s;
        }
        assert!((loss_j - 2000.0).abs() < 1e-6, "{step_s} {loss_j}");
    }
}

#[test]
fn speed_rises_with_the_ramp_and_falls_with_the_demand() {
    let (cycle, b) = (cycle(), boundary(30.0, 0.0, 800.0, 700.0));
    let mut state = RefrigerationState::parked();
    let mut last = parameters().compressor.minimum_speed_rev_s;
    for _ in 0..100 {
        let result = cycle.step(&mut state, &b, &allowed(1500.0, true), 0.1);
        assert!(result.speed_rev_s <= last + 2.0 + 1e-6);
        last = result.speed_rev_s;
    }
    assert_eq!(cycle.step(&mut state, &b, &allowed(1500.0, true), 0.1).status, LoopStatus::Converged);
    assert!(cycle.step(&mut state, &b, &allowed(700.0, true), 0.1).electric_power_w < 700.001);
}

#[test]
fn a_limit_that_leaves_no_room_trips_even_within_the_minimum_on_time() {
    let (cycle, mut b) = (cycle(), boundary(30.0, 0.0, 800.0, 700.0));
    let mut state = RefrigerationState::parked();
    assert!(cycle.step(&mut state, &b, &allowed(1000.0, true), 1.0).running());
    b.cold_supply = SupplyLimit { base_k: 263.2, sensitivity_k_w: 2e-3, limit_k: 263.15 };
    let result = cycle.step(&mut state, &b, &allowed(1000.0, true), 1.0);
    assert_eq!((result.status, result.limited_by), (LoopStatus::Off, Limit::ColdCoolant));
    assert_eq!(state.compressor.protection_trips, 1);
}

#[test]
fn leakage_makes_the_lowest_speed_a_poor_choice() {
    let compressor = parameters().compressor;
    let at = |speed: f64| compressor.efficiency(4.0, speed);
    assert!(at(13.3).isentropic < 0.9 * at(50.0).isentropic);
    assert!(at(13.3).volumetric < 0.9 * at(50.0).volumetric);
}

#[test]
fn parameters_that_contradict_the_table_are_refused_by_name() {
    let table = || hp_plant::media::refrigerant::RefrigerantTable::load("R134a").expect("built in");
    let mut high = parameters();
    high.maximum_pressure_bar = 40.0;
    assert_eq!(RefrigerationCycle::new(high, table()).expect_err("too high").key, "maximum_pressure_bar");
    let mut speed = parameters();
    speed.compressor.minimum_speed_rev_s = 150.0;
    let key = RefrigerationCycle::new(speed, table()).expect_err("crossed").key;
    assert_eq!(key, "compressor.minimum_speed_rev_s");
}

fn allowed(demand_w: f64, may_start: bool) -> CompressorAllowance {
    CompressorAllowance { demand_w, available_w: 20_000.0, may_start }
}

#[test]
fn a_compressor_that_cannot_be_fed_does_not_start_and_does_not_hold() {
    let cycle = cycle();
    let b = boundary(20.0, 0.0, 800.0, 700.0);
    let mut state = RefrigerationState::parked();
    let scarce = |available_w: f64| CompressorAllowance { demand_w: 3000.0, available_w, may_start: true };
    let loss_w = state.compressor.start_loss_w(&parameters().compressor, 1.0);
    assert!(!cycle.step(&mut state, &b, &scarce(loss_w), 1.0).running());
    let first = cycle.step(&mut state, &b, &scarce(loss_w + 1500.0), 1.0);
    assert!(first.running() && first.electric_power_w <= loss_w + 1500.0 + 1e-6);
    assert!(!cycle.step(&mut state, &b, &scarce(1.0), 1.0).running(), "held on without power");
}

/// Newton is what makes a step fast; bracketing is there for what it misses, and decides where the gas is too hot at
/// every speed.
#[test]
fn nearly_every_problem_is_solved_by_newton_in_a_few_iterations() {
    let cycle = cycle();
    let (solved, bracketed, iterations) = (Cell::new(0_u32), Cell::new(0), Cell::new(0));
    for_all((any_boundary(), any_demand(), any_warm_start()), |(b, d, warm)| {
        let result = cycle.solve(&b, &d, warm.as_ref());
        if result.iterations > 0 && result.limited_by != Limit::Discharge {
            solved.set(solved.get() + 1);
            bracketed.set(bracketed.get() + u32::from(result.bracketed));
            iterations.set(iterations.get() + if result.bracketed { 0 } else { result.iterations });
        }
        Ok(())
    });
    let share = |count: u32| f64::from(count) / f64::from(solved.get());
    assert!(solved.get() > CASES / 4);
    assert!(share(bracketed.get()) < 0.003, "{} of {} bracketed", bracketed.get(), solved.get());
    assert!(share(iterations.get()) < 5.0, "{} iterations each", share(iterations.get()));
}

#[test]
fn what_is_remembered_changes_iterations_but_no_result() {
    let (cycle, mut random) = (cycle(), 12_345_u64);
    let mut next = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut state = RefrigerationState::parked();
    let (mut remembering, mut forgetting, mut ran) = (0, 0, 0);
    for second in 0..4000 {
        // Pauses, jumps and stretches without any change.
        let (hot, cold) = (45.0 + 10.0 * next(), -5.0 + 8.0 * next());
        let (b, power) =
            (boundary(hot, cold, 900.0, 700.0), if next() < 0.2 { 0.0 } else { 4000.0 * next() });
        for _ in 0..1 + second % 4 {
            let allowed = CompressorAllowance { demand_w: power, available_w: 1e5, may_start: true };
            let mut blank = RefrigerationState { last: None, ..state };
            let with = cycle.step(&mut state, &b, &allowed, 1.0);
            let without = cycle.step(&mut blank, &b, &allowed, 1.0);
            assert_eq!(with.status, without.status, "second {second}");
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(1.0);
            assert!(close(with.electric_power_w, without.electric_power_w), "{with:?} {without:?}");
            assert!(close(with.condenser_heat_flow_w, without.condenser_heat_flow_w), "{with:?} {without:?}");
            if with.running() {
                ran += 1;
                remembering += with.iterations;
                forgetting += without.iterations;
            }
        }
    }
    assert!(ran > 2000, "{ran}");
    assert!(remembering < forgetting, "{remembering} and {forgetting} iterations");
}

/// By hand from the loop's own enthalpies: what of the loss does not leave heats the gas and is passed on by the condenser.
#[test]
fn loss_that_heats_the_gas_is_passed_on_by_the_condenser() {
    let at_share = |share: f64| {
        let mut parameters = parameters();
        parameters.compressor.loss_to_gas_share = share;
        parameters.compressor.electrical_efficiency = 0.7064;
        let table = hp_plant::media::refrigerant::RefrigerantTable::load("R134a").expect("built in");
        let cycle = RefrigerationCycle::new(parameters, table).expect("sound");
        (cycle.solve(&boundary(45.0, 0.0, 900.0, 800.0), &demand(1500.0), None), cycle)
    };
    let ((cold, _), (hot, cycle)) = (at_share(0.0), at_share(0.8));
    for (result, share) in [(&cold, 0.0), (&hot, 0.8)] {
        let loss_w = (1.0 - 0.7064) * result.electric_power_w;
        assert!((result.loss_to_ambient_w - (1.0 - share) * loss_w).abs() < 1e-9, "{result:?}");
        let balance_w = result.electric_power_w + result.evaporator_heat_flow_w
            - result.condenser_heat_flow_w
            - result.loss_to_ambient_w;
        assert!(balance_w.abs() < 1e-9, "{result:?}");
    }
    let isobar = cycle.table().condensing_isobar(hot.condensing_temperature_k);
    let liquid_j_kg = isobar.liquid_enthalpy_j_kg(hot.subcooling_k);
    let discharge_j_kg = liquid_j_kg + hot.condenser_heat_flow_w / hot.mass_flow_kg_s;
    let expected_k = cycle.table().discharge_temperature_k(&isobar, discharge_j_kg);
    assert!((hot.discharge_temperature_k - expected_k).abs() < 1e-6);
    let cop = |result: &LoopResult| result.condenser_heat_flow_w / result.electric_power_w;
    assert!(cop(&hot) > cop(&cold) + 0.15, "{} {}", cop(&cold), cop(&hot));
    assert!(hot.discharge_temperature_k > cold.discharge_temperature_k + 10.0, "{cold:?} {hot:?}");
}

/// That of the default vehicle as it was fitted before its losses went into the gas [-].
const POOR_MOTOR_EFFICIENCY: f64 = 0.7064;

/// The default vehicle's heat pump, with a poor motor, between coolants [degC] at a power: COP and discharge temperature [degC].
fn default_heat_pump(share: f64, hot_degc: f64, cold_degc: f64, power_w: f64) -> (f64, f64) {
    let vehicle = hp_plant::config::vehicle::VehicleParameters::load("jeffs2019", &[]).expect("built in");
    let mut parameters = vehicle.refrigeration.expect("it has a heat pump");
    parameters.compressor.loss_to_gas_share = share;
    parameters.compressor.electrical_efficiency = POOR_MOTOR_EFFICIENCY;
    parameters.compressor.maximum_discharge_temperature_degc = 150.0;
    let table = hp_plant::media::refrigerant::RefrigerantTable::load("R134a").expect("built in");
    let cycle = RefrigerationCycle::new(parameters, table).expect("sound");
    let mut b = boundary(hot_degc, cold_degc, 900.0, 800.0);
    b.hot_conductance_w_k = inlet_conductance_w_k(900.0, vehicle.exchanger_ua_w_k[0]);
    b.cold_conductance_w_k = inlet_conductance_w_k(800.0, vehicle.exchanger_ua_w_k[1]);
    let result = cycle.solve(&b, &demand(power_w), None);
    assert_eq!(result.limited_by, Limit::Power);
    (result.condenser_heat_flow_w / result.electric_power_w, result.discharge_temperature_k - 273.15)
}

/// A compressor with a poor motor heats more, and its gas is hotter, with four fifths of the loss in the gas.
#[test]
fn most_of_the_default_compressor_s_loss_in_the_gas_raises_heat_and_discharge_temperature() {
    for (hot_degc, cold_degc) in [(45.0, 0.0), (66.0, -5.0)] {
        let ((cop, degc), (gas_cop, gas_degc)) = (
            default_heat_pump(0.0, hot_degc, cold_degc, 1000.0),
            default_heat_pump(0.8, hot_degc, cold_degc, 1000.0),
        );
        println!("{hot_degc}/{cold_degc}: {cop:.2} {degc:.1} degC, {gas_cop:.2} {gas_degc:.1} degC");
        // Not quite 0.8 of the loss of 0.2936 of the power: the condenser works a little hotter for it.
        let gained = (gas_cop - cop) / (0.8 * (1.0 - POOR_MOTOR_EFFICIENCY));
        assert!((0.9..1.0).contains(&gained), "{cop} {gas_cop}");
        assert!((14.0..31.0).contains(&(gas_degc - degc)), "{degc} {gas_degc}");
    }
}

fn settling() -> RefrigerationCycle {
    let mut parameters = parameters();
    parameters.compressor.settling_time_s = 30.0;
    let table = hp_plant::media::refrigerant::RefrigerantTable::load("R134a").expect("built in");
    RefrigerationCycle::new(parameters, table).expect("sound")
}

/// Heat of each second of a demand.
fn heats_w(
    cycle: &RefrigerationCycle,
    state: &mut RefrigerationState,
    demand_w: f64,
    seconds: usize,
) -> Vec<f64> {
    let b = boundary(45.0, 0.0, 900.0, 800.0);
    let step = |_| {
        let result = cycle.step(state, &b, &allowed(demand_w, true), 1.0);
        let balance_w = result.electric_power_w + result.evaporator_heat_flow_w
            - result.condenser_heat_flow_w
            - result.loss_to_ambient_w;
        assert!(balance_w.abs() < 1e-6, "{result:?}");
        result.condenser_heat_flow_w
    };
    (0..seconds).map(step).collect()
}

/// Power comes in with the lag itself; the heat is a little ahead, as part load is more efficient.
#[test]
fn after_a_start_the_heat_comes_in_with_a_first_order_lag() {
    for demand_w in [1000.0, 1500.0, 2500.0] {
        let mut state = RefrigerationState::parked();
        let heats_w = heats_w(&settling(), &mut state, demand_w, 400);
        let steady_w = heats_w[399];
        for (time_s, expected) in [(30, 0.632), (60, 0.865), (90, 0.950)] {
            let share = heats_w[time_s - 1] / steady_w;
            let ahead = share - expected;
            assert!((-0.01..0.1).contains(&ahead), "{demand_w} W after {time_s} s: {share}");
        }
        assert!(heats_w.windows(2).all(|pair| pair[1] > pair[0] - 1e-6));
    }
}

#[test]
fn the_longer_it_rested_the_lower_it_starts() {
    let cycle = settling();
    let restarted = |rest_s: usize| {
        let mut state = RefrigerationState::parked();
        let _ = heats_w(&cycle, &mut state, 1500.0, 400);
        let rest = heats_w(&cycle, &mut state, 0.0, rest_s);
        assert_eq!(rest[rest_s - 1], 0.0);
        heats_w(&cycle, &mut state, 1500.0, 20)[19]
    };
    let (soon_w, later_w, long_w) = (restarted(60), restarted(180), restarted(3000));
    let cold_w = heats_w(&cycle, &mut RefrigerationState::parked(), 1500.0, 20)[19];
    assert!(soon_w > later_w + 100.0 && later_w > long_w + 100.0, "{soon_w} {later_w} {long_w}");
    assert!((long_w - cold_w).abs() < 1.0, "{long_w} {cold_w}");
}

/// A demand below what the lowest speed takes keeps it off or stops it as it does a settled machine.
#[test]
fn a_demand_below_the_lowest_speed_stops_a_machine_that_is_not_settled() {
    let mut state = RefrigerationState::parked();
    let cycle = settling();
    assert!(heats_w(&cycle, &mut state, 1500.0, 35)[34] > 0.0);
    assert_eq!(heats_w(&cycle, &mut state, 60.0, 1)[0], 0.0);
    assert!(state.compressor.settled_share > 0.5);
    let mut state = RefrigerationState::parked();
    assert!(heats_w(&cycle, &mut state, 60.0, 5).iter().all(|&heat_w| heat_w == 0.0));
}
