//! Transmission and driveline.

use crate::architecture::flows::Flow;
use crate::architecture::kind::{Bounds, ComponentKind, Role};
use crate::architecture::ranks;
use crate::config::Celsius;
use crate::numerics::elementary;
use crate::parameters;

/// What an architecture has to know of the transmission.
pub const KIND: ComponentKind = ComponentKind {
    word: "transmission",
    role: Some(Role::HeatSource),
    loss: Some(Flow::TRANSMISSION_LOSS),
    temperature: Bounds::new(-40.0, 120.0, ranks::TRANSMISSION),
    branch_heat_flow: Some(Bounds::branch(10_000.0, 4)),
    ..ComponentKind::POWERTRAIN
};

parameters! {
    /// Transmission and driveline: losses that depend on the oil temperature, one thermal mass.
    pub struct TransmissionParameters {
        /// Load-proportional (mesh) loss [-].
        mesh_loss_share: f64 = 0.0 .. 0.2,
        /// Spin-loss force at the wheels at the reference oil temperature [N].
        spin_loss_force_n: f64 = 0.0 .. 500.0,
        /// Oil temperature of that force [degC].
        spin_loss_reference_degc: Celsius = 0.0 .. 100.0,
        /// Temperature rise that divides the spin loss by e [K].
        viscosity_temperature_k: f64 = 5.0 .. 200.0,
        /// Heat capacity of housing, gears and oil [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 1000000.0,
        /// Conductance to ambient at standstill [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 200.0,
        /// Its increase with vehicle speed [W/K per m/s].
        ambient_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Oil-cooler conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
    }
}

impl TransmissionParameters {
    /// Load-independent loss: churning of oil whose viscosity falls with temperature [W].
    ///
    /// Linear in the viscosity (ISO/TR 14179-1), which is taken as exponential in the oil temperature.
    #[must_use]
    pub fn spin_loss_w(&self, oil_temperature_k: f64, speed_m_s: f64) -> f64 {
        let above = oil_temperature_k - self.spin_loss_reference_degc.kelvin();
        self.spin_loss_force_n * elementary::exp(-above / self.viscosity_temperature_k) * speed_m_s
    }

    /// Conductance to ambient [W/K].
    #[must_use]
    pub fn ambient_conductance_w_k(&self, speed_m_s: f64) -> f64 {
        self.ambient_conductance_w_k + self.ambient_conductance_per_speed_w_s_k_m * speed_m_s
    }
}
