//! Sensible heat store, the paper's thermal battery: a mass that loops charge and empty.

use crate::parameters;

parameters! {
    /// Sensible heat store.
    pub struct StoreParameters {
        /// Heat capacity [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 10000000.0,
        /// Coolant conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
        /// Loss conductance to ambient [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 50.0,
    }
}
