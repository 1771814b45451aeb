//! Front-end exchanger: heat source in the chiller loop, radiator in the HTC.

use crate::architecture::builder::Builder;
use crate::architecture::declaration::MemberKind;
use crate::architecture::kind::{Bounds, ComponentKind, Meets, Role};
use crate::architecture::layout::FrontEndLayout;
use crate::config::Celsius;
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
