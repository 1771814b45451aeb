//! From wheel power to electrical power and back: transmission and motor in series.

use super::motor::MotorParameters;
use super::transmission::TransmissionParameters;
use crate::parameters;

parameters! {
    /// Regenerative braking at the wheels; the battery's charge limit comes on top.
    pub struct RegenerationParameters {
        /// Largest share of the braking power that the motor takes [-].
        maximum_share: f64 = 0.0 .. 1.0,
        /// Largest braking power of the motor, at the wheels [W].
        maximum_wheel_power_w: f64 = 0.0 .. 500000.0,
        /// Speed below which recuperation fades linearly to zero [m/s].
        fade_speed_m_s: f64 = 0.1 .. 10.0,
    }
}

/// Power flow through the powertrain during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PowertrainFlow {
    /// Electrical power drawn; negative while recuperating [W].
    pub electrical_power_w: f64,
    /// Heat of motor and inverter [W].
    pub motor_loss_w: f64,
    /// Heat of the transmission [W].
    pub transmission_loss_w: f64,
    /// Braking power of the friction brakes [W].
    pub friction_brake_power_w: f64,
}

/// Motor, transmission and recuperation strategy at one moment.
#[derive(Debug, Clone, Copy)]
pub struct Powertrain<'a> {
    /// Motor and inverter.
    pub motor: &'a MotorParameters,
    /// Transmission.
    pub transmission: &'a TransmissionParameters,
    /// Recuperation strategy.
    pub regeneration: &'a RegenerationParameters,
    /// Mean speed of the step [m/s].
    pub speed_m_s: f64,
    /// Spin loss of the transmission [W].
    pub spin_loss_w: f64,
    /// Share of its largest force and power that the motor's temperature leaves [-].
    pub motor_share: f64,
}

impl Powertrain<'_> {
    /// Drives the wheels with `wheel_power_w >= 0`.
    #[must_use]
    pub fn drive(&self, wheel_power_w: f64) -> PowertrainFlow {
        let mesh_loss_w = self.transmission.mesh_loss_share * wheel_power_w;
        let shaft_w = wheel_power_w + mesh_loss_w + self.spin_loss_w;
        let motor_loss_w = self.motor.loss_w(self.speed_m_s, shaft_w);
        PowertrainFlow {
            electrical_power_w: shaft_w + motor_loss_w,
            motor_loss_w,
            transmission_loss_w: mesh_loss_w + self.spin_loss_w,
            friction_brake_power_w: 0.0,
        }
    }

    /// Whether the motor can deliver what driving the wheels with a power takes.
    #[must_use]
    #[inline]
    pub fn within_motor_limits(&self, wheel_power_w: f64, flow: &PowertrainFlow) -> bool {
        wheel_power_w <= self.largest_force_w()
            && wheel_power_w + flow.transmission_loss_w <= self.largest_shaft_power_w()
    }

    /// Wheel power at the motor's largest force [W].
    fn largest_force_w(&self) -> f64 {
        self.motor_share * self.motor.maximum_tractive_force_n * self.speed_m_s
    }

    fn largest_shaft_power_w(&self) -> f64 {
        self.motor_share * self.motor.maximum_mechanical_power_w
    }

    /// Brakes with `braking_power_w >= 0` at the wheels and recuperates at most `recovery_limit_w` (>= 0).
    ///
    /// What motor and battery cannot take goes to the friction brakes.
    #[must_use]
    pub fn brake(&self, braking_power_w: f64, recovery_limit_w: f64) -> PowertrainFlow {
        let fade = (self.speed_m_s / self.regeneration.fade_speed_m_s).min(1.0);
        let share = self.regeneration.maximum_share;
        let available_w = (braking_power_w * share).min(self.regeneration.maximum_wheel_power_w) * fade;
        let through = 1.0 - self.transmission.mesh_loss_share;
        let available_w = available_w
            .min(self.largest_force_w())
            .min((self.largest_shaft_power_w() + self.spin_loss_w) / through);
        let mut recuperated_w = available_w;
        let mut shaft_w = available_w * through - self.spin_loss_w;
        if shaft_w - self.motor.loss_w(self.speed_m_s, shaft_w) > recovery_limit_w {
            shaft_w = self.motor.shaft_power_for_recovery_w(self.speed_m_s, recovery_limit_w);
            recuperated_w = (shaft_w + self.spin_loss_w) / through;
        }
        let motor_loss_w = self.motor.loss_w(self.speed_m_s, shaft_w);
        PowertrainFlow {
            electrical_power_w: motor_loss_w - shaft_w,
            motor_loss_w,
            transmission_loss_w: recuperated_w * self.transmission.mesh_loss_share + self.spin_loss_w,
            friction_brake_power_w: braking_power_w - recuperated_w,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Celsius;
    use proptest::prelude::*;

    fn with_powertrain<T>(speed_m_s: f64, spin_loss_w: f64, test: impl Fn(Powertrain<'_>) -> T) -> T {
        let motor = MotorParameters {
            maximum_tractive_force_n: 6e3,
            maximum_mechanical_power_w: 8e4,
            derating_start_degc: Celsius(110.0),
            derating_end_degc: Celsius(150.0),
            constant_loss_w: 150.0,
            speed_loss_w_s_m: 8.0,
            proportional_loss: 0.05,
            quadratic_loss_per_w: 6e-7,
            heat_capacity_j_k: 3e4,
            ambient_conductance_w_k: 5.0,
            ambient_conductance_per_speed_w_s_k_m: 0.3,
            coolant_ua_w_k: 100.0,
        };
        let transmission = TransmissionParameters {
            mesh_loss_share: 0.018,
            spin_loss_force_n: 26.0,
            spin_loss_reference_degc: Celsius(40.0),
            viscosity_temperature_k: 28.0,
            heat_capacity_j_k: 25e3,
            ambient_conductance_w_k: 6.0,
            ambient_conductance_per_speed_w_s_k_m: 0.4,
            coolant_ua_w_k: 90.0,
        };
        let regeneration =
            RegenerationParameters { maximum_share: 0.9, maximum_wheel_power_w: 7e4, fade_speed_m_s: 2.0 };
        test(Powertrain {
            motor: &motor,
            transmission: &transmission,
            regeneration: &regeneration,
            speed_m_s,
            spin_loss_w,
            motor_share: 0.8,
        })
    }

    proptest! {
        #[test]
        fn driving_power_ends_at_the_wheels_or_as_heat(
            wheel in 0.0..1e5_f64, speed in 0.0..40.0_f64, spin in 0.0..3000.0_f64,
        ) {
            let flow = with_powertrain(speed, spin, |powertrain| powertrain.drive(wheel));
            let out = wheel + flow.motor_loss_w + flow.transmission_loss_w;
            prop_assert!((flow.electrical_power_w - out).abs() < 1e-8 * (1.0 + out));
        }

        #[test]
        fn braking_power_is_conserved_and_recovery_stays_within_its_limit(
            braking in 0.0..2e5_f64, limit in 0.0..5e4_f64, speed in 0.0..40.0_f64, spin in 0.0..3000.0_f64,
        ) {
            let flow = with_powertrain(speed, spin, |powertrain| powertrain.brake(braking, limit));
            let sum = flow.friction_brake_power_w + flow.motor_loss_w + flow.transmission_loss_w
                - flow.electrical_power_w;
            prop_assert!((braking - sum).abs() < 1e-7 * (1.0 + braking));
            prop_assert!(-flow.electrical_power_w <= limit + 1e-7);
            prop_assert!(flow.friction_brake_power_w >= -1e-7);
        }

        #[test]
        fn the_motor_brakes_with_at_most_its_force_and_power(
            braking in 0.0..4e5_f64, speed in 0.0..40.0_f64, spin in 0.0..3000.0_f64,
        ) {
            let flow = with_powertrain(speed, spin, |powertrain| powertrain.brake(braking, f64::INFINITY));
            let by_motor_w = braking - flow.friction_brake_power_w;
            let shaft_w = flow.motor_loss_w - flow.electrical_power_w;
            prop_assert!(by_motor_w <= 0.8 * 6e3 * speed + 1e-7);
            prop_assert!(shaft_w <= 0.8 * 8e4 + 1e-7);
        }
    }
}
