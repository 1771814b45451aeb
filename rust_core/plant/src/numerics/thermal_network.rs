//! A network of heat capacities and links, stepped by backward Euler.
//!
//! Nodes and links are declared once, as constants; the order of elimination follows from them while the crate is
//! compiled (see [`super::elimination`]). A link carries `G (w_hot T_hot - w_cold T_cold + offset)` from the node
//! that loses it to the node that gains it. The nodes whose temperatures drive a link need not be those that
//! exchange the heat: a coolant branch is driven by the supply temperature and takes its heat from the return node.

use super::elementary::fused;
pub use super::elimination::MAXIMUM_NODES;
use super::elimination::{Elimination, MAXIMUM_ENTRIES};
pub use super::graph::{LinkPorts, Node};
use crate::unrolled;
use std::marker::PhantomData;

/// Largest number of links.
pub const MAXIMUM_LINKS: usize = 56;

/// What a link does during one step: heat flow = `conductance (hot_weight T_hot - cold_weight T_cold + offset)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkState {
    /// Conductance or capacity rate [W/K].
    pub conductance_w_k: f64,
    /// Weight of the driving temperature [-].
    pub hot_weight: f64,
    /// Weight of the opposing temperature [-].
    pub cold_weight: f64,
    /// Fixed part of the temperature difference [K].
    pub offset_k: f64,
}

impl LinkState {
    /// Conductance between two nodes.
    #[must_use]
    #[inline]
    pub fn conductance(conductance_w_k: f64) -> Self {
        Self { conductance_w_k, hot_weight: 1.0, cold_weight: 1.0, offset_k: 0.0 }
    }

    /// Conductance to surroundings at a fixed temperature [K].
    #[must_use]
    #[inline]
    pub fn to_fixed(conductance_w_k: f64, temperature_k: f64) -> Self {
        Self { conductance_w_k, hot_weight: 1.0, cold_weight: 0.0, offset_k: -temperature_k }
    }

    /// Conductance from surroundings at a fixed temperature [K].
    #[must_use]
    #[inline]
    pub fn from_fixed(conductance_w_k: f64, temperature_k: f64) -> Self {
        Self { conductance_w_k, hot_weight: 0.0, cold_weight: 1.0, offset_k: temperature_k }
    }

    /// A link that carries nothing.
    pub const OPEN: Self = Self { conductance_w_k: 0.0, hot_weight: 0.0, cold_weight: 0.0, offset_k: 0.0 };
}

/// One value for each node.
pub type NodeValues = [f64; MAXIMUM_NODES];

/// Which nodes there are and what connects them.
pub trait Topology {
    /// Number of nodes.
    const NODES: usize;
    /// Links; states of a step come in the same order.
    const LINKS: &'static [LinkPorts];
    /// Nodes whose temperatures are wanted most often: they are eliminated last, so known first.
    const KNOWN_FIRST: &'static [Node];
}

/// Heat gained by nodes between two sets of temperatures [J]; differences first, so nothing is lost to round-off.
#[must_use]
#[inline(always)]
pub fn heat_gained_j(
    nodes: usize,
    capacities_j_k: &NodeValues,
    before_k: &NodeValues,
    after_k: &NodeValues,
) -> f64 {
    let mut gained_j = 0.0;
    for i in 0..nodes.min(MAXIMUM_NODES) {
        gained_j += capacities_j_k[i] * (after_k[i] - before_k[i]);
    }
    gained_j
}

/// A factorised backward-Euler step: of use to the network that made it only.
#[derive(Debug, Clone)]
pub struct Factors {
    entries: [f64; MAXIMUM_ENTRIES],
    constant_w: NodeValues,
    capacity_rates_w_k: NodeValues,
}

/// A network whose topology is known while compiling.
#[derive(Debug)]
pub struct ThermalNetwork<T>(PhantomData<T>);

impl<T: Topology> ThermalNetwork<T> {
    const ELIMINATION: Elimination = Elimination::of(T::NODES, T::LINKS, T::KNOWN_FIRST);

    /// Assembles and factorises the backward-Euler system of a step, from the heat capacities of the nodes [J/K] and the
    /// states of the links.
    #[must_use]
    #[allow(clippy::needless_range_loop, reason = "several arrays, side by side")]
    #[inline(always)]
    pub fn factorise(capacities_j_k: &NodeValues, links: &[LinkState], step_s: f64) -> Factors {
        let mut step = Factors {
            entries: [0.0; MAXIMUM_ENTRIES],
            constant_w: [0.0; MAXIMUM_NODES],
            capacity_rates_w_k: [0.0; MAXIMUM_NODES],
        };
        let per_second = step_s.recip();
        for i in 0..T::NODES {
            step.capacity_rates_w_k[i] = capacities_j_k[i] * per_second;
            step.entries[Self::ELIMINATION.entry(i, i)] = step.capacity_rates_w_k[i];
        }
        unrolled!(assemble(links, &mut step));
        unrolled!(eliminate(&mut step.entries));
        step
    }

    /// Enters link number `LINK`.
    #[inline(always)]
    fn assemble<const LINK: usize>(links: &[LinkState], step: &mut Factors) {
        if LINK >= T::LINKS.len() {
            return;
        }
        let (ports, link) = (&T::LINKS[LINK], &links[LINK]);
        let hot_w_k = link.conductance_w_k * link.hot_weight;
        let cold_w_k = link.conductance_w_k * link.cold_weight;
        let fixed_w = link.conductance_w_k * link.offset_k;
        if let Some(row) = ports.loses {
            if let Some(hot) = ports.hot {
                step.entries[Self::ELIMINATION.entry(row.index(), hot.index())] += hot_w_k;
            }
            if let Some(cold) = ports.cold {
                step.entries[Self::ELIMINATION.entry(row.index(), cold.index())] -= cold_w_k;
            }
            step.constant_w[row.index()] -= fixed_w;
        }
        if let Some(row) = ports.gains {
            if let Some(hot) = ports.hot {
                step.entries[Self::ELIMINATION.entry(row.index(), hot.index())] -= hot_w_k;
            }
            if let Some(cold) = ports.cold {
                step.entries[Self::ELIMINATION.entry(row.index(), cold.index())] += cold_w_k;
            }
            step.constant_w[row.index()] += fixed_w;
        }
    }

    /// Operation number `POSITION` of the factorisation.
    #[inline(always)]
    fn eliminate<const POSITION: usize>(entries: &mut [f64; MAXIMUM_ENTRIES]) {
        const { Self::ELIMINATION.factorise.at(POSITION) }.apply_to_matrix(entries);
    }

    /// Heat flow of each link at given temperatures [W].
    #[must_use]
    #[inline(always)]
    pub fn link_flows(links: &[LinkState], temperatures_k: &NodeValues) -> [f64; MAXIMUM_LINKS] {
        let mut flows_w = [0.0; MAXIMUM_LINKS];
        unrolled!(link_flow(links, temperatures_k, &mut flows_w));
        flows_w
    }

    #[inline(always)]
    fn link_flow<const LINK: usize>(
        links: &[LinkState],
        temperatures_k: &NodeValues,
        flows_w: &mut [f64; MAXIMUM_LINKS],
    ) {
        if LINK >= T::LINKS.len() {
            return;
        }
        let (ports, link) = (&T::LINKS[LINK], &links[LINK]);
        let hot = ports.hot.map_or(0.0, |node| link.hot_weight * temperatures_k[node.index()]);
        let cold = ports.cold.map_or(0.0, |node| link.cold_weight * temperatures_k[node.index()]);
        flows_w[LINK] = link.conductance_w_k * (hot - cold + link.offset_k);
    }

    /// Temperatures at the end of the step [K] from those at its beginning and the heat sources [W].
    ///
    /// Inlined, so that a caller who reads only some of the temperatures does not pay for the others.
    #[must_use]
    #[inline(always)]
    pub fn advance(step: &Factors, temperatures_k: &NodeValues, sources_w: &NodeValues) -> NodeValues {
        let mut right = *sources_w;
        for i in 0..T::NODES {
            right[i] += fused(step.capacity_rates_w_k[i], temperatures_k[i], step.constant_w[i]);
        }
        Self::substitute(step, right)
    }

    /// Change of all temperatures per watt brought in by `sources_w` [K].
    #[must_use]
    #[inline(always)]
    pub fn response(step: &Factors, sources_w: &NodeValues) -> NodeValues {
        Self::substitute(step, *sources_w)
    }

    #[inline(always)]
    fn substitute(step: &Factors, mut right: NodeValues) -> NodeValues {
        unrolled!(forward(&step.entries, &mut right));
        unrolled!(backward(&step.entries, &mut right));
        right
    }

    #[inline(always)]
    fn forward<const POSITION: usize>(entries: &[f64; MAXIMUM_ENTRIES], right: &mut NodeValues) {
        const { Self::ELIMINATION.forward.at(POSITION) }.apply_to_vector(entries, right);
    }

    #[inline(always)]
    fn backward<const POSITION: usize>(entries: &[f64; MAXIMUM_ENTRIES], right: &mut NodeValues) {
        const { Self::ELIMINATION.backward.at(POSITION) }.apply_to_vector(entries, right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const A: Node = Node::new(0);
    const B: Node = Node::new(1);
    const C: Node = Node::new(2);

    /// Three masses in a row, the last one beside the surroundings, and a branch that is driven by other nodes than
    /// those that exchange its heat.
    #[derive(Debug)]
    struct Chain;

    impl Topology for Chain {
        const NODES: usize = 3;
        const LINKS: &'static [LinkPorts] = &[
            LinkPorts::between(A, B),
            LinkPorts::between(B, C),
            LinkPorts::to_surroundings(C),
            LinkPorts { loses: Some(C), gains: Some(A), hot: Some(A), cold: Some(B) },
        ];
        const KNOWN_FIRST: &'static [Node] = &[B];
    }

    type Network = ThermalNetwork<Chain>;

    fn capacities() -> NodeValues {
        let mut capacities = NodeValues::default();
        capacities[..3].copy_from_slice(&[1000.0, 500.0, 200.0]);
        capacities
    }

    fn advanced(links: &[LinkState], step_s: f64, sources: &NodeValues) -> NodeValues {
        Network::advance(&Network::factorise(&capacities(), links, step_s), &start(), sources)
    }

    fn links(branch_w_k: f64) -> [LinkState; 4] {
        [
            LinkState::conductance(20.0),
            LinkState::conductance(5.0),
            LinkState::to_fixed(2.0, 280.0),
            LinkState { conductance_w_k: branch_w_k, hot_weight: 0.5, cold_weight: 1.0, offset_k: 150.0 },
        ]
    }

    fn start() -> NodeValues {
        let mut start = NodeValues::default();
        start[..3].copy_from_slice(&[300.0, 290.0, 310.0]);
        start
    }

    #[test]
    fn a_long_step_reaches_the_temperature_of_the_surroundings() {
        let end = advanced(&links(0.0), 1e12, &NodeValues::default());
        for temperature in &end[..3] {
            assert!((temperature - 280.0).abs() < 1e-6);
        }
    }

    #[test]
    fn stored_heat_changes_by_exactly_what_crosses_the_boundary() {
        let links = links(3.0);
        let mut sources = NodeValues::default();
        sources[A.index()] = 75.0;
        let end = advanced(&links, 1.0, &sources);
        let flows = Network::link_flows(&links, &end);
        let residual = heat_gained_j(3, &capacities(), &start(), &end) - (75.0 - flows[2]);
        assert!(residual.abs() < 1e-9, "residual {residual} W");
    }

    #[test]
    fn a_source_acts_on_all_temperatures_as_the_difference_of_two_steps_says() {
        let step = Network::factorise(&capacities(), &links(3.0), 2.0);
        let mut sources = NodeValues::default();
        sources[B.index()] = 1.0;
        let (without, with) = (
            Network::advance(&step, &start(), &NodeValues::default()),
            Network::advance(&step, &start(), &sources),
        );
        let response = Network::response(&step, &sources);
        for i in 0..3 {
            assert!((with[i] - without[i] - response[i]).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn a_planned_network_does_the_same_to_the_last_bit(branch in 0.0..50.0_f64, step_s in 0.01..100.0_f64) {
            use crate::numerics::planned_network::{PlannedNetwork, PlannedStep};
            let planned = PlannedNetwork::new(Chain::NODES, Chain::LINKS, Chain::KNOWN_FIRST).expect("small");
            let (links, mut sources) = (links(branch), NodeValues::default());
            sources[A.index()] = 75.0;
            let step = Network::factorise(&capacities(), &links, step_s);
            let mut same = PlannedStep::default();
            planned.factorise(&capacities(), &links, step_s, &mut same);
            let end = Network::advance(&step, &start(), &sources);
            prop_assert_eq!(end, planned.advance(&same, &start(), &sources));
            let mut flows = [0.0; MAXIMUM_LINKS];
            planned.for_link_flows(&links, &end, |place, flow_w| flows[place] = flow_w);
            prop_assert_eq!(Network::link_flows(&links, &end), flows);
            let mut known = [[0.0; 4]];
            let probes = [sources, NodeValues::default(), NodeValues::default()];
            planned.forecast(&same, &start(), &sources, &probes, Chain::KNOWN_FIRST, &mut known);
            prop_assert_eq!(known[0][0], end[B.index()]);
            prop_assert_eq!(known[0][1], Network::response(&step, &sources)[B.index()]);
        }

        #[test]
        fn elimination_solves_what_a_dense_solver_solves(branch in 0.0..50.0_f64, step_s in 0.01..100.0_f64) {
            let end = advanced(&links(branch), step_s, &NodeValues::default());
            let rates = [1000.0, 500.0, 200.0].map(|capacity: f64| capacity / step_s);
            let half = 0.5 * branch;
            let dense = nalgebra::Matrix3::new(
                rates[0] + 20.0 - half, -20.0 + branch, 0.0,
                -20.0, rates[1] + 25.0, -5.0,
                half, -5.0 - branch, rates[2] + 7.0,
            );
            let fixed = [150.0 * branch, 0.0, 560.0 - 150.0 * branch];
            let right = nalgebra::Vector3::from_fn(|i, _| rates[i] * start()[i] + fixed[i]);
            let reference = dense.lu().solve(&right).expect("regular");
            for i in 0..3 {
                prop_assert!((end[i] / reference[i] - 1.0).abs() < 1e-11);
            }
        }
    }
}
