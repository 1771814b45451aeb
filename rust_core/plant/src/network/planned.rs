//! The executor for any wiring: planned when the architecture is loaded, every law and operation looked up.

use super::conditions::state;
use super::shape::{Given, Shape, bring, entering_w, is_first, settle};
use super::{Forecast, INLET_PLACES};
use crate::architecture::indices::{
    BranchIndices, ExchangerIndices, FrontEndIndices, HeaterIndices, Indices, LoopIndices,
};
use crate::architecture::layout::CabinLayout;
use crate::architecture::wiring::{HeatSource, Inlet, Link};
use crate::flows::{Flow, Flows};
use crate::numerics::planned_network::{PlannedNetwork, PlannedStep, SIDE_BY_SIDE, TooLarge};
use crate::numerics::thermal_network::{LinkState, MAXIMUM_LINKS, Node, NodeValues};
use std::cell::Cell;

/// A wiring with the plan of its elimination.
#[derive(Debug, Clone)]
pub struct PlannedWiring {
    network: PlannedNetwork,
    links: Vec<(Link, bool)>,
    sources: Vec<HeatSource>,
    inlets: Vec<Inlet>,
    known_first: Vec<Node>,
}

/// The shape of any architecture.
#[derive(Debug)]
pub struct Planned;

impl Shape for Planned {
    const COMPILED: bool = false;

    type Factors = Scratch;

    #[inline(always)]
    fn indices<'a>(own: &'a Indices<'a>) -> &'a Indices<'a> {
        own
    }

    #[inline(always)]
    fn circuit_at<const N: usize>(shape: &Indices<'_>) -> Option<LoopIndices> {
        shape.loops.get(N).copied()
    }

    #[inline(always)]
    fn branch_at<const N: usize>(shape: &Indices<'_>) -> Option<BranchIndices> {
        shape.branches.get(N).copied()
    }

    #[inline(always)]
    fn cabin_at<const N: usize>(shape: &Indices<'_>) -> Option<CabinLayout> {
        shape.cabins.get(N).copied()
    }

    #[inline(always)]
    fn front_end_at<const N: usize>(shape: &Indices<'_>) -> Option<FrontEndIndices> {
        shape.front_ends.get(N).copied()
    }

    #[inline(always)]
    fn exchanger_at<const N: usize>(shape: &Indices<'_>) -> Option<ExchangerIndices> {
        shape.exchangers.get(N).copied()
    }

    #[inline(always)]
    fn heater_at<const N: usize>(shape: &Indices<'_>) -> Option<HeaterIndices> {
        shape.heaters.get(N).copied()
    }

    #[inline(always)]
    fn base_load_at<const N: usize>(shape: &Indices<'_>) -> Option<Flow> {
        shape.base_loads.get(N).copied()
    }

    #[inline(always)]
    fn begin(
        planned: Option<&PlannedWiring>,
        given: &Given<'_>,
        step_s: f64,
        flows: &Flows,
    ) -> ([Forecast; INLET_PLACES], Scratch) {
        let mut scratch = Scratch::take();
        let forecasts = planned.map(|wiring| wiring.begin(given, step_s, flows, scratch.room()));
        (forecasts.unwrap_or_default(), scratch)
    }

    #[inline(always)]
    fn finish(
        planned: Option<&PlannedWiring>,
        scratch: &Scratch,
        given: &Given<'_>,
        flows: &mut Flows,
    ) -> NodeValues {
        match (planned, &scratch.0) {
            (Some(wiring), Some(room)) => wiring.finish(room, given, flows),
            _ => *given.start_k,
        }
    }
}

/// Room for a step: too large to be cleared each time.
#[derive(Debug)]
struct Room {
    step: PlannedStep,
    links: [LinkState; MAXIMUM_LINKS],
}

thread_local! {
    static FREE: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

/// Room that its thread gets back.
#[derive(Debug)]
pub struct Scratch(Option<Box<Room>>);

impl Scratch {
    #[inline]
    fn take() -> Self {
        let make =
            || Box::new(Room { step: PlannedStep::default(), links: [LinkState::OPEN; MAXIMUM_LINKS] });
        Self(Some(FREE.with(Cell::take).unwrap_or_else(make)))
    }

    fn room(&mut self) -> &mut Room {
        self.0.get_or_insert_with(|| {
            Box::new(Room { step: PlannedStep::default(), links: [LinkState::OPEN; MAXIMUM_LINKS] })
        })
    }
}

impl Drop for Scratch {
    #[inline]
    fn drop(&mut self) {
        let room = self.0.take();
        FREE.with(|free| free.set(room));
    }
}

impl PlannedWiring {
    /// Plans a wiring.
    ///
    /// # Errors
    /// See [`PlannedNetwork::new`].
    pub fn of(indices: &Indices<'_>) -> Result<Self, TooLarge> {
        let first = |place: usize| is_first(indices.links, place);
        Ok(Self {
            network: PlannedNetwork::new(indices.nodes, indices.ports, indices.known_first)?,
            links: indices.links.iter().enumerate().map(|(place, &link)| (link, first(place))).collect(),
            sources: indices.sources.to_vec(),
            inlets: indices.inlets.to_vec(),
            known_first: indices.known_first.to_vec(),
        })
    }

    fn sources_w(&self, given: &Given<'_>, flows: &Flows) -> NodeValues {
        let mut sources_w = NodeValues::default();
        for inlet in &self.inlets {
            bring(inlet, entering_w(inlet, flows), given.now, &mut sources_w);
        }
        for source in &self.sources {
            let heat_w = flows[source.flow];
            sources_w[source.node.index()] += if source.out { -heat_w } else { heat_w };
        }
        sources_w
    }

    /// Assembles and factorises a step.
    fn begin(
        &self,
        given: &Given<'_>,
        step_s: f64,
        flows: &Flows,
        room: &mut Room,
    ) -> [Forecast; INLET_PLACES] {
        for (place, (link, _)) in room.links.iter_mut().zip(&self.links) {
            *place = state(link.law, given.now, given.constants);
        }
        let step = &mut room.step;
        self.network.factorise(given.capacities_j_k, &room.links, step_s, step);
        let mut probes = [NodeValues::default(); SIDE_BY_SIDE - 1];
        for (probe_w, inlet) in probes.iter_mut().zip(&self.inlets) {
            bring(inlet, 1.0, given.now, probe_w);
        }
        let mut known = [[0.0; SIDE_BY_SIDE]; INLET_PLACES];
        let sources_w = self.sources_w(given, flows);
        self.network.forecast(step, given.start_k, &sources_w, &probes, &self.known_first, &mut known);
        let count = self.inlets.len();
        std::array::from_fn(|place| match count.checked_sub(place + 1) {
            // Nodes known first are listed from the last inlet on.
            Some(row) => Forecast { base_k: known[row][0], sensitivity_k_w: known[row][place + 1] },
            None => Forecast::default(),
        })
    }

    /// Temperatures at the end of the step [K]; enters the heat flows of all links.
    fn finish(&self, room: &Room, given: &Given<'_>, flows: &mut Flows) -> NodeValues {
        let sources_w = self.sources_w(given, flows);
        let end_k = self.network.advance(&room.step, given.start_k, &sources_w);
        self.network.for_link_flows(&room.links, &end_k, |place, flow_w| {
            let (link, first) = &self.links[place];
            let flow = &mut flows[link.flow];
            *flow = if *first { flow_w } else { *flow + flow_w };
        });
        for inlet in &self.inlets {
            settle(inlet, entering_w(inlet, flows), given.now, flows);
        }
        end_k
    }
}
