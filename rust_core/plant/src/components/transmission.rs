//! Transmission and driveline.

use crate::config::powertrain::TransmissionParameters;
use crate::numerics::elementary;

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
