//! A network whose elimination is planned when it is loaded: any topology, at the cost of looking up every operation.
//!
//! It does what [`super::thermal_network`] does with the same operations in the same order, so both agree to the last bit.

use super::elementary::fused;
use super::graph::{LinkPorts, Node};
use super::thermal_network::{LinkState, MAXIMUM_LINKS, MAXIMUM_NODES, NodeValues};
use wide::f64x4;

/// Right-hand sides that are solved side by side.
pub const SIDE_BY_SIDE: usize = 4;

/// Places of matrix entries; one more than there may be takes what has no place.
const PLACES: usize = 256;
const SPARE: u8 = 255;

/// Places of nodes, a power of two; the last one takes what has no node.
const NODES: usize = 32;
const NO_NODE: u8 = 31;

/// A link's places: entries of (loses, hot), (loses, cold), (gains, hot), (gains, cold), then its nodes.
#[derive(Debug, Clone, Copy)]
struct LinkPlaces {
    entries: [u8; 4],
    loses: u8,
    gains: u8,
    hot: u8,
    cold: u8,
}

/// `target -= factor * source`.
#[derive(Debug, Clone, Copy)]
struct Subtraction {
    target: u8,
    factor: u8,
    source: u8,
}

/// A pivot, with how many of the following operations belong to it.
#[derive(Debug, Clone, Copy)]
struct Pivot {
    entry: u8,
    rows: u8,
    subtractions: u8,
}

/// A row of the back substitution.
#[derive(Debug, Clone, Copy)]
struct BackRow {
    node: u8,
    pivot: u8,
    subtractions: u8,
}

/// Everything that is known of the elimination before the numbers are.
#[derive(Debug, Clone)]
pub struct PlannedNetwork {
    nodes: usize,
    diagonal: Vec<u8>,
    links: Vec<LinkPlaces>,
    pivots: Vec<Pivot>,
    rows: Vec<u8>,
    subtractions: Vec<Subtraction>,
    forward: Vec<Subtraction>,
    back_rows: Vec<BackRow>,
    backward: Vec<Subtraction>,
}

/// A network for which there are not enough places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLarge {
    /// What there is too much of.
    pub what: &'static str,
    /// How much.
    pub found: usize,
}

/// A factorised backward-Euler step.
#[derive(Debug, Clone)]
pub struct PlannedStep {
    entries: [f64; PLACES],
    constant_w: [f64; NODES],
    capacity_rates_w_k: [f64; NODES],
}

impl Default for PlannedStep {
    fn default() -> Self {
        Self { entries: [0.0; PLACES], constant_w: [0.0; NODES], capacity_rates_w_k: [0.0; NODES] }
    }
}

type Pattern = Vec<Vec<bool>>;

/// Entries that links bring into the matrix, and its diagonal.
fn pattern(nodes: usize, links: &[LinkPorts]) -> Pattern {
    let mut filled = vec![vec![false; nodes]; nodes];
    for (node, row) in filled.iter_mut().enumerate() {
        row[node] = true;
    }
    for link in links {
        for row in [link.loses, link.gains].into_iter().flatten() {
            for column in [link.hot, link.cold].into_iter().flatten() {
                filled[row.index()][column.index()] = true;
            }
        }
    }
    filled
}

/// Pivots in order of least fill (Markowitz), those known first at the end; enters the fill into the pattern.
fn order(filled: &mut Pattern, known_first: &[Node]) -> Vec<usize> {
    let nodes = filled.len();
    let mut order = Vec::with_capacity(nodes);
    let mut done = vec![false; nodes];
    for position in 0..nodes {
        let left = nodes - position;
        let others = |k: usize, there: &dyn Fn(usize) -> bool| {
            (0..nodes).filter(|&i| i != k && !done[i] && there(i)).count()
        };
        let cost = |&k: &usize| others(k, &|i| filled[i][k]) * others(k, &|i| filled[k][i]);
        let late = |k: usize| known_first.iter().any(|node| node.index() == k);
        let pivot = if left <= known_first.len() {
            known_first[left - 1].index()
        } else {
            (0..nodes).filter(|&k| !done[k] && !late(k)).min_by_key(cost).unwrap_or_default()
        };
        done[pivot] = true;
        order.push(pivot);
        for i in 0..nodes {
            for j in 0..nodes {
                if !done[i] && !done[j] && filled[i][pivot] && filled[pivot][j] {
                    filled[i][j] = true;
                }
            }
        }
    }
    order
}

impl PlannedNetwork {
    /// Plans the elimination of a network; nodes that are known first are eliminated last.
    ///
    /// # Errors
    /// There are more nodes, links or entries of the matrix than there are places for.
    pub fn new(nodes: usize, links: &[LinkPorts], known_first: &[Node]) -> Result<Self, TooLarge> {
        if nodes > MAXIMUM_NODES || links.len() > MAXIMUM_LINKS {
            return Err(TooLarge { what: "nodes and links", found: nodes + links.len() });
        }
        let mut filled = pattern(nodes, links);
        let order = order(&mut filled, known_first);
        let mut places = vec![vec![SPARE; nodes]; nodes];
        let mut used = 0_usize;
        for (places, filled) in places.iter_mut().zip(&filled) {
            for (place, _) in places.iter_mut().zip(filled).filter(|(_, filled)| **filled) {
                // What has no place is counted only.
                *place = u8::try_from(used).unwrap_or(SPARE);
                used += 1;
            }
        }
        if used > usize::from(SPARE) {
            return Err(TooLarge { what: "entries of the matrix", found: used });
        }
        let mut planned = Self {
            nodes,
            diagonal: (0..nodes).map(|node| places[node][node]).collect(),
            links: links.iter().map(|ports| LinkPlaces::of(ports, &places)).collect(),
            pivots: Vec::new(),
            rows: Vec::new(),
            subtractions: Vec::new(),
            forward: Vec::new(),
            back_rows: Vec::new(),
            backward: Vec::new(),
        };
        for position in 0..nodes {
            planned.plan_pivot(position, &order, &filled, &places);
        }
        for position in (0..nodes).rev() {
            planned.plan_back_row(position, &order, &filled, &places);
        }
        Ok(planned)
    }

    fn plan_pivot(&mut self, position: usize, order: &[usize], filled: &Pattern, places: &[Vec<u8>]) {
        let k = order[position];
        let (rows, subtractions) = (self.rows.len(), self.subtractions.len());
        for &i in order[position + 1..].iter().filter(|&&i| filled[i][k]) {
            let factor = places[i][k];
            self.rows.push(factor);
            self.forward.push(Subtraction { target: i as u8, factor, source: k as u8 });
            for &j in order[position + 1..].iter().filter(|&&j| filled[k][j]) {
                self.subtractions.push(Subtraction { target: places[i][j], factor, source: places[k][j] });
            }
        }
        self.pivots.push(Pivot {
            entry: places[k][k],
            rows: (self.rows.len() - rows) as u8,
            subtractions: (self.subtractions.len() - subtractions) as u8,
        });
    }

    fn plan_back_row(&mut self, position: usize, order: &[usize], filled: &Pattern, places: &[Vec<u8>]) {
        let k = order[position];
        let before = self.backward.len();
        for &j in order[position + 1..].iter().rev().filter(|&&j| filled[k][j]) {
            self.backward.push(Subtraction { target: k as u8, factor: places[k][j], source: j as u8 });
        }
        let subtractions = (self.backward.len() - before) as u8;
        self.back_rows.push(BackRow { node: k as u8, pivot: places[k][k], subtractions });
    }

    /// Number of operations of a factorisation and of one substitution.
    #[must_use]
    pub fn operations(&self) -> (usize, usize) {
        let factorisation = self.pivots.len() + self.rows.len() + self.subtractions.len();
        (factorisation, self.forward.len() + self.backward.len() + self.back_rows.len())
    }

    /// Assembles and factorises the backward-Euler system of a step.
    pub fn factorise(
        &self,
        capacities_j_k: &NodeValues,
        links: &[LinkState],
        step_s: f64,
        step: &mut PlannedStep,
    ) {
        let per_second = step_s.recip();
        let used = self.diagonal.last().map_or(0, |&last| usize::from(last) + 1);
        step.entries[..used].fill(0.0);
        for (node, &place) in self.diagonal.iter().enumerate() {
            let rate_w_k = capacities_j_k[node] * per_second;
            step.capacity_rates_w_k[node] = rate_w_k;
            step.constant_w[node] = 0.0;
            step.entries[usize::from(place)] = rate_w_k;
        }
        for (places, link) in self.links.iter().zip(links) {
            let hot_w_k = link.conductance_w_k * link.hot_weight;
            let cold_w_k = link.conductance_w_k * link.cold_weight;
            let fixed_w = link.conductance_w_k * link.offset_k;
            let [a, b, c, d] = places.entries.map(usize::from);
            step.entries[a] += hot_w_k;
            step.entries[b] -= cold_w_k;
            step.entries[c] -= hot_w_k;
            step.entries[d] += cold_w_k;
            step.constant_w[usize::from(places.loses) % NODES] -= fixed_w;
            step.constant_w[usize::from(places.gains) % NODES] += fixed_w;
        }
        self.eliminate(&mut step.entries);
    }

    fn eliminate(&self, entries: &mut [f64; PLACES]) {
        let (mut rows, mut subtractions) = (&self.rows[..], &self.subtractions[..]);
        for pivot in &self.pivots {
            let place = usize::from(pivot.entry);
            let inverse = entries[place].recip();
            entries[place] = inverse;
            let (now, later) = rows.split_at(usize::from(pivot.rows));
            rows = later;
            for &row in now {
                entries[usize::from(row)] *= inverse;
            }
            let (now, later) = subtractions.split_at(usize::from(pivot.subtractions));
            subtractions = later;
            for operation in now {
                let [target, factor, source] =
                    [operation.target, operation.factor, operation.source].map(usize::from);
                entries[target] = fused(-entries[factor], entries[source], entries[target]);
            }
        }
    }

    /// Temperatures at the end of the step [K] from those at its beginning and the heat sources [W].
    #[must_use]
    pub fn advance(
        &self,
        step: &PlannedStep,
        temperatures_k: &NodeValues,
        sources_w: &NodeValues,
    ) -> NodeValues {
        let mut right = [0.0; NODES];
        self.right_side(step, temperatures_k, sources_w, &mut right);
        for operation in &self.forward {
            let [target, source] = [operation.target, operation.source].map(|node| usize::from(node) % NODES);
            right[target] = fused(-step.entries[usize::from(operation.factor)], right[source], right[target]);
        }
        let mut operations = &self.backward[..];
        for row in &self.back_rows {
            let (now, later) = operations.split_at(usize::from(row.subtractions));
            operations = later;
            let mut value = right[usize::from(row.node) % NODES];
            for operation in now {
                let source = usize::from(operation.source) % NODES;
                value = fused(-step.entries[usize::from(operation.factor)], right[source], value);
            }
            right[usize::from(row.node) % NODES] = value * step.entries[usize::from(row.pivot)];
        }
        let mut end_k = NodeValues::default();
        end_k.copy_from_slice(&right[..MAXIMUM_NODES]);
        end_k
    }

    fn right_side(
        &self,
        step: &PlannedStep,
        temperatures_k: &NodeValues,
        sources_w: &NodeValues,
        right: &mut [f64; NODES],
    ) {
        for node in 0..self.nodes {
            let stored_w = fused(step.capacity_rates_w_k[node], temperatures_k[node], step.constant_w[node]);
            right[node] = sources_w[node] + stored_w;
        }
    }

    /// Temperatures that are known first: at the end of the step, and their change per watt of each of the other sources
    /// [K, K/W]; a row a node, the step itself in its first column.
    pub fn forecast(
        &self,
        step: &PlannedStep,
        temperatures_k: &NodeValues,
        sources_w: &NodeValues,
        probes: &[NodeValues; SIDE_BY_SIDE - 1],
        known_first: &[Node],
        known: &mut [[f64; SIDE_BY_SIDE]],
    ) {
        let mut alone = [0.0; NODES];
        self.right_side(step, temperatures_k, sources_w, &mut alone);
        let mut right = [f64x4::ZERO; NODES];
        for node in 0..self.nodes {
            right[node] = f64x4::from([alone[node], probes[0][node], probes[1][node], probes[2][node]]);
        }
        for operation in &self.forward {
            let [target, source] = [operation.target, operation.source].map(|node| usize::from(node) % NODES);
            let factor = f64x4::splat(-step.entries[usize::from(operation.factor)]);
            right[target] = factor.mul_add(right[source], right[target]);
        }
        let mut operations = &self.backward[..];
        for row in self.back_rows.iter().take(known_first.len()) {
            let (now, later) = operations.split_at(usize::from(row.subtractions));
            operations = later;
            let mut value = right[usize::from(row.node) % NODES];
            for operation in now {
                let source = usize::from(operation.source) % NODES;
                let factor = f64x4::splat(-step.entries[usize::from(operation.factor)]);
                value = factor.mul_add(right[source], value);
            }
            right[usize::from(row.node) % NODES] = value * f64x4::splat(step.entries[usize::from(row.pivot)]);
        }
        for (known, node) in known.iter_mut().zip(known_first) {
            *known = right[node.index()].to_array();
        }
    }

    /// Tells the heat flow of each link at given temperatures [W].
    #[inline]
    pub fn for_link_flows(
        &self,
        links: &[LinkState],
        temperatures_k: &NodeValues,
        mut tell: impl FnMut(usize, f64),
    ) {
        let mut all_k = [0.0; NODES];
        all_k[..MAXIMUM_NODES].copy_from_slice(temperatures_k);
        for (place, (places, link)) in self.links.iter().zip(links).enumerate() {
            let hot_k = link.hot_weight * all_k[usize::from(places.hot) % NODES];
            let cold_k = link.cold_weight * all_k[usize::from(places.cold) % NODES];
            tell(place, link.conductance_w_k * (hot_k - cold_k + link.offset_k));
        }
    }
}

impl LinkPlaces {
    fn of(ports: &LinkPorts, places: &[Vec<u8>]) -> Self {
        let entry = |row: Option<Node>, column: Option<Node>| match (row, column) {
            (Some(row), Some(column)) => places[row.index()][column.index()],
            _ => SPARE,
        };
        let node = |node: Option<Node>| node.map_or(NO_NODE, |node| node.0);
        Self {
            entries: [
                entry(ports.loses, ports.hot),
                entry(ports.loses, ports.cold),
                entry(ports.gains, ports.hot),
                entry(ports.gains, ports.cold),
            ],
            loses: node(ports.loses),
            gains: node(ports.gains),
            hot: node(ports.hot),
            cold: node(ports.cold),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_without_enough_places_is_refused() {
        let node = |place: usize| Some(Node::new((place % MAXIMUM_NODES) as u8));
        // Four entries each that no other brings in.
        let link = |place: usize| {
            let (row, column) = (2 * place, 2 * (place + place / (MAXIMUM_NODES / 2) + 1));
            LinkPorts { loses: node(row), gains: node(row + 1), hot: node(column), cold: node(column + 1) }
        };
        let links: Vec<LinkPorts> = (0..MAXIMUM_LINKS).map(link).collect();
        assert!(PlannedNetwork::new(MAXIMUM_NODES, &links[..4], &[]).is_ok());
        let refused = PlannedNetwork::new(MAXIMUM_NODES, &links, &[]).expect_err("too many entries");
        assert!(refused.what == "entries of the matrix" && refused.found > 255, "{refused:?}");
        assert!(PlannedNetwork::new(MAXIMUM_NODES + 1, &links[..1], &[]).is_err());
    }
}
