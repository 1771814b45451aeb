//! Front-end exchanger: heat source in the chiller loop, radiator in the HTC.

use crate::config::coolant::AmbientExchangerParameters;

impl AmbientExchangerParameters {
    /// Fan power while connected; it fades out linearly as ram air takes over [W].
    #[must_use]
    pub fn fan_power_w(&self, speed_m_s: f64) -> f64 {
        self.fan_power_w * (1.0 - speed_m_s / self.fan_off_speed_m_s).max(0.0)
    }
}
