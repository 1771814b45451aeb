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
        /// Rise of the oil temperature that divides the spin loss by e [K].
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
    /// Load-independent loss of bearings, seals and churning [W].
    ///
    /// It falls exponentially with the oil temperature, more slowly than the viscosity does: bearings lose in proportion to
    /// its power of 2/3, churning and seals depend on it less (scripts/check_gearbox_losses.py adds them up).
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::ZERO_CELSIUS_K;

    /// Sum of the parts of a single-speed reducer at 60 km/h with a fluid of 24 mm2/s at 40 degC, 5.2 at 100 degC, as a
    /// force at the wheels [N]: scripts/check_gearbox_losses.py.
    #[test]
    fn spin_loss_is_that_of_bearings_seals_and_churning_within_a_third() {
        let transmission = TransmissionParameters {
            spin_loss_force_n: 11.0,
            spin_loss_reference_degc: Celsius(40.0),
            viscosity_temperature_k: 40.0,
            ..Default::default()
        };
        for (degc, force_n) in
            [(-20.0, 58.3), (-10.0, 37.9), (0.0, 27.3), (20.0, 16.5), (40.0, 11.3), (60.0, 8.1), (80.0, 5.7)]
        {
            let found_n = transmission.spin_loss_w(degc + ZERO_CELSIUS_K, 20.0) / 20.0;
            assert!((found_n / force_n - 1.0).abs() < 0.33, "{found_n} {force_n} N at {degc} degC");
        }
    }
}
