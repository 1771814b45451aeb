//! The executor that is made while compiling: wiring, laws and elimination are constants, so nothing is looked up.

use super::conditions::{Conditions, state};
use super::planned::PlannedWiring;
use super::shape::{Given, Shape, bring, entering_w, is_first, settle};
use super::{Forecast, INLET_PLACES};
use crate::architecture::indices::{
    BranchIndices, ExchangerIndices, FrontEndIndices, HeaterIndices, Indices, LoopIndices,
};
use crate::architecture::layout::CabinLayout;
use crate::architecture::wiring::SERIES_PLACES;
use crate::flows::{Flow, Flows};
use crate::numerics::elimination::MAXIMUM_OPERATIONS;
pub use crate::numerics::thermal_network::Factors;
use crate::numerics::thermal_network::{
    LinkPorts, LinkState, MAXIMUM_LINKS, Node, NodeValues, ThermalNetwork, Topology,
};
use crate::unrolled;
use std::marker::PhantomData;

/// Positions that are known while compiling; the build script writes one for each built-in architecture.
pub trait Wiring {
    /// Positions.
    const INDICES: Indices<'static>;
}

/// The shape of a built-in architecture.
#[derive(Debug)]
pub struct Compiled<W>(PhantomData<W>);

impl<W: Wiring> Topology for Compiled<W> {
    const NODES: usize = W::INDICES.nodes;
    const LINKS: &'static [LinkPorts] = W::INDICES.ports;
    const KNOWN_FIRST: &'static [Node] = W::INDICES.known_first;
}

impl<W: Wiring> Compiled<W> {
    const SIZES: () = assert!(
        W::INDICES.links.len() <= MAXIMUM_OPERATIONS
            && W::INDICES.inlets.len() <= INLET_PLACES
            && SERIES_PLACES >= 1,
        "more links or inlets than are unrolled"
    );

    #[inline(always)]
    fn link<const POSITION: usize>(given: &Given<'_>, links: &mut [LinkState; MAXIMUM_LINKS]) {
        if let Some(link) = const { at(W::INDICES.links, POSITION) } {
            links[POSITION] = state(link.law, given.now, given.constants);
        }
    }

    #[inline(always)]
    fn links(given: &Given<'_>) -> [LinkState; MAXIMUM_LINKS] {
        let mut links = [LinkState::OPEN; MAXIMUM_LINKS];
        unrolled!(link(given, &mut links));
        links
    }

    #[inline(always)]
    fn source<const POSITION: usize>(flows: &Flows, sources_w: &mut NodeValues) {
        if let Some(source) = const { at(W::INDICES.sources, POSITION) } {
            let heat_w = flows[source.flow];
            sources_w[source.node.index()] += if source.out { -heat_w } else { heat_w };
        }
    }

    #[inline(always)]
    fn entering<const POSITION: usize>(now: &Conditions<'_>, flows: &Flows, sources_w: &mut NodeValues) {
        if let Some(inlet) = const { there(W::INDICES.inlets, POSITION) } {
            bring(inlet, entering_w(inlet, flows), now, sources_w);
        }
    }

    #[inline(always)]
    fn sources_w(now: &Conditions<'_>, flows: &Flows) -> NodeValues {
        let mut sources_w = NodeValues::default();
        unrolled!(entering(now, flows, &mut sources_w));
        unrolled!(source(flows, &mut sources_w));
        sources_w
    }

    #[inline(always)]
    fn forecast<const POSITION: usize>(
        now: &Conditions<'_>,
        factors: &Factors,
        base_k: &NodeValues,
        forecasts: &mut [Forecast; INLET_PLACES],
    ) {
        if let Some(inlet) = const { there(W::INDICES.inlets, POSITION) } {
            let mut probe_w = NodeValues::default();
            bring(inlet, 1.0, now, &mut probe_w);
            let supply = inlet.supply.index();
            forecasts[POSITION] = Forecast {
                base_k: base_k[supply],
                sensitivity_k_w: ThermalNetwork::<Self>::response(factors, &probe_w)[supply],
            };
        }
    }

    #[inline(always)]
    fn record<const POSITION: usize>(links_w: &[f64; MAXIMUM_LINKS], flows: &mut Flows) {
        if let Some(link) = const { at(W::INDICES.links, POSITION) } {
            let first = const { is_first(W::INDICES.links, POSITION) };
            let flow_w = &mut flows[link.flow];
            *flow_w = if first { links_w[POSITION] } else { *flow_w + links_w[POSITION] };
        }
    }

    #[inline(always)]
    fn settled<const POSITION: usize>(now: &Conditions<'_>, flows: &mut Flows) {
        if let Some(inlet) = const { there(W::INDICES.inlets, POSITION) } {
            let heat_w = entering_w(inlet, flows);
            settle(inlet, heat_w, now, flows);
        }
    }
}

/// Where an entry of a list is, if there is one: loops inside it are unrolled too late for a copy to be looked through.
const fn there<T>(list: &[T], position: usize) -> Option<&T> {
    if position < list.len() { Some(&list[position]) } else { None }
}

/// An entry of a list, if there is one.
const fn at<T: Copy>(list: &[T], position: usize) -> Option<T> {
    if position < list.len() { Some(list[position]) } else { None }
}

impl<W: Wiring> Compiled<W> {
    #[inline(always)]
    fn forecasts(
        now: &Conditions<'_>,
        factors: &Factors,
        base_k: &NodeValues,
        forecasts: &mut [Forecast; INLET_PLACES],
    ) {
        unrolled!(forecast(now, factors, base_k, forecasts));
    }
}

impl<W: Wiring> Shape for Compiled<W> {
    const COMPILED: bool = true;

    type Factors = Factors;

    #[inline(always)]
    fn indices<'a>(_: &'a Indices<'a>) -> &'a Indices<'a> {
        const { &W::INDICES }
    }

    #[inline(always)]
    fn circuit_at<const N: usize>(_: &Indices<'_>) -> Option<LoopIndices> {
        const { at(W::INDICES.loops, N) }
    }

    #[inline(always)]
    fn branch_at<const N: usize>(_: &Indices<'_>) -> Option<BranchIndices> {
        const { at(W::INDICES.branches, N) }
    }

    #[inline(always)]
    fn cabin_at<const N: usize>(_: &Indices<'_>) -> Option<CabinLayout> {
        const { at(W::INDICES.cabins, N) }
    }

    #[inline(always)]
    fn front_end_at<const N: usize>(_: &Indices<'_>) -> Option<FrontEndIndices> {
        const { at(W::INDICES.front_ends, N) }
    }

    #[inline(always)]
    fn exchanger_at<const N: usize>(_: &Indices<'_>) -> Option<ExchangerIndices> {
        const { at(W::INDICES.exchangers, N) }
    }

    #[inline(always)]
    fn heater_at<const N: usize>(_: &Indices<'_>) -> Option<HeaterIndices> {
        const { at(W::INDICES.heaters, N) }
    }

    #[inline(always)]
    fn base_load_at<const N: usize>(_: &Indices<'_>) -> Option<Flow> {
        const { at(W::INDICES.base_loads, N) }
    }

    #[inline(always)]
    fn begin(
        _: Option<&PlannedWiring>,
        given: &Given<'_>,
        step_s: f64,
        flows: &Flows,
    ) -> ([Forecast; INLET_PLACES], Factors) {
        let () = Self::SIZES;
        let links = Self::links(given);
        let factors = ThermalNetwork::<Self>::factorise(given.capacities_j_k, &links, step_s);
        let sources_w = Self::sources_w(given.now, flows);
        let base_k = ThermalNetwork::<Self>::advance(&factors, given.start_k, &sources_w);
        let mut forecasts = [Forecast::default(); INLET_PLACES];
        Self::forecasts(given.now, &factors, &base_k, &mut forecasts);
        (forecasts, factors)
    }

    #[inline(always)]
    fn finish(
        _: Option<&PlannedWiring>,
        factors: &Factors,
        given: &Given<'_>,
        flows: &mut Flows,
    ) -> NodeValues {
        let sources_w = Self::sources_w(given.now, flows);
        let end_k = ThermalNetwork::<Self>::advance(factors, given.start_k, &sources_w);
        let links_w = ThermalNetwork::<Self>::link_flows(&Self::links(given), &end_k);
        unrolled!(record(&links_w, flows));
        unrolled!(settled(given.now, flows));
        end_k
    }
}
