//! Motor and inverter, treated as one.

use crate::architecture::flows::Flow;
use crate::architecture::kind::{Bounds, ComponentKind, Role};
use crate::architecture::ranks;
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
    /// Motor and inverter: losses, one thermal mass.
    pub struct MotorParameters {
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
