//! Front-end exchanger: heat source in the chiller loop, radiator in the HTC.

use crate::config::Celsius;
use crate::parameters;

parameters! {
    /// Front-end exchanger with ambient air: heat source in the chiller loop, radiator in the HTC.
    pub struct AmbientExchangerParameters {
        /// Conductance as heat source at standstill, fan on [W/K].
        source_ua_w_k: f64 = 0.0 .. 5000.0,
        /// Its increase with vehicle speed [W/K per m/s].
        source_ua_per_speed_w_s_k_m: f64 = 0.0 .. 200.0,
        /// Conductance as radiator at standstill, fan on [W/K].
        radiator_ua_w_k: f64 = 0.0 .. 5000.0,
        /// Its increase with vehicle speed [W/K per m/s].
        radiator_ua_per_speed_w_s_k_m: f64 = 0.0 .. 200.0,
        /// Fan power while the exchanger is connected and the vehicle is slow [W].
        fan_power_w: f64 = 0.0 .. 2000.0,
        /// Vehicle speed at which ram air replaces the fan [m/s].
        fan_off_speed_m_s: f64 = 0.1 .. 100.0,
        /// Ambient temperature at or below which it is no heat source (frost interlock; paper: -10 degC) [degC].
        frost_interlock_degc: Celsius = -60.0 .. 20.0,
    }
}

impl AmbientExchangerParameters {
    /// Fan power while connected; it fades out linearly as ram air takes over [W].
    #[must_use]
    pub fn fan_power_w(&self, speed_m_s: f64) -> f64 {
        self.fan_power_w * (1.0 - speed_m_s / self.fan_off_speed_m_s).max(0.0)
    }
}
