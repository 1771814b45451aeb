//! Motor and inverter, treated as one.

use crate::architecture::flows::Flow;
use crate::architecture::kind::{Bounds, ComponentKind, Role};
use crate::architecture::ranks;
use crate::config::Celsius;
use crate::parameters;

/// What an architecture has to know of motor and inverter.
pub const KIND: ComponentKind = ComponentKind {
    word: "motor",
    role: Some(Role::HeatSource),
    loss: Some(Flow::MOTOR_LOSS),
    temperature: Bounds::new(-40.0, 120.0, ranks::MOTOR),
    branch_heat_flow: Some(Bounds::branch(10_000.0, 3)),
    ..ComponentKind::POWERTRAIN
};

/// Below this speed the vehicle counts as standing [m/s].
pub const STANDSTILL_SPEED_M_S: f64 = 0.05;

parameters! {
    /// Motor and inverter: what they can deliver, losses, one thermal mass.
    pub struct MotorParameters {
        /// Largest force at the wheels, driving or recuperating: the largest torque times the gear ratio over the tyre's
        /// radius [N].
        maximum_tractive_force_n: f64 = 100.0 .. 200000.0,
        /// Largest mechanical power at the shaft, driving or recuperating [W].
        maximum_mechanical_power_w: f64 = 1000.0 .. 1000000.0,
        /// Temperature up to which force and power are available in full [degC].
        derating_start_degc: Celsius = 0.0 .. 300.0,
        /// Temperature from which on there is none; linear between [degC].
        derating_end_degc: Celsius = 0.0 .. 300.0,
        /// Loss whenever the vehicle moves [W].
        constant_loss_w: f64 = 0.0 .. 5000.0,
        /// Loss per vehicle speed [W/(m/s)].
        speed_loss_w_s_m: f64 = 0.0 .. 500.0,
        /// Loss per shaft power [-].
        proportional_loss: f64 = 0.0 .. 0.5,
        /// Loss per squared shaft power [1/W].
        quadratic_loss_per_w: f64 = 0.0 .. 0.00001,
        /// Heat capacity of motor and inverter [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 1000000.0,
        /// Conductance to ambient at standstill [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 200.0,
        /// Its increase with vehicle speed [W/K per m/s].
        ambient_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Coolant jacket conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
    }
}

impl MotorParameters {
    /// Share of the largest force and power that a temperature of motor and inverter leaves [-].
    #[must_use]
    pub fn available_share(&self, temperature_k: f64) -> f64 {
        let (start_k, end_k) = (self.derating_start_degc.kelvin(), self.derating_end_degc.kelvin());
        if temperature_k <= start_k {
            return 1.0;
        }
        ((end_k - temperature_k) / (end_k - start_k)).max(0.0)
    }

    /// Loss of motor and inverter at a shaft power [W].
    #[must_use]
    pub fn loss_w(&self, speed_m_s: f64, shaft_power_w: f64) -> f64 {
        let load = shaft_power_w.abs();
        self.no_load_loss_w(speed_m_s)
            + self.proportional_loss * load
            + self.quadratic_loss_per_w * load * load
    }

    /// Shaft power into the machine that yields a recovered electrical power [W].
    ///
    /// Inverse of `shaft - loss(shaft)` on its rising branch; at its maximum where more is asked for.
    #[must_use]
    pub fn shaft_power_for_recovery_w(&self, speed_m_s: f64, recovered_power_w: f64) -> f64 {
        let slope = 1.0 - self.proportional_loss;
        let target = recovered_power_w + self.no_load_loss_w(speed_m_s);
        let discriminant = slope * slope - 4.0 * self.quadratic_loss_per_w * target;
        2.0 * target / (slope + discriminant.max(0.0).sqrt())
    }

    /// Conductance to ambient [W/K].
    #[must_use]
    pub fn ambient_conductance_w_k(&self, speed_m_s: f64) -> f64 {
        self.ambient_conductance_w_k + self.ambient_conductance_per_speed_w_s_k_m * speed_m_s
    }

    fn no_load_loss_w(&self, speed_m_s: f64) -> f64 {
        let constant = if speed_m_s > STANDSTILL_SPEED_M_S { self.constant_loss_w } else { 0.0 };
        constant + self.speed_loss_w_s_m * speed_m_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derating_is_linear_between_its_two_temperatures() {
        let motor = MotorParameters {
            derating_start_degc: Celsius(110.0),
            derating_end_degc: Celsius(150.0),
            ..MotorParameters::default()
        };
        for (degc, share) in
            [(-40.0, 1.0), (110.0, 1.0), (120.0, 0.75), (140.0, 0.25), (150.0, 0.0), (200.0, 0.0)]
        {
            let found = motor.available_share(Celsius(degc).kelvin());
            assert!((found - share).abs() < 1e-12, "{degc} degC: {found}");
        }
    }
}
