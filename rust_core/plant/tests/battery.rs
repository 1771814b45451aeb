//! Battery and tyres in the cold: resistance, rate limits, voltages.

use hp_plant::components::battery::{Battery, BatteryState};
use hp_plant::config::Celsius;
use hp_plant::config::library::Override;
use hp_plant::config::vehicle::VehicleParameters;
use hp_plant::plant::Plant;
use proptest::prelude::*;

/// The default vehicle with published values of cold cells, tyres and oil.
const COLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cold.toml");

fn vehicle(name: &str, changes: &[&str]) -> VehicleParameters {
    let changes: Vec<Override> =
        changes.iter().map(|text| Override::parse(text).expect("an assignment")).collect();
    VehicleParameters::load(name, &changes).unwrap_or_else(|error| panic!("{error}"))
}

fn error_of(change: &str) -> String {
    let change = Override::parse(change).expect("an assignment");
    VehicleParameters::load(COLD, &[change]).expect_err("must be refused").to_string()
}

/// Resistance of one cell over a pulse at a constant power from rest, times its capacity [mohm Ah].
fn pulse_resistance_mohm_ah(vehicle: &VehicleParameters, degc: f64, seconds: u32) -> f64 {
    let (parameters, battery) = (&vehicle.battery, Battery::new(&vehicle.battery));
    let cells = f64::from(parameters.cells_in_series);
    let mut state = battery.rested(0.5);
    let rest_v = battery.open_circuit_voltage_v(&state);
    let power_w = 0.5 * rest_v * parameters.cell_capacity_ah * f64::from(parameters.strings_in_parallel);
    let (mut voltage_v, mut current_a) = (rest_v, 0.0);
    // Short steps: the voltage at the end of the pulse, not its mean.
    for _ in 0..seconds * 10 {
        let step = battery.during(&state, Celsius(degc).kelvin(), 0.1).draw(power_w);
        (state, voltage_v, current_a) = (step.state, step.voltage_v, step.current_a);
    }
    let open_v = battery.open_circuit_voltage_v(&state);
    let string_a = current_a / f64::from(parameters.strings_in_parallel);
    (open_v - voltage_v) / cells / string_a * 1000.0 * parameters.cell_capacity_ah
}

#[test]
fn resistance_times_capacity_is_the_same_for_all_cells_of_a_family() {
    for degc in [-20.0, 0.0, 25.0] {
        let of = |capacity: &str| {
            pulse_resistance_mohm_ah(
                &vehicle("jeffs2019", &[&format!("battery.cell_capacity_ah={capacity}")]),
                degc,
                10,
            )
        };
        let reference = of("51.24");
        for capacity in ["5.0", "40.0", "150.0"] {
            let other = of(capacity);
            assert!((other / reference - 1.0).abs() < 1e-9, "{other} {reference} mohm Ah at {capacity} Ah");
        }
    }
}

/// Kollmeyer's Panasonic 18650PF (doi 10.17632/wykht8y7tg) and PyBaMM's Ecker2015, relative to 25 degC: 2.1 and 3.4 at
/// 0 degC, 5.8 and 6.8 at -20 degC. Absolute, at 25 degC: 108 and 42 mohm Ah.
#[test]
fn resistance_rises_with_cold_between_a_measured_and_a_modelled_cell() {
    let cold = vehicle(COLD, &[]);
    let warm = pulse_resistance_mohm_ah(&cold, 25.0, 10);
    assert!((42.0..108.0).contains(&warm), "{warm} mohm Ah");
    for (degc, measured, modelled) in [(-20.0, 5.8, 6.8), (0.0, 2.1, 3.4), (10.0, 1.4, 2.2)] {
        let ratio = pulse_resistance_mohm_ah(&cold, degc, 10) / warm;
        assert!((measured..modelled).contains(&ratio), "{ratio} at {degc} degC");
    }
}

/// Charges with all that is allowed, one second at a time; the C-rates.
fn charged_as_allowed(battery: &Battery, state: &mut BatteryState, degc: f64, seconds: usize) -> Vec<f64> {
    let second = |_| {
        let before = battery.state_of_charge(state);
        let circuit = battery.during(state, Celsius(degc).kelvin(), 1.0);
        *state = circuit.draw(-circuit.power_limits().charge_w).state;
        (battery.state_of_charge(state) - before) * 3600.0
    };
    (0..seconds).map(second).collect()
}

/// The table (scripts/make_charge_limit_table.py) at 0 degC and half charge: 0.699/h for 10 s, 0.482/h for long.
#[test]
fn a_pulse_is_allowed_for_10_s_and_falls_to_the_continuous_rate_until_a_rest() {
    let cold = vehicle(COLD, &[]);
    let (battery, scale) = (Battery::new(&cold.battery), cold.battery.charge_limit.rate_scale);
    let mut state = battery.rested(0.499);
    let rates = charged_as_allowed(&battery, &mut state, 0.0, 600);
    assert!(rates[..10].iter().all(|rate| (rate / (0.699 * scale) - 1.0).abs() < 0.01), "{:?}", &rates[..10]);
    assert!(rates[9..].windows(2).all(|pair| pair[1] < pair[0]), "allowed rates fall");
    let (soc, last) = (battery.state_of_charge(&state), rates[599]);
    let continuous = scale * (0.482 + (soc - 0.5) / 0.2 * (0.289 - 0.482));
    assert!((last / continuous - 1.0).abs() < 0.01, "{last} {continuous}");
    // A discharge relaxes, and so does a rest.
    for _ in 0..300 {
        state = battery.during(&state, Celsius(0.0).kelvin(), 1.0).draw(0.0).state;
    }
    let pulse = scale * (0.699 + (soc - 0.5) / 0.2 * (0.383 - 0.699));
    let again = charged_as_allowed(&battery, &mut state, 0.0, 1)[0];
    assert!((again / pulse - 1.0).abs() < 0.01, "{again} {pulse}");
}

#[test]
fn the_first_row_and_a_resting_battery_show_the_open_circuit_voltage() {
    for (soc, cell_v) in [(1.0, 4.18), (0.5, 3.71), (0.0, 3.0)] {
        let battery = Battery::new(&vehicle("jeffs2019", &[]).battery);
        let state = battery.rested(soc);
        let terminal_v = battery.during(&state, 273.15, 1.0).draw(0.0).voltage_v;
        assert!((battery.open_circuit_voltage_v(&state) - 108.0 * cell_v).abs() < 1e-9);
        assert!((terminal_v - 108.0 * cell_v).abs() < 1e-9);
    }
}

#[test]
fn tables_that_cannot_be_are_refused_with_place_and_rule() {
    for (change, key, rule) in [
        (
            "charge_limit.pulse_rate_per_h[3][2]=0.3",
            "charge_limit.pulse_rate_per_h[3][2]",
            "colder row (0.46)",
        ),
        (
            "charge_limit.continuous_rate_per_h[3][2]=0.1",
            "charge_limit.continuous_rate_per_h[3][2]",
            "colder row",
        ),
        (
            "charge_limit.continuous_rate_per_h[7][5]=1.1",
            "charge_limit.pulse_rate_per_h[7][5]",
            "continuous rate (1.1)",
        ),
        (
            "charge_limit.continuous_rate_per_h[0][0]=0.1",
            "charge_limit.pulse_rate_per_h[0][0]",
            "times the continuous rate (0.1)",
        ),
        ("charge_limit.temperature_degc[2]=-25", "charge_limit.temperature_degc[2]", "larger"),
        ("charge_limit.temperature_degc=[-30, 0]", "charge_limit.pulse_rate_per_h", "2 rows"),
        ("charge_limit.rate_scale=-1", "charge_limit.rate_scale", "between 0 and 10"),
        ("rate_memory_s=0", "battery.rate_memory_s", "between 1 and 3600"),
        ("circuit_reference_capacity_ah=-3", "battery.circuit_reference_capacity_ah", "between"),
    ] {
        let message = error_of(&format!("battery.{change}"));
        assert!(
            message.contains("cold.toml") && message.contains(key) && message.contains(rule),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

proptest! {
    #[test]
    fn a_warmer_battery_takes_and_gives_at_least_as_much(
        a in -45.0..60.0_f64, b in -45.0..60.0_f64, soc in 0.02..0.95_f64, recent in -2.0..2.0_f64,
    ) {
        let (colder, warmer) = (a.min(b), a.max(b));
        for name in ["jeffs2019", COLD] {
            let plant = Plant::load(name, &[]).expect("loads");
            let mut state = plant.battery.rested(soc);
            state.recent_charging_per_h = recent;
            let limits = |degc: f64| plant.battery.during(&state, Celsius(degc).kelvin(), 1.0).power_limits();
            let (cold, warm) = (limits(colder), limits(warmer));
            prop_assert!(warm.discharge_w >= cold.discharge_w * (1.0 - 1e-9), "{cold:?} {warm:?}");
            // With the current held: more resistance means more power for the same charge.
            let per_current = |degc: f64, limit_w: f64| {
                let step = plant.battery.during(&state, Celsius(degc).kelvin(), 1.0).draw(-limit_w);
                -step.current_a
            };
            let (cold_a, warm_a) = (per_current(colder, cold.charge_w), per_current(warmer, warm.charge_w));
            prop_assert!(warm_a >= cold_a - 1e-6 * cold_a.abs() - 1e-9, "{cold_a} {warm_a} A");
        }
    }
}
