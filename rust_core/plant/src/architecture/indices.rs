//! A layout as positions only: what a step looks up, as constants for the built-in architectures.

use super::declaration::Level;
use super::flows::Flow;
use super::layout::{BranchSide, CabinLayout, ExchangerSide, HeaterTarget, Layout};
use super::wiring::{HeatSource, Inlet, Link};
use crate::numerics::graph::{LinkPorts, Node};

/// A coolant loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoopIndices {
    /// Node behind what tempers it, before its branches.
    pub supply: Node,
    /// Node behind its branches.
    pub back: Node,
    /// Flow of its pump's power.
    pub pump_flow: Flow,
    /// Row of its coolant flow.
    pub flow_row: u8,
    /// Exchanger of the refrigerant loop that tempers it.
    pub exchanger: Option<u8>,
    /// Place among the inlets, where heat enters.
    pub inlet: Option<u8>,
    /// Whether it has branches in series.
    pub has_series: bool,
}

/// A branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BranchIndices {
    /// Loop.
    pub circuit: u8,
    /// Row that connects it, and number of the option that does.
    pub connection_row: u8,
    /// Number of its option; 0 is isolated.
    pub option: u8,
    /// Row of its request.
    pub request_row: u8,
    /// Row of its valve.
    pub valve_row: u8,
    /// In series.
    pub series: bool,
    /// Whether it moves heat out of the loop.
    pub out_of_loop: bool,
    /// What is on the member's side.
    pub side: BranchSide,
    /// Flow that it carries.
    pub flow: Flow,
    /// Whether it is connected during air conditioning only: a radiator of a hot loop, the cooling core of a cold one.
    pub cools: bool,
}

/// An exchanger of the refrigerant loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExchangerIndices {
    /// Pressure level.
    pub level: Level,
    /// Other side.
    pub side: ExchangerSide,
    /// Row of its valve; always open without.
    pub valve_row: Option<u8>,
    /// Flow that it carries.
    pub flow: Flow,
}

/// A heater.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeaterIndices {
    /// What it heats.
    pub target: HeaterTarget,
    /// Row that allows it to heat.
    pub row: u8,
    /// Flow of its power.
    pub flow: Flow,
}

/// A front-end exchanger.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrontEndIndices {
    /// Whether it shares its air.
    pub shares_air: bool,
    /// Front-end exchanger whose air it gets.
    pub behind: Option<u8>,
    /// Whether refrigerant may be in it.
    pub refrigerant: bool,
}

/// A layout as positions; lists are those of the layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indices<'a> {
    /// Number of nodes.
    pub nodes: usize,
    /// Loops.
    pub loops: &'a [LoopIndices],
    /// Branches.
    pub branches: &'a [BranchIndices],
    /// Cabins.
    pub cabins: &'a [CabinLayout],
    /// Number of stores, whose masses come after those of the powertrain.
    pub stores: usize,
    /// Front-end exchangers.
    pub front_ends: &'a [FrontEndIndices],
    /// Exchangers of the refrigerant loop.
    pub exchangers: &'a [ExchangerIndices],
    /// Heaters.
    pub heaters: &'a [HeaterIndices],
    /// Links of the network.
    pub links: &'a [Link],
    /// What they connect.
    pub ports: &'a [LinkPorts],
    /// Heat that flows bring into nodes.
    pub sources: &'a [HeatSource],
    /// Where heat enters loops.
    pub inlets: &'a [Inlet],
    /// Supplies of those loops, the last one first.
    pub known_first: &'a [Node],
    /// Flows of electrical power besides traction, compressor and heaters.
    pub base_loads: &'a [Flow],
    /// Node of the battery.
    pub battery: Node,
    /// Node of motor and inverter.
    pub motor: Node,
    /// Node of the transmission.
    pub transmission: Node,
    /// Row of the compressor's power.
    pub compressor_row: Option<u8>,
    /// Row of the cabin temperature that heaters aim at.
    pub set_point_row: Option<u8>,
    /// Number of flows.
    pub flows: usize,
    /// Number of actuators.
    pub actuators: usize,
    /// Number of weights of branches in series.
    pub weights: usize,
}

/// The same with lists of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnedIndices {
    nodes: usize,
    /// Loops.
    pub loops: Vec<LoopIndices>,
    /// Branches.
    pub branches: Vec<BranchIndices>,
    /// Cabins.
    pub cabins: Vec<CabinLayout>,
    stores: usize,
    /// Front-end exchangers.
    pub front_ends: Vec<FrontEndIndices>,
    /// Exchangers.
    pub exchangers: Vec<ExchangerIndices>,
    /// Heaters.
    pub heaters: Vec<HeaterIndices>,
    /// Links.
    pub links: Vec<Link>,
    /// What they connect.
    pub ports: Vec<LinkPorts>,
    /// Heat sources.
    pub sources: Vec<HeatSource>,
    /// Inlets of loops.
    pub inlets: Vec<Inlet>,
    /// Supplies known first.
    pub known_first: Vec<Node>,
    /// Base loads.
    pub base_loads: Vec<Flow>,
    battery: Node,
    motor: Node,
    transmission: Node,
    compressor_row: Option<u8>,
    set_point_row: Option<u8>,
    flows: usize,
    actuators: usize,
    weights: usize,
}

fn small(row: Option<usize>) -> u8 {
    row.unwrap_or(0) as u8
}

impl OwnedIndices {
    /// Positions of a layout.
    #[must_use]
    pub fn of(layout: &Layout) -> Self {
        let stores = layout
            .masses
            .iter()
            .filter(|mass| layout.members[mass.member].kind.data().read.is_some())
            .count();
        Self {
            nodes: layout.nodes.len(),
            loops: (0..layout.loops.len()).map(|circuit| loop_indices(layout, circuit)).collect(),
            branches: (0..layout.branches.len()).map(|branch| branch_indices(layout, branch)).collect(),
            cabins: layout.cabins.clone(),
            stores,
            front_ends: (0..layout.front_ends.len()).map(|end| front_end_indices(layout, end)).collect(),
            exchangers: layout
                .exchangers
                .iter()
                .map(|exchanger| ExchangerIndices {
                    level: exchanger.level,
                    side: exchanger.side,
                    valve_row: exchanger.valve_row.map(|row| row as u8),
                    flow: exchanger.flow,
                })
                .collect(),
            heaters: layout
                .heaters
                .iter()
                .map(|heater| HeaterIndices {
                    target: heater.target,
                    row: heater.row as u8,
                    flow: heater.flow,
                })
                .collect(),
            links: layout.links.clone(),
            ports: layout.links.iter().map(|link| link.ports).collect(),
            sources: layout.sources.clone(),
            inlets: layout.inlets.clone(),
            known_first: layout.inlets.iter().rev().map(|inlet| inlet.supply).collect(),
            base_loads: layout.base_loads.clone(),
            battery: layout.battery,
            motor: layout.motor,
            transmission: layout.transmission,
            compressor_row: layout.compressor_row.map(|row| row as u8),
            set_point_row: layout.set_point_row.map(|row| row as u8),
            flows: layout.flows.iter().map(|row| row.flow.index() + 1).max().unwrap_or(0),
            actuators: layout.actuators.len(),
            weights: layout.series_weights(),
        }
    }

    /// As positions that are looked up.
    #[must_use]
    #[inline]
    pub fn view(&self) -> Indices<'_> {
        Indices {
            nodes: self.nodes,
            loops: &self.loops,
            branches: &self.branches,
            cabins: &self.cabins,
            stores: self.stores,
            front_ends: &self.front_ends,
            exchangers: &self.exchangers,
            heaters: &self.heaters,
            links: &self.links,
            ports: &self.ports,
            sources: &self.sources,
            inlets: &self.inlets,
            known_first: &self.known_first,
            base_loads: &self.base_loads,
            battery: self.battery,
            motor: self.motor,
            transmission: self.transmission,
            compressor_row: self.compressor_row,
            set_point_row: self.set_point_row,
            flows: self.flows,
            actuators: self.actuators,
            weights: self.weights,
        }
    }
}

impl Indices<'_> {
    /// Places of branches that are worked on: whole groups of four.
    #[must_use]
    #[inline(always)]
    pub const fn branch_places(&self) -> usize {
        self.branches.len().next_multiple_of(4)
    }

    /// Whether the refrigerant meets two loops only, and nothing can be closed.
    #[must_use]
    #[inline(always)]
    pub const fn is_pair(&self) -> bool {
        matches!(
            self.exchangers,
            [
                ExchangerIndices {
                    level: Level::Condensing,
                    side: ExchangerSide::Loop(_),
                    valve_row: None,
                    ..
                },
                ExchangerIndices {
                    level: Level::Evaporating,
                    side: ExchangerSide::Loop(_),
                    valve_row: None,
                    ..
                },
            ]
        )
    }
}

fn loop_indices(layout: &Layout, circuit: usize) -> LoopIndices {
    let own = &layout.loops[circuit];
    let inlet = layout.inlets.iter().position(|inlet| usize::from(inlet.circuit) == circuit);
    LoopIndices {
        supply: own.supply,
        back: own.back,
        pump_flow: own.pump_flow,
        flow_row: own.flow_row as u8,
        exchanger: own.exchanger.map(|exchanger| exchanger as u8),
        inlet: inlet.map(|inlet| inlet as u8),
        has_series: !own.series.is_empty(),
    }
}

fn branch_indices(layout: &Layout, place: usize) -> BranchIndices {
    let branch = layout.branches[place];
    let member = &layout.members[branch.member];
    BranchIndices {
        circuit: branch.circuit as u8,
        connection_row: small(member.connection_row),
        option: branch.option as u8,
        request_row: small(member.request_row),
        valve_row: small(member.valve_row),
        series: branch.series,
        out_of_loop: branch.out_of_loop,
        side: branch.side,
        flow: branch.flow,
        cools: match branch.side {
            BranchSide::Ambient(_) => branch.out_of_loop,
            BranchSide::Core(_) => !branch.out_of_loop,
            BranchSide::Mass(_) | BranchSide::Plate(_) => false,
        },
    }
}

fn front_end_indices(layout: &Layout, end: usize) -> FrontEndIndices {
    let own = &layout.front_ends[end];
    FrontEndIndices {
        shares_air: own.stream.is_some(),
        behind: own.behind.map(|other| other as u8),
        refrigerant: layout.exchangers.iter().any(|exchanger| exchanger.side == ExchangerSide::FrontEnd(end)),
    }
}
