//! Air that several front-end exchangers share: each gets it as the one before left it.

use crate::parameters;

parameters! {
    /// Air through the front end.
    pub struct AirStreamParameters {
        /// Capacity rate at standstill, fan on [W/K].
        capacity_rate_w_k: f64 = 10.0 .. 10000.0,
        /// Its increase with vehicle speed [W s/(K m)].
        capacity_rate_per_speed_w_s_k_m: f64 = 0.0 .. 1000.0,
    }
}

impl AirStreamParameters {
    /// Temperature rise of the air per watt that it takes up [K/W].
    #[must_use]
    pub fn rise_k_w(&self, speed_m_s: f64) -> f64 {
        (self.capacity_rate_w_k + self.capacity_rate_per_speed_w_s_k_m * speed_m_s).recip()
    }
}
