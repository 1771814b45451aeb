//! Cabin: ventilation, panels and cores (paper section 2.2).

use super::cabin_air::CabinAirParameters;
use super::windscreen::WindscreenParameters;
use crate::architecture::builder::Builder;
use crate::architecture::declaration::Level;
use crate::architecture::flows::{Crossing, Flow};
use crate::architecture::kind::{Bounds, ComponentKind, Count, Key, Meets, Role};
use crate::architecture::layout::{CabinLayout, ExchangerSide, LoopLayout};
use crate::architecture::ranks;
use crate::architecture::rows::{ActuatorRow, Purpose};
use crate::architecture::wiring::{HeatSource, Law};
use crate::config::Celsius;
use crate::media::air::SPECIFIC_HEAT_J_KG_K;
use crate::numerics::graph::LinkPorts;
use crate::parameters;

/// What an architecture has to know of cabins.
pub const KIND: ComponentKind = ComponentKind {
    word: "cabin",
    count: Count::AtLeastOnce,
    meets: Meets::SupplyAir,
    role: Some(Role::Cabin),
    keys: &[Key::Comfort, Key::ExhaustRecovery],
    needs_link: false,
    temperature: Bounds::new(-40.0, 80.0, ranks::CABIN),
    branch_heat_flow: Some(Bounds::branch(10_000.0, 0)),
    add_nodes,
    add_loads,
    add_gains,
    add_loop_links,
    add_links,
    add_sources,
    add_levels,
    ..ComponentKind::MASS
};

/// Two air volumes and furnishings.
fn add_nodes(to: &mut Builder<'_>, member: usize) {
    let declared = &to.declaration.members[member];
    let prefix = to.prefix(member);
    let text = to.layout.members[member].label.clone();
    let air = to.node(declared.name.clone(), format!("{text}, large air volume"));
    let exhaust = to.node(format!("{prefix}exhaust"), format!("{text}, small exhaust volume"));
    let soft = to.node(format!("{prefix}soft_furnishings"), format!("{text}: seats, carpet"));
    let hard = to.node(format!("{prefix}hard_furnishings"), format!("{text}: dashboard, glass"));
    to.layout.members[member].node = Some(air);
    to.layout.cabins.push(CabinLayout {
        member,
        air,
        exhaust,
        soft,
        hard,
        recovery: declared.exhaust_recovery.as_ref().and_then(|name| to.declaration.circuit(name)),
        heater: None,
        cooler: None,
        blower_flow: Flow::AUXILIARY,
        solar_flow: Flow::AUXILIARY,
        solar_soft_flow: Flow::AUXILIARY,
        solar_hard_flow: Flow::AUXILIARY,
        occupants_flow: Flow::AUXILIARY,
        evaporator: None,
        latent_flow: None,
        recirculation_row: 0,
        blower_row: 0,
        windscreen_row: 0,
    });
}

fn add_loads(to: &mut Builder<'_>, member: usize) {
    let column = format!("{}blower_power_w", to.prefix(member));
    let flow = to.flow(column, "Blower; warms the cabin air.", Crossing::Inside);
    to.cabin(member).blower_flow = flow;
    to.layout.base_loads.push(flow);
}

fn add_gains(to: &mut Builder<'_>, member: usize) {
    let prefix = to.prefix(member);
    let column = format!("{prefix}solar_heat_flow_w");
    to.cabin(member).solar_flow = to.flow(column, "Solar heat into the cabin air.", Crossing::Enters);
    let column = format!("{prefix}occupant_heat_flow_w");
    to.cabin(member).occupants_flow =
        to.flow(column, "Heat of the occupants into the cabin.", Crossing::Enters);
    let column = format!("{prefix}solar_soft_furnishings_heat_flow_w");
    to.cabin(member).solar_soft_flow =
        to.flow(column, "Solar heat onto the soft furnishings.", Crossing::Enters);
    let column = format!("{prefix}solar_hard_furnishings_heat_flow_w");
    to.cabin(member).solar_hard_flow =
        to.flow(column, "Solar heat onto the hard furnishings.", Crossing::Enters);
    let place = to.cabin_place(member);
    let evaporates = |side, level| side == ExchangerSide::Cabin(place) && level == Level::Evaporating;
    let evaporator = to.layout.exchangers.iter().position(|e| evaporates(e.side, e.level));
    to.cabin(member).evaporator = evaporator;
    if to.cabin(member).cooler.is_some() || evaporator.is_some() {
        let column = format!("{prefix}latent_heat_flow_w");
        let text = "Heat of the water that condenses on the cooling core, into what cools that.";
        to.cabin(member).latent_flow = Some(to.flow(column, text, Crossing::Enters));
    }
}

/// The exhaust enters at cabin temperature and meets whichever is warmer, ambient (only heat above ambient is "exhaust
/// heat") or the supply of its loop.
fn add_loop_links(to: &mut Builder<'_>, member: usize) {
    let CabinLayout { air, exhaust, recovery, .. } = *to.cabin(member);
    let Some(circuit) = recovery else { return };
    let LoopLayout { label, supply, back, .. } = to.layout.loops[circuit].clone();
    let place = to.cabin_place(member) as u8;
    let column = format!("{}exhaust_recovery_heat_flow_w", to.prefix(member));
    let flow = to.flow(column, format!("Exhaust air to {label}."), Crossing::Inside);
    let ports = LinkPorts { loses: Some(exhaust), gains: Some(back), hot: Some(air), cold: None };
    to.link(ports, Law::RecoveryFromAmbient(place), flow);
    to.link(LinkPorts { cold: Some(supply), ..ports }, Law::RecoveryFromLoop(place), flow);
}

fn add_links(to: &mut Builder<'_>, member: usize) {
    let CabinLayout { air, exhaust, soft, hard, .. } = *to.cabin(member);
    let (prefix, place) = (to.prefix(member), to.cabin_place(member) as u8);
    let name = to.layout.members[member].name.clone();
    let column = format!("{name}_panel_heat_flow_w");
    let flow = to.flow(column, "Cabin through its panels to ambient.", Crossing::Leaves);
    to.link(LinkPorts::to_surroundings(air), Law::Panel(place), flow);
    for (part, node, law) in [("soft", soft, Law::Soft(place)), ("hard", hard, Law::Hard(place))] {
        let column = format!("{prefix}{part}_furnishings_heat_flow_w");
        let flow = to.flow(column, format!("Cabin air to {part} furnishings."), Crossing::Inside);
        to.link(LinkPorts::between(air, node), law, flow);
    }
    let text = "Cabin air into the small exhaust volume, relative to ambient.";
    let flow = to.flow(format!("{name}_exhaust_heat_flow_w"), text, Crossing::Inside);
    let ports = LinkPorts { gains: Some(exhaust), ..LinkPorts::to_surroundings(air) };
    to.link(ports, Law::Exhaust(place), flow);
    let text = "Exhaust air leaving the vehicle, relative to ambient.";
    let flow = to.flow(format!("{prefix}exhaust_ambient_heat_flow_w"), text, Crossing::Leaves);
    to.link(LinkPorts::to_surroundings(exhaust), Law::Exhaust(place), flow);
}

fn add_sources(to: &mut Builder<'_>, member: usize) {
    let cabin = *to.cabin(member);
    let CabinLayout { air, soft, hard, .. } = cabin;
    for (flow, node) in [
        (cabin.blower_flow, air),
        (cabin.solar_flow, air),
        (cabin.occupants_flow, air),
        (cabin.solar_soft_flow, soft),
        (cabin.solar_hard_flow, hard),
    ] {
        to.layout.sources.push(HeatSource { flow, node, out: false });
    }
    if let Some(flow) = cabin.latent_flow {
        // An evaporator takes all its heat from the air, which gets back what water gave it; coolant gets it from the core.
        let node =
            cabin.cooler.map_or(air, |cooler| to.layout.loops[to.layout.branches[cooler].circuit].back);
        to.layout.sources.push(HeatSource { flow, node, out: false });
    }
}

fn add_levels(to: &mut Builder<'_>, member: usize) {
    let (prefix, cabin) = (to.prefix(member), to.cabin_place(member));
    let text = "recirculated share of the supply air".to_owned();
    let (name, purpose) = (format!("{prefix}recirculation"), Purpose::Recirculation(cabin));
    to.cabin(member).recirculation_row = to.row(ActuatorRow::level(name, "-", purpose, text));
    let text = "blower level between smallest and largest air flow".to_owned();
    let (name, purpose) = (format!("{prefix}blower_level"), Purpose::Blower(cabin));
    to.cabin(member).blower_row = to.row(ActuatorRow::level(name, "-", purpose, text));
}

parameters! {
    /// Cabin: large and small air volume, soft and hard furnishings, panels, ventilation.
    pub struct CabinParameters {
        /// Heat capacity of the large air volume with light trim [J/K].
        air_heat_capacity_j_k: f64 = 500.0 .. 200000.0,
        /// Heat capacity of the small exhaust volume [J/K].
        exhaust_heat_capacity_j_k: f64 = 10.0 .. 20000.0,
        /// Heat capacity of the soft furnishings [J/K].
        soft_heat_capacity_j_k: f64 = 1000.0 .. 2000000.0,
        /// Conductance air to soft furnishings [W/K].
        soft_conductance_w_k: f64 = 0.1 .. 1000.0,
        /// Heat capacity of the hard furnishings [J/K].
        hard_heat_capacity_j_k: f64 = 1000.0 .. 2000000.0,
        /// Conductance air to hard furnishings [W/K].
        hard_conductance_w_k: f64 = 0.1 .. 1000.0,
        /// Panel conductance to ambient at standstill [W/K].
        panel_conductance_w_k: f64 = 0.0 .. 500.0,
        /// Its increase with vehicle speed [W/K per m/s].
        panel_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Air mass flow at full blower level [kg/s].
        maximum_air_flow_kg_s: f64 = 0.01 .. 1.0,
        /// Smallest air mass flow while the blower runs [kg/s].
        minimum_air_flow_kg_s: f64 = 0.001 .. 0.5,
        /// Electrical power of the blower at full level; it warms the supply air [W].
        maximum_blower_power_w: f64 = 0.0 .. 2000.0,
        /// Heater-core conductance [W/K].
        heater_core_ua_w_k: f64 = 1.0 .. 2000.0,
        /// Cooling-core conductance [W/K].
        cooling_core_ua_w_k: f64 = 1.0 .. 2000.0,
        /// Fresh air that each occupant (at least one) must have [kg/s] (ours).
        minimum_fresh_air_per_occupant_kg_s: f64 = 0.0 .. 0.05,
        /// Largest recirculated share of the supply air [-] (ours).
        maximum_recirculation: f64 = 0.0 .. 0.95,
        /// Air temperature below which the cooling core is not driven, because it would ice up [degC] (ours).
        minimum_cooled_air_degc: Celsius = -5.0 .. 15.0,
        /// Share of the exhaust heat that can be recovered (paper section 2.2: up to 30 %) [-].
        exhaust_recovery_share: f64 = 0.0 .. 0.95,
        /// Sensible heat of one occupant [W].
        occupant_heat_w: f64 = 0.0 .. 300.0,
        /// Share of the solar heat that warms the furnishings, soft and hard in halves, and not the air [-].
        solar_to_furnishings_share: f64 = 0.0 .. 1.0,
        ;
        /// Its air: water and carbon dioxide.
        air: CabinAirParameters,
        /// Its windscreen.
        windscreen: WindscreenParameters,
    }
}

/// Air flows of a moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ventilation {
    /// Capacity rate of all blown air [W/K].
    pub supply_rate_w_k: f64,
    /// Capacity rate of its fresh part, equal to the exhaust [W/K].
    pub fresh_rate_w_k: f64,
    /// Recirculated share [-].
    pub recirculation: f64,
    /// Electrical power of the blower; all of it warms the supply air [W].
    pub blower_power_w: f64,
}

impl CabinParameters {
    /// Air flows at a blower level (0: smallest flow, 1: largest) and a recirculated share.
    ///
    /// Recirculation is held where every occupant, at least one, has fresh air. Fan law: power rises with the
    /// cube of the flow.
    #[must_use]
    pub fn ventilation(&self, blower_level: f64, recirculation: f64, occupants: f64) -> Ventilation {
        let flow_kg_s = self.minimum_air_flow_kg_s
            + blower_level * (self.maximum_air_flow_kg_s - self.minimum_air_flow_kg_s);
        let fresh_kg_s = self.minimum_fresh_air_per_occupant_kg_s * occupants.max(1.0);
        let largest = (1.0 - fresh_kg_s / flow_kg_s).clamp(0.0, self.maximum_recirculation);
        let recirculation = recirculation.min(largest);
        let supply_rate_w_k = flow_kg_s * SPECIFIC_HEAT_J_KG_K;
        Ventilation {
            supply_rate_w_k,
            fresh_rate_w_k: supply_rate_w_k * (1.0 - recirculation),
            recirculation,
            blower_power_w: self.maximum_blower_power_w * (flow_kg_s / self.maximum_air_flow_kg_s).powi(3),
        }
    }

    /// Panel conductance to ambient [W/K].
    #[must_use]
    pub fn panel_conductance_w_k(&self, speed_m_s: f64) -> f64 {
        self.panel_conductance_w_k + self.panel_conductance_per_speed_w_s_k_m * speed_m_s
    }

    /// Largest conductance of the cooling core that leaves the air warm enough not to ice it up [W/K].
    #[must_use]
    pub fn cooling_core_without_ice_w_k(
        &self,
        ventilation: &Ventilation,
        inlet_k: f64,
        coolant_k: f64,
    ) -> f64 {
        let coldest_k = self.minimum_cooled_air_degc.kelvin();
        if coolant_k >= coldest_k {
            return f64::INFINITY;
        }
        ventilation.supply_rate_w_k * (inlet_k - coldest_k).max(0.0) / (inlet_k - coolant_k).max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use crate::config::vehicle::VehicleParameters;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_occupant_has_fresh_air_whatever_is_asked(
            level in 0.0..=1.0_f64, recirculation in 0.0..=1.0_f64, occupants in 0_u32..6,
        ) {
            let vehicle = VehicleParameters::load("jeffs2019", &[]).expect("built in");
            let cabin = vehicle.cabin();
            let occupants = f64::from(occupants);
            let air = cabin.ventilation(level, recirculation, occupants);
            let needed = cabin.minimum_fresh_air_per_occupant_kg_s * occupants.max(1.0)
                * crate::media::air::SPECIFIC_HEAT_J_KG_K;
            prop_assert!(air.fresh_rate_w_k >= needed.min(air.supply_rate_w_k) * (1.0 - 1e-12));
            prop_assert!(air.recirculation <= cabin.maximum_recirculation);
        }
    }
}
