//! Builds a [`Layout`] step by step; kinds of components add their part.

mod actuators;
mod branches;
mod flows;
mod links;
mod machines;
mod nodes;
mod sources;

use super::declaration::{Declaration, MemberKind};
use super::flaw::Flaw;
use super::flows::{Crossing, FIXED_COUNT, Flow, FlowRow};
use super::kind::{ComponentKind, Meets};
use super::layout::{CabinLayout, Layout, NodeRow};
use super::places::{
    ACTUATOR_PLACES, BRANCH_PLACES, CABIN_PLACES, EXCHANGER_PLACES, FLOW_PLACES, FRONT_END_PLACES,
    HEATER_PLACES, INLET_PLACES, LINK_PLACES, LOOP_PLACES, MASS_PLACES, MEMBER_PLACES, NODE_PLACES,
    WEIGHT_PLACES,
};
use super::rows::ActuatorRow;
use super::wiring::{Law, Link, SERIES_PLACES};
use crate::numerics::graph::{LinkPorts, Node};

/// A layout in the making.
pub struct Builder<'a> {
    /// What the file says.
    pub declaration: &'a Declaration,
    /// What follows from it so far.
    pub layout: Layout,
}

/// The layout of a declared architecture.
///
/// # Errors
/// The declaration has a flaw, or is larger than there is room for.
pub fn layout(declaration: &Declaration) -> Result<Layout, Flaw> {
    declaration.check()?;
    check_sizes(declaration)?;
    let mut builder = Builder { declaration, layout: Layout::empty(declaration) };
    builder.add_nodes();
    builder.add_branches();
    builder.add_machines();
    builder.add_flows();
    builder.add_links();
    builder.add_sources();
    builder.add_actuators();
    let layout = builder.layout;
    let fixed = layout.flows.iter().filter(|row| row.flow.index() < FIXED_COUNT).count();
    for (what, count, room) in [
        ("thermal masses", layout.nodes.len(), NODE_PLACES),
        ("thermal links", layout.links.len(), LINK_PLACES),
        ("flows", FIXED_COUNT + layout.flows.len() - fixed, FLOW_PLACES - 1),
        ("loops with an exchanger or a heater", layout.inlets.len(), INLET_PLACES),
        ("actuators", layout.actuators.len(), ACTUATOR_PLACES),
        ("branches in series", layout.series_weights(), WEIGHT_PLACES),
    ] {
        check_room(what, count, room)?;
    }
    Ok(layout)
}

fn label(given: Option<&String>, name: &str) -> String {
    given.cloned().unwrap_or_else(|| name.replace('_', " "))
}

fn check_room(what: &str, count: usize, room: usize) -> Result<(), Flaw> {
    if count <= room {
        return Ok(());
    }
    Err(Flaw::new("architecture", format!("of {count} {what}"), format!("must have at most {room}")))
}

fn check_sizes(declaration: &Declaration) -> Result<(), Flaw> {
    let count = |meets: Meets| declaration.members.iter().filter(|m| m.kind.data().meets == meets).count();
    for (what, count, room) in [
        ("loops", declaration.loops.len(), LOOP_PLACES),
        ("members", declaration.members.len(), MEMBER_PLACES),
        ("branches", declaration.branches.len(), BRANCH_PLACES),
        ("cabins", count(Meets::SupplyAir), CABIN_PLACES),
        ("masses besides cabins", count(Meets::Mass), MASS_PLACES),
        ("front-end exchangers", count(Meets::AmbientAir), FRONT_END_PLACES),
        ("heaters", declaration.heaters.len(), HEATER_PLACES),
        ("refrigerant exchangers", declaration.exchangers.len(), EXCHANGER_PLACES),
    ] {
        check_room(what, count, room)?;
    }
    for circuit in &declaration.loops {
        let series = declaration.branches.iter().filter(|b| b.series && b.circuit == circuit.name).count();
        check_room(&format!("branches in series in `{}`", circuit.name), series, SERIES_PLACES)?;
    }
    Ok(())
}

impl Builder<'_> {
    /// Adds a node: stem of its column, and what it is.
    pub fn node(&mut self, stem: String, description: String) -> Node {
        let node = Node::new(self.layout.nodes.len() as u8);
        self.layout.nodes.push(NodeRow { stem, description });
        node
    }

    /// Adds a flow: its column, what flows from where to where, and whether it crosses the boundary.
    pub fn flow(&mut self, column: String, description: impl Into<String>, crossing: Crossing) -> Flow {
        let own = self.layout.flows.iter().filter(|row| row.flow.index() >= FIXED_COUNT).count();
        let flow = Flow((FIXED_COUNT + own) as u8);
        self.layout.flows.push(FlowRow { flow, column, description: description.into(), crossing });
        flow
    }

    /// Adds a link.
    pub fn link(&mut self, ports: LinkPorts, law: Law, flow: Flow) {
        self.layout.links.push(Link { ports, law, flow });
    }

    /// Adds an actuator; its row.
    pub fn row(&mut self, row: ActuatorRow) -> usize {
        self.layout.actuators.push(row);
        self.layout.actuators.len() - 1
    }

    /// Place of a cabin; that of the next one for what is none yet.
    #[must_use]
    pub fn cabin_place(&self, member: usize) -> usize {
        let cabins = &self.layout.cabins;
        cabins.iter().position(|cabin| cabin.member == member).unwrap_or(cabins.len())
    }

    /// A member that is a cabin.
    pub fn cabin(&mut self, member: usize) -> &mut CabinLayout {
        let place = self.cabin_place(member);
        &mut self.layout.cabins[place]
    }

    /// First of the names of what belongs to a cabin: none for the one that counts for comfort.
    #[must_use]
    pub fn prefix(&self, member: usize) -> String {
        match self.cabin_place(member) {
            0 => String::new(),
            _ => format!("{}_", self.declaration.members[member].name),
        }
    }

    /// Lets each kind add something of each of its members, the one that counts for comfort first.
    fn for_each_member(&mut self, mut add: impl FnMut(&mut Self, &ComponentKind, usize)) {
        for &kind in MemberKind::ALL {
            let mut members: Vec<usize> = self.declaration.of_kind(kind).collect();
            members.sort_by_key(|&member| !self.declaration.members[member].comfort);
            for member in members {
                add(self, kind.data(), member);
            }
        }
    }
}
