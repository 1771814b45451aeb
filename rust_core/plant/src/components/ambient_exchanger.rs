//! Front-end exchanger: one object for both directions, heat source in the chiller loop, radiator in the HTC; refrigerant may
//! meet the air in it too.

use crate::architecture::builder::Builder;
use crate::architecture::declaration::MemberKind;
use crate::architecture::kind::{Bounds, ComponentKind, Meets, Role};
use crate::architecture::layout::FrontEndLayout;
use crate::components::frost::{FrostEffect, FrostParameters};
use crate::components::heat_exchanger::{counterflow_conductance_w_k, inlet_conductance_w_k};
use crate::config::Celsius;
use crate::media::air::SPECIFIC_HEAT_J_KG_K;
use crate::numerics::elementary;
use crate::parameters;

/// What an architecture has to know of front-end exchangers.
pub const KIND: ComponentKind = ComponentKind {
    word: "front-end",
    meets: Meets::AmbientAir,
    role: Some(Role::FrontEnd),
    branch_heat_flow: Some(Bounds::branch(30_000.0, 2)),
    add_nodes: add_place,
    ..ComponentKind::MASS
};

/// Its place in the air: alone, or behind another one. It has no node.
fn add_place(to: &mut Builder<'_>, member: usize) {
    let declaration = to.declaration;
    let name = &declaration.members[member].name;
    let stream = declaration.air_streams.iter().find(|stream| stream.through.contains(name));
    let behind = stream.and_then(|stream| {
        let place = stream.through.iter().position(|other| other == name)?;
        let before = declaration.member(&stream.through[place.checked_sub(1)?])?;
        declaration.of_kind(MemberKind::FrontEnd).position(|other| other == before)
    });
    let stream = stream.map(|stream| stream.name.clone());
    to.layout.front_ends.push(FrontEndLayout { member, stream, behind });
}

parameters! {
    /// Front-end exchanger with ambient air, the same in both directions: heat source, or radiator or condenser.
    pub struct AmbientExchangerParameters {
        /// Conductance at an air flow of 1 kg/s; it goes with the flow to the power of 0.6 [W/K].
        ua_w_k: f64 = 10.0 .. 10000.0,
        /// Ambient temperature at or below which it is no heat source (frost interlock; paper: -10 degC) [degC].
        frost_interlock_degc: Celsius = -60.0 .. 20.0,
        ;
        /// Frost on it.
        frost: FrostParameters,
    }
}

/// Exponent of the air flow in the conductance: between 0.5 of a laminar boundary layer and 0.8 of turbulent channels; louvred
/// fins have 0.5..0.6 (Kays and London, Compact Heat Exchangers; Chang and Wang 1997, doi 10.1016/0017-9310(96)00116-0).
const AIR_FLOW_EXPONENT: f64 = 0.6;

impl AmbientExchangerParameters {
    /// Whether frost keeps it from being a heat source at an ambient temperature [K].
    #[must_use]
    #[inline(always)]
    pub fn is_locked(&self, ambient_k: f64) -> bool {
        ambient_k <= self.frost_interlock_degc.kelvin()
    }

    /// Conductance at an air flow in kg/s [W/K].
    #[must_use]
    #[inline]
    pub fn conductance_w_k(&self, air_flow_kg_s: f64) -> f64 {
        self.ua_w_k * elementary::power(air_flow_kg_s, AIR_FLOW_EXPONENT)
    }
}

/// Air and conductance of one front-end exchanger.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrontAir {
    /// Capacity rate of the air [W/K].
    pub rate_w_k: f64,
    /// Conductance at that flow [W/K].
    pub ua_w_k: f64,
    /// Share of that as heat source that defrosting leaves in the mean [-]; 1 where frost is followed instead.
    pub source_share: f64,
}

impl FrontAir {
    /// Of an exchanger with frost, if there is any, at an air flow.
    #[must_use]
    #[inline(always)]
    pub fn of(own: &AmbientExchangerParameters, flow_kg_s: f64, frost: &FrostEffect) -> Self {
        let air_w_k = own.conductance_w_k(flow_kg_s) * frost.air_share;
        let ua_w_k = air_w_k / (1.0 + air_w_k * frost.layer_k_w);
        Self { rate_w_k: flow_kg_s * SPECIFIC_HEAT_J_KG_K, ua_w_k, source_share: 1.0 }
    }

    /// Conductance between the inlets of air and coolant [W/K].
    #[must_use]
    #[inline(always)]
    pub fn to_coolant_w_k(&self, coolant_w_k: f64) -> f64 {
        counterflow_conductance_w_k(coolant_w_k, self.rate_w_k, self.ua_w_k)
    }

    /// Conductance between the air's inlet and a refrigerant at one temperature [W/K].
    #[must_use]
    #[inline(always)]
    pub fn to_refrigerant_w_k(&self) -> f64 {
        inlet_conductance_w_k(self.rate_w_k, self.ua_w_k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_air_passes_half_as_much_heat_again() {
        let own = AmbientExchangerParameters {
            ua_w_k: 900.0,
            frost_interlock_degc: Celsius(-10.0),
            ..Default::default()
        };
        assert!((own.conductance_w_k(1.0) - 900.0).abs() < 1e-9);
        assert!((own.conductance_w_k(2.0) / own.conductance_w_k(1.0) - 1.515_717).abs() < 1e-6);
    }
}
