//! Thermal battery: a sensible heat store, in series behind the condenser in the HTC, a branch of the chiller loop.

use crate::parameters;

parameters! {
    /// Sensible heat store.
    pub struct ThermalBatteryParameters {
        /// Heat capacity [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 10000000.0,
        /// Coolant conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
        /// Loss conductance to ambient [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 50.0,
    }
}

/// Share of the condenser heat by which a thermal battery in the HTC gives less [-].
///
/// It sees coolant that is warmer than the return by `Q / C`, of which its inlet conductance `G` takes `G Q / C`.
#[must_use]
#[inline]
pub fn condenser_share(conductance_w_k: f64, htc_rate_w_k: f64) -> f64 {
    conductance_w_k / htc_rate_w_k
}
