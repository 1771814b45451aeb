//! The thermal network of an architecture: which links there are, by which law each of them conducts, and where heat
//! enters.

use super::flows::Flow;
use crate::numerics::graph::{LinkPorts, Node};

/// Law by which a link conducts; what it names are positions of branches, loops, masses, cabins and front-end exchangers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Coolant flow of a loop from its supply to its return.
    Advection(u8),
    /// Half of a loop's hoses, to ambient.
    Hose(u8),
    /// Branch between two nodes, or the first of a series.
    Branch(u8),
    /// Branch that rejects heat to the air of a front-end exchanger: branch, front-end exchanger.
    BranchToAir(u8, u8),
    /// Branch that takes heat from it: branch, front-end exchanger.
    BranchFromAir(u8, u8),
    /// Core that heats the supply air of a cabin: branch, cabin.
    HeaterCore(u8, u8),
    /// Core that cools it: branch, cabin.
    CoolingCore(u8, u8),
    /// A later branch of a series, driven by the loop's return with a weight: branch, weight, whether it moves heat out of
    /// the loop.
    SeriesReturn(u8, u8, bool),
    /// The same, the part driven by a branch before it.
    SeriesBefore(u8, u8, bool),
    /// Exhaust recovery of a cabin, limited by ambient.
    RecoveryFromAmbient(u8),
    /// Exhaust recovery of a cabin, limited by its loop.
    RecoveryFromLoop(u8),
    /// Mass to ambient.
    MassToAmbient(u8),
    /// Panels of a cabin to ambient.
    Panel(u8),
    /// Cabin air to soft furnishings.
    Soft(u8),
    /// Cabin air to hard furnishings.
    Hard(u8),
    /// Air of a cabin into its exhaust volume, or that leaving the vehicle, relative to ambient.
    Exhaust(u8),
}

/// A link of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Link {
    /// What it connects.
    pub ports: LinkPorts,
    /// How it conducts.
    pub law: Law,
    /// Flow that it carries; several links may share one.
    pub flow: Flow,
}

/// Heat that a flow brings into a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeatSource {
    /// Flow.
    pub flow: Flow,
    /// Node.
    pub node: Node,
    /// The flow takes the heat out instead.
    pub out: bool,
}

/// Where an exchanger or a heater brings heat into a loop: its supply and, in part, the series behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inlet {
    /// Flow that it carries; none for what is asked about only.
    pub flow: Flow,
    /// The flow takes the heat out instead.
    pub out: bool,
    /// Supply of the loop.
    pub supply: Node,
    /// Loop.
    pub circuit: u8,
    /// Branches in series, in order.
    pub series: [Option<SeriesPlace>; SERIES_PLACES],
}

/// Most branches that a loop can have in series.
pub const SERIES_PLACES: usize = 3;

/// A branch in series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeriesPlace {
    /// Branch.
    pub branch: u8,
    /// Node of its member.
    pub node: Node,
    /// Flow that it carries.
    pub flow: Flow,
    /// The branch moves heat out of the loop.
    pub out_of_loop: bool,
}
