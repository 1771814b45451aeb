//! DC/DC converter and charger: a mass with a heat sink whose loss to ambient is small.

use super::thermal_mass::{self, ThermalMass};
use crate::architecture::kind::{Bounds, ComponentKind, Role};
use crate::architecture::ranks;
use crate::parameters;

/// What an architecture has to know of converters.
pub const KIND: ComponentKind = ComponentKind {
    word: "converter",
    role: Some(Role::HeatSource),
    temperature: Bounds::new(-40.0, 110.0, ranks::STORE),
    branch_heat_flow: Some(Bounds::branch(5_000.0, 6)),
    read: Some(thermal_mass::read::<ConverterParameters>),
    ..ComponentKind::MASS
};

parameters! {
    /// DC/DC converter and charger.
    pub struct ConverterParameters {
        /// Mass of metal [kg].
        mass_kg: f64 = 0.5 .. 50.0,
        /// Mean specific heat of it [J/(kg K)].
        specific_heat_j_kg_k: f64 = 300.0 .. 1000.0,
        /// Coolant conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 1000.0,
    }
}

impl From<ConverterParameters> for ThermalMass {
    fn from(converter: ConverterParameters) -> Self {
        Self {
            heat_capacity_j_k: converter.mass_kg * converter.specific_heat_j_kg_k,
            coolant_ua_w_k: converter.coolant_ua_w_k,
            ambient_conductance_w_k: 0.0,
        }
    }
}
