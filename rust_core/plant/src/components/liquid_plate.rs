//! Liquid-to-liquid plate between two coolant loops, in counterflow.

use super::heat_exchanger::counterflow_conductance_w_k;
use crate::architecture::kind::{Bounds, ComponentKind, Key, Meets, Role};
use crate::parameters;

/// What an architecture has to know of plates.
pub const KIND: ComponentKind = ComponentKind {
    word: "plate",
    meets: Meets::OtherLoop,
    role: Some(Role::Plate),
    keys: &[Key::From],
    branch_heat_flow: Some(Bounds::branch(10_000.0, 5)),
    ..ComponentKind::MASS
};

parameters! {
    /// Plate between two loops.
    pub struct LiquidPlateParameters {
        /// Conductance between the coolants [W/K].
        ua_w_k: f64 = 1.0 .. 10000.0,
    }
}

impl LiquidPlateParameters {
    /// Largest conductance between its two inlets for the capacity rates on both sides [W/K].
    #[must_use]
    pub fn conductance_w_k(&self, first_rate_w_k: f64, second_rate_w_k: f64) -> f64 {
        counterflow_conductance_w_k(first_rate_w_k, second_rate_w_k, self.ua_w_k)
    }
}
