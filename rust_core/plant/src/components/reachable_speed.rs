//! How fast a vehicle can be at the end of a step: what motor and battery give decides, not the cycle.

use super::powertrain::Powertrain;

/// Halvings of the range that the speed is sought in: 1e-13 of the speed asked for.
const HALVINGS: u32 = 44;

/// What driving may take during a step.
#[derive(Debug, Clone, Copy)]
pub struct TractionSupply {
    /// Electrical power that the battery can give to the motor; none where the other loads need more than it has [W].
    pub most_w: f64,
    /// Electrical power that battery and loads can take back [W].
    pub recovery_w: f64,
}

/// Highest speed at the end of a step, at most `wanted_m_s`, that motor and supply allow.
///
/// `attempt` gives wheel power and powertrain for an end speed; the power needed rises with that speed, which is therefore
/// found by halving, with the same bits everywhere. Where the battery cannot even turn the motor the vehicle coasts.
#[must_use]
pub fn reachable_speed_m_s<'a>(
    wanted_m_s: f64,
    supply: TractionSupply,
    attempt: impl Fn(f64) -> (f64, Powertrain<'a>),
) -> f64 {
    let possible = |end_m_s: f64| {
        let (wheel_w, powertrain) = attempt(end_m_s);
        if wheel_w >= 0.0 {
            let flow = powertrain.drive(wheel_w);
            flow.electrical_power_w <= supply.most_w && powertrain.within_motor_limits(wheel_w, &flow)
        } else {
            powertrain.brake(-wheel_w, supply.recovery_w).electrical_power_w <= supply.most_w
        }
    };
    if possible(0.0) {
        highest(wanted_m_s, possible)
    } else {
        highest(wanted_m_s, |end_m_s| attempt(end_m_s).0 <= 0.0)
    }
}

/// Highest value up to `above` for which something holds that holds from 0 up to a limit; 0 where it never does.
fn highest(above: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, above);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::body::{BodyParameters, Road, RoadLoad};
    use crate::config::vehicle::VehicleParameters;
    use crate::media::air;
    use proptest::prelude::*;

    fn attempt(vehicle: &VehicleParameters, start_m_s: f64, end_m_s: f64) -> (f64, Powertrain<'_>) {
        let air = air::at_temperature(293.15);
        let road: RoadLoad =
            BodyParameters::road_load(&vehicle.body, start_m_s, end_m_s, 1.0, &Road::level(&air));
        let powertrain = Powertrain {
            motor: &vehicle.motor,
            transmission: &vehicle.transmission,
            regeneration: &vehicle.regeneration,
            speed_m_s: 0.5 * (start_m_s + end_m_s),
            spin_loss_w: 30.0 * 0.5 * (start_m_s + end_m_s),
            motor_share: 1.0,
        };
        (road.wheel_power_w(), powertrain)
    }

    fn loss_free() -> VehicleParameters {
        let mut vehicle = VehicleParameters::load("jeffs2019", &[]).expect("built in");
        (vehicle.motor.constant_loss_w, vehicle.motor.speed_loss_w_s_m) = (0.0, 0.0);
        (vehicle.motor.proportional_loss, vehicle.motor.quadratic_loss_per_w) = (0.0, 0.0);
        vehicle.transmission.mesh_loss_share = 0.0;
        (vehicle.body.drag_area_m2, vehicle.body.rolling_resistance_coefficient) = (0.1, 0.001);
        vehicle
    }

    /// By hand: without losses, drag and rolling all power becomes kinetic energy, a constant force momentum.
    #[test]
    fn power_becomes_kinetic_energy_and_force_momentum() {
        let mut vehicle = loss_free();
        (vehicle.body.drag_area_m2, vehicle.body.rolling_resistance_coefficient) = (0.0, 0.0);
        let inertia_kg = vehicle.body.mass_kg * (1.0 + vehicle.body.rotating_mass_share);
        let no_spin = |end_m_s: f64| {
            let (wheel_w, powertrain) = attempt(&vehicle, 10.0, end_m_s);
            (wheel_w, Powertrain { spin_loss_w: 0.0, ..powertrain })
        };
        let reached =
            |most_w: f64| reachable_speed_m_s(40.0, TractionSupply { most_w, recovery_w: 0.0 }, no_spin);
        for most_w in [1e3, 2e4, 8e4] {
            let expected = f64::sqrt(100.0 + 2.0 * most_w / inertia_kg);
            assert!((reached(most_w) - expected).abs() < 1e-9, "{most_w}");
        }
        let by_force = 10.0 + vehicle.motor.maximum_tractive_force_n / inertia_kg;
        assert!((reached(1e9) - by_force).abs() < 1e-9, "{} {by_force}", reached(1e9));
    }

    proptest! {
        #[test]
        fn what_is_reached_is_within_all_limits_and_a_little_more_is_not(
            start in 0.0..40.0_f64, more in 0.0..20.0_f64, most_w in 0.0..2e5_f64,
        ) {
            let vehicle = VehicleParameters::load("jeffs2019", &[]).expect("built in");
            let supply = TractionSupply { most_w, recovery_w: 5e4 };
            let reached = reachable_speed_m_s(start + more, supply, |end| attempt(&vehicle, start, end));
            let fits = |end: f64| {
                let (wheel_w, powertrain) = attempt(&vehicle, start, end);
                let flow =
                    if wheel_w >= 0.0 { powertrain.drive(wheel_w) } else { powertrain.brake(-wheel_w, 5e4) };
                flow.electrical_power_w <= most_w
                    && (wheel_w < 0.0 || powertrain.within_motor_limits(wheel_w, &flow))
            };
            prop_assert!(reached <= start + more);
            prop_assert!(fits(reached) || !fits(0.0));
            prop_assert!(reached > start + more - 1e-9 || !fits(reached + 1e-6));
        }
    }
}
