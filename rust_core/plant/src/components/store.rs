//! Sensible heat store, the paper's thermal battery: a mass that loops charge and empty.

use super::thermal_mass::{self, ThermalMass};
use crate::architecture::kind::{ComponentKind, Role};
use crate::parameters;

/// What an architecture has to know of stores.
pub const KIND: ComponentKind = ComponentKind {
    word: "store",
    role: Some(Role::Store),
    read: Some(thermal_mass::read::<StoreParameters>),
    ..ComponentKind::MASS
};

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

impl From<StoreParameters> for ThermalMass {
    fn from(store: StoreParameters) -> Self {
        let StoreParameters { heat_capacity_j_k, coolant_ua_w_k, ambient_conductance_w_k } = store;
        Self { heat_capacity_j_k, coolant_ua_w_k, ambient_conductance_w_k }
    }
}
