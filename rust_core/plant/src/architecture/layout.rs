//! What follows from an architecture: everything countable, by position.

use super::builder;
use super::declaration::{Declaration, Level, MemberKind, Side};
use super::flaw::Flaw;
use super::flows::{Flow, FlowRow};
pub use super::places::*;
use super::rows::ActuatorRow;
use super::wiring::{HeatSource, Inlet, Link};
use crate::numerics::graph::Node;

/// A coolant loop.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What its branches do unless they say otherwise.
    pub side: Side,
    /// Node behind what tempers it, before its branches.
    pub supply: Node,
    /// Node behind its branches.
    pub back: Node,
    /// Branches in series, in order.
    pub series: Vec<usize>,
    /// Flow of its pump's power.
    pub pump_flow: Flow,
    /// Row of its coolant flow.
    pub flow_row: usize,
    /// Exchanger of the refrigerant loop that tempers it.
    pub exchanger: Option<usize>,
}

/// A member.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What it is.
    pub kind: MemberKind,
    /// The vehicle's section with its numbers.
    pub section: String,
    /// Node of its mass; that of a cabin is its air.
    pub node: Option<Node>,
    /// Branches in the order of its actuator's options, which follow `isolated`.
    pub options: Vec<usize>,
    /// Row of its connection; none without branches.
    pub connection_row: Option<usize>,
    /// Row of its requested heat flow.
    pub request_row: Option<usize>,
    /// Row of its valve.
    pub valve_row: Option<usize>,
    /// Loop that a plate comes from.
    pub from: Option<usize>,
}

/// What is on the member's side of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchSide {
    /// A thermal mass.
    Mass(Node),
    /// Ambient air; position among the front-end exchangers.
    Ambient(usize),
    /// Supply air of a cabin.
    Core(usize),
    /// Return of another loop.
    Plate(usize),
}

/// A branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BranchLayout {
    /// Member.
    pub member: usize,
    /// Loop.
    pub circuit: usize,
    /// Number of its option of the member's actuator; 0 is isolated.
    pub option: usize,
    /// In series.
    pub series: bool,
    /// Whether it moves heat out of the loop.
    pub out_of_loop: bool,
    /// What is on the other side.
    pub side: BranchSide,
    /// Flow that it carries, positive in its direction.
    pub flow: Flow,
}

/// A mass besides cabins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MassLayout {
    /// Member.
    pub member: usize,
    /// Node.
    pub node: Node,
}

/// A cabin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CabinLayout {
    /// Member.
    pub member: usize,
    /// Large air volume.
    pub air: Node,
    /// Small exhaust volume.
    pub exhaust: Node,
    /// Soft furnishings.
    pub soft: Node,
    /// Hard furnishings.
    pub hard: Node,
    /// Loop that its exhaust heat goes into.
    pub recovery: Option<usize>,
    /// Branch of its heater core, and that of its cooling core.
    pub heater: Option<usize>,
    /// Branch of its cooling core.
    pub cooler: Option<usize>,
    /// Flow of its blower's power.
    pub blower_flow: Flow,
    /// Flow of solar heat.
    pub solar_flow: Flow,
    /// Flow of solar heat onto the soft furnishings.
    pub solar_soft_flow: Flow,
    /// Flow of solar heat onto the hard furnishings.
    pub solar_hard_flow: Flow,
    /// Flow of its occupants' heat.
    pub occupants_flow: Flow,
    /// Evaporator in its supply air.
    pub evaporator: Option<usize>,
    /// Flow of the heat of water that condenses on its cooling core or evaporator.
    pub latent_flow: Option<Flow>,
    /// Row of the recirculated share.
    pub recirculation_row: usize,
    /// Row of the blower level.
    pub blower_row: usize,
    /// Row of the share that is blown at the windscreen.
    pub windscreen_row: usize,
}

/// What an exchanger of the refrigerant loop has on its other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangerSide {
    /// Coolant of a loop.
    Loop(usize),
    /// Supply air of a cabin.
    Cabin(usize),
    /// Ambient air at a front-end exchanger.
    FrontEnd(usize),
}

/// An exchanger of the refrigerant loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExchangerLayout {
    /// Name.
    pub name: String,
    /// Pressure level.
    pub level: Level,
    /// Other side.
    pub side: ExchangerSide,
    /// Row of its valve; always open without.
    pub valve_row: Option<usize>,
    /// Flow that it carries, positive from the refrigerant where it condenses, into it where it evaporates.
    pub flow: Flow,
}

/// What a heater heats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeaterTarget {
    /// Coolant of a loop, at its supply.
    Loop(usize),
    /// A mass; the air of a cabin.
    Mass(Node),
}

/// A heater.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeaterLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What it heats.
    pub target: HeaterTarget,
    /// Row that allows it to heat.
    pub row: usize,
    /// Flow of its power.
    pub flow: Flow,
}

/// A front-end exchanger.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrontEndLayout {
    /// Member.
    pub member: usize,
    /// The vehicle's section of the air that it shares.
    pub stream: Option<String>,
    /// Front-end exchanger whose air it gets.
    pub behind: Option<usize>,
}

/// Everything that follows from an architecture.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// What it is, in a sentence.
    pub description: String,
    /// Loops.
    pub loops: Vec<LoopLayout>,
    /// Members.
    pub members: Vec<MemberLayout>,
    /// Branches.
    pub branches: Vec<BranchLayout>,
    /// Masses besides cabins: powertrain, then stores.
    pub masses: Vec<MassLayout>,
    /// Cabins, the one that counts for comfort first.
    pub cabins: Vec<CabinLayout>,
    /// Front-end exchangers.
    pub front_ends: Vec<FrontEndLayout>,
    /// Exchangers of the refrigerant loop.
    pub exchangers: Vec<ExchangerLayout>,
    /// Heaters.
    pub heaters: Vec<HeaterLayout>,
    /// Names of the nodes; the stem of a column.
    pub nodes: Vec<NodeRow>,
    /// Links of the thermal network.
    pub links: Vec<Link>,
    /// Heat that flows bring into nodes.
    pub sources: Vec<HeatSource>,
    /// Where heat enters loops: exchangers first, then loops with a heater only.
    pub inlets: Vec<Inlet>,
    /// Flows in the order of their columns.
    pub flows: Vec<FlowRow>,
    /// Flows of electrical power besides traction, compressor and heaters.
    pub base_loads: Vec<Flow>,
    /// Actuators.
    pub actuators: Vec<ActuatorRow>,
    /// Node of the battery.
    pub battery: Node,
    /// Node of motor and inverter.
    pub motor: Node,
    /// Node of the transmission.
    pub transmission: Node,
    /// Row of the compressor's power.
    pub compressor_row: Option<usize>,
    /// Row of the cabin temperature that heaters aim at.
    pub set_point_row: Option<usize>,
}

/// A node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeRow {
    /// Stem of its column: `<stem>_temperature_degc`.
    pub stem: String,
    /// What it is.
    pub description: String,
}
impl Layout {
    /// The layout of a declared architecture.
    ///
    /// # Errors
    /// The declaration has a flaw, or is larger than there is room for.
    pub fn of(declaration: &Declaration) -> Result<Self, Flaw> {
        builder::layout(declaration)
    }

    /// A layout without anything in it.
    pub(super) fn empty(declaration: &Declaration) -> Self {
        let node = Node::new(0);
        Self {
            description: declaration.description.clone(),
            loops: Vec::new(),
            members: Vec::new(),
            branches: Vec::new(),
            masses: Vec::new(),
            cabins: Vec::new(),
            front_ends: Vec::new(),
            exchangers: Vec::new(),
            heaters: Vec::new(),
            nodes: Vec::new(),
            links: Vec::new(),
            sources: Vec::new(),
            inlets: Vec::new(),
            flows: Vec::new(),
            base_loads: Vec::new(),
            actuators: Vec::new(),
            battery: node,
            motor: node,
            transmission: node,
            compressor_row: None,
            set_point_row: None,
        }
    }

    /// Number of weights of branches in series.
    #[must_use]
    pub fn series_weights(&self) -> usize {
        self.loops.iter().map(|circuit| (1..circuit.series.len()).map(|place| place + 1).sum::<usize>()).sum()
    }

    /// Place of the first weight of a later branch of a loop's series: loop by loop, not in the order of the branches.
    pub(super) fn series_weight(&self, circuit: usize, position: usize) -> usize {
        let weights = |later: usize| (1..later).map(|place| place + 1).sum::<usize>();
        let before: usize = self.loops[..circuit].iter().map(|other| weights(other.series.len())).sum();
        before + weights(position)
    }

    /// Whether there is a refrigerant loop.
    #[must_use]
    pub fn refrigerates(&self) -> bool {
        !self.exchangers.is_empty()
    }

    /// Position of a member.
    #[must_use]
    pub fn member(&self, name: &str) -> Option<usize> {
        self.members.iter().position(|member| member.name == name)
    }

    /// Position of a loop.
    #[must_use]
    pub fn circuit(&self, name: &str) -> Option<usize> {
        self.loops.iter().position(|circuit| circuit.name == name)
    }

    /// Row of an actuator.
    #[must_use]
    pub fn actuator(&self, name: &str) -> Option<usize> {
        self.actuators.iter().position(|actuator| actuator.name == name)
    }

    /// Branch of a member in a loop.
    #[must_use]
    pub fn branch(&self, member: usize, circuit: usize) -> Option<usize> {
        self.branches.iter().position(|branch| branch.member == member && branch.circuit == circuit)
    }

    /// Sections that a vehicle must have besides those of [`super::declaration::VEHICLE_SECTIONS`].
    #[must_use]
    pub fn sections(&self) -> Vec<String> {
        let mut sections: Vec<String> = Vec::new();
        let loops = self.loops.iter().map(|circuit| circuit.name.clone());
        let members = self.members.iter().map(|member| member.section.clone());
        let heaters = self.heaters.iter().map(|heater| heater.name.clone());
        let streams = self.front_ends.iter().filter_map(|front_end| front_end.stream.clone());
        for section in loops.chain(members).chain(heaters).chain(streams) {
            if !sections.contains(&section) {
                sections.push(section);
            }
        }
        sections
    }
}
