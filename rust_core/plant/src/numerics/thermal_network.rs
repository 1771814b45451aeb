//! A network of heat capacities and links, stepped by backward Euler.
//!
//! Nodes and links are declared once; the order of elimination and the sparsity follow from them. A link
//! carries `G (w_hot T_hot - w_cold T_cold + offset)` from the node that loses it to the node that gains it.
//! The nodes whose temperatures drive a link need not be those that exchange the heat: a coolant branch is
//! driven by the supply temperature and takes its heat from the return node.

/// Largest number of nodes.
pub const MAXIMUM_NODES: usize = 16;

/// Largest number of links.
pub const MAXIMUM_LINKS: usize = 40;

/// Index of a node in temperatures and heat sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Node(u8);

impl Node {
    /// Position in arrays of node values.
    #[must_use]
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Which nodes a link connects; `None` is the surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkPorts {
    /// Node that loses the heat flow.
    pub loses: Option<Node>,
    /// Node that gains it.
    pub gains: Option<Node>,
    /// Node whose temperature drives it.
    pub hot: Option<Node>,
    /// Node whose temperature opposes it.
    pub cold: Option<Node>,
}

impl LinkPorts {
    /// Plain conduction between two nodes.
    #[must_use]
    pub fn between(from: Node, to: Node) -> Self {
        Self { loses: Some(from), gains: Some(to), hot: Some(from), cold: Some(to) }
    }

    /// Plain conduction from a node to the surroundings; their temperature is the (negative) offset.
    #[must_use]
    pub fn to_surroundings(from: Node) -> Self {
        Self { loses: Some(from), gains: None, hot: Some(from), cold: None }
    }
}

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

/// Declares nodes and links of a network.
#[derive(Debug, Clone, Default)]
pub struct NetworkBuilder {
    capacities_j_k: Vec<f64>,
    links: Vec<LinkPorts>,
}

impl NetworkBuilder {
    /// Adds a node with a heat capacity [J/K].
    ///
    /// # Panics
    /// More than [`MAXIMUM_NODES`] nodes.
    pub fn node(&mut self, heat_capacity_j_k: f64) -> Node {
        assert!(self.capacities_j_k.len() < MAXIMUM_NODES, "too many thermal nodes");
        self.capacities_j_k.push(heat_capacity_j_k);
        Node((self.capacities_j_k.len() - 1) as u8)
    }

    /// Adds a link; its number is the position in the slice of link states of a step.
    ///
    /// # Panics
    /// More than [`MAXIMUM_LINKS`] links.
    pub fn link(&mut self, ports: LinkPorts) -> usize {
        assert!(self.links.len() < MAXIMUM_LINKS, "too many thermal links");
        self.links.push(ports);
        self.links.len() - 1
    }

    /// Works out the elimination.
    #[must_use]
    pub fn build(self) -> ThermalNetwork {
        let nodes = self.capacities_j_k.len();
        let mut capacities_j_k = [0.0; MAXIMUM_NODES];
        capacities_j_k[..nodes].copy_from_slice(&self.capacities_j_k);
        let elimination = Elimination::of(nodes, &self.links);
        ThermalNetwork { nodes, capacities_j_k, links: self.links, elimination }
    }
}

/// Rows to update for one pivot.
#[derive(Debug, Clone)]
struct Pivot {
    column: usize,
    rows: Vec<usize>,
    columns: Vec<usize>,
}

/// Symbolic factorisation: pivots in order of least fill.
#[derive(Debug, Clone)]
struct Elimination {
    pivots: Vec<Pivot>,
}

impl Elimination {
    fn of(nodes: usize, links: &[LinkPorts]) -> Self {
        let mut filled = [[false; MAXIMUM_NODES]; MAXIMUM_NODES];
        for (i, row) in filled.iter_mut().enumerate().take(nodes) {
            row[i] = true;
        }
        for link in links {
            for row in [link.loses, link.gains].into_iter().flatten() {
                for column in [link.hot, link.cold].into_iter().flatten() {
                    filled[row.index()][column.index()] = true;
                }
            }
        }
        let mut remaining: Vec<usize> = (0..nodes).collect();
        let mut pivots = Vec::with_capacity(nodes);
        while !remaining.is_empty() {
            let cost = |&k: &usize| {
                let rows = remaining.iter().filter(|&&i| i != k && filled[i][k]).count();
                let columns = remaining.iter().filter(|&&j| j != k && filled[k][j]).count();
                (rows * columns, k)
            };
            let Some(k) = remaining.iter().copied().min_by_key(cost) else { break };
            remaining.retain(|&i| i != k);
            let rows: Vec<usize> = remaining.iter().copied().filter(|&i| filled[i][k]).collect();
            let columns: Vec<usize> = remaining.iter().copied().filter(|&j| filled[k][j]).collect();
            for &i in &rows {
                for &j in &columns {
                    filled[i][j] = true;
                }
            }
            pivots.push(Pivot { column: k, rows, columns });
        }
        Self { pivots }
    }
}

/// Heat capacities, links and the elimination worked out from them.
#[derive(Debug, Clone)]
pub struct ThermalNetwork {
    nodes: usize,
    capacities_j_k: NodeValues,
    links: Vec<LinkPorts>,
    elimination: Elimination,
}

impl ThermalNetwork {
    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Ports of the links, in order of declaration.
    #[must_use]
    pub fn links(&self) -> &[LinkPorts] {
        &self.links
    }

    /// Heat capacity of a node [J/K].
    #[must_use]
    pub fn heat_capacity_j_k(&self, node: Node) -> f64 {
        self.capacities_j_k[node.index()]
    }

    /// Heat stored above 0 K [J].
    #[must_use]
    pub fn stored_heat_j(&self, temperatures_k: &NodeValues) -> f64 {
        (0..self.nodes).map(|i| self.capacities_j_k[i] * temperatures_k[i]).sum()
    }

    /// Heat gained between two sets of temperatures [J]; differences first, so nothing is lost to round-off.
    #[must_use]
    pub fn heat_gained_j(&self, before_k: &NodeValues, after_k: &NodeValues) -> f64 {
        (0..self.nodes).map(|i| self.capacities_j_k[i] * (after_k[i] - before_k[i])).sum()
    }

    /// Assembles and factorises the backward-Euler system of a step.
    #[must_use]
    pub fn factorise(&self, links: &[LinkState], step_s: f64) -> FactorisedStep<'_> {
        let mut matrix = [[0.0; MAXIMUM_NODES]; MAXIMUM_NODES];
        let mut constant_w = [0.0; MAXIMUM_NODES];
        for (i, row) in matrix.iter_mut().enumerate().take(self.nodes) {
            row[i] = self.capacities_j_k[i] / step_s;
        }
        for (ports, link) in self.links.iter().zip(links) {
            let g = link.conductance_w_k;
            if g == 0.0 {
                continue;
            }
            for (row, sign) in [(ports.loses, 1.0), (ports.gains, -1.0)] {
                let Some(row) = row else { continue };
                if let Some(hot) = ports.hot {
                    matrix[row.index()][hot.index()] += sign * g * link.hot_weight;
                }
                if let Some(cold) = ports.cold {
                    matrix[row.index()][cold.index()] -= sign * g * link.cold_weight;
                }
                constant_w[row.index()] -= sign * g * link.offset_k;
            }
        }
        for pivot in &self.elimination.pivots {
            let k = pivot.column;
            let inverse = 1.0 / matrix[k][k];
            for &i in &pivot.rows {
                let factor = matrix[i][k] * inverse;
                matrix[i][k] = factor;
                for &j in &pivot.columns {
                    matrix[i][j] -= factor * matrix[k][j];
                }
            }
            matrix[k][k] = inverse;
        }
        FactorisedStep { network: self, matrix, constant_w, step_s }
    }

    /// Heat flow of each link at given temperatures [W], written to `flows_w`.
    pub fn link_flows(&self, links: &[LinkState], temperatures_k: &NodeValues, flows_w: &mut [f64]) {
        for ((ports, link), flow) in self.links.iter().zip(links).zip(flows_w) {
            let hot = ports.hot.map_or(0.0, |node| link.hot_weight * temperatures_k[node.index()]);
            let cold = ports.cold.map_or(0.0, |node| link.cold_weight * temperatures_k[node.index()]);
            *flow = link.conductance_w_k * (hot - cold + link.offset_k);
        }
    }
}

/// A factorised backward-Euler step; solves for any heat sources.
#[derive(Debug, Clone)]
pub struct FactorisedStep<'a> {
    network: &'a ThermalNetwork,
    matrix: [NodeValues; MAXIMUM_NODES],
    constant_w: NodeValues,
    step_s: f64,
}

impl FactorisedStep<'_> {
    /// Temperatures at the end of the step [K] from those at its beginning and the heat sources [W].
    #[must_use]
    pub fn advance(&self, temperatures_k: &NodeValues, sources_w: &NodeValues) -> NodeValues {
        let mut right = *sources_w;
        for i in 0..self.network.nodes {
            right[i] += self.constant_w[i] + self.network.capacities_j_k[i] / self.step_s * temperatures_k[i];
        }
        self.substitute(right)
    }

    /// Change of all temperatures per watt brought in by `sources_w` [K].
    #[must_use]
    pub fn response(&self, sources_w: &NodeValues) -> NodeValues {
        self.substitute(*sources_w)
    }

    fn substitute(&self, mut right: NodeValues) -> NodeValues {
        for pivot in &self.network.elimination.pivots {
            let value = right[pivot.column];
            for &i in &pivot.rows {
                right[i] -= self.matrix[i][pivot.column] * value;
            }
        }
        for pivot in self.network.elimination.pivots.iter().rev() {
            let k = pivot.column;
            let known: f64 = pivot.columns.iter().map(|&j| self.matrix[k][j] * right[j]).sum();
            right[k] = (right[k] - known) * self.matrix[k][k];
        }
        right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_node_chain() -> (ThermalNetwork, [LinkState; 3], [Node; 3]) {
        let mut builder = NetworkBuilder::default();
        let a = builder.node(1000.0);
        let b = builder.node(500.0);
        let c = builder.node(200.0);
        builder.link(LinkPorts::between(a, b));
        builder.link(LinkPorts::between(b, c));
        builder.link(LinkPorts::to_surroundings(c));
        let links =
            [LinkState::conductance(20.0), LinkState::conductance(5.0), LinkState::to_fixed(2.0, 280.0)];
        (builder.build(), links, [a, b, c])
    }

    #[test]
    fn a_long_step_reaches_the_temperature_of_the_surroundings() {
        let (network, links, _) = three_node_chain();
        let end = network.factorise(&links, 1e12).advance(&[300.0; MAXIMUM_NODES], &[0.0; MAXIMUM_NODES]);
        for temperature in &end[..3] {
            assert!((temperature - 280.0).abs() < 1e-6);
        }
    }

    #[test]
    fn stored_heat_changes_by_exactly_what_crosses_the_boundary() {
        let (network, links, nodes) = three_node_chain();
        let start = [300.0, 290.0, 310.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut sources = [0.0; MAXIMUM_NODES];
        sources[nodes[0].index()] = 75.0;
        let end = network.factorise(&links, 1.0).advance(&start, &sources);
        let mut flows = [0.0; 3];
        network.link_flows(&links, &end, &mut flows);
        let residual = network.heat_gained_j(&start, &end) - (75.0 - flows[2]);
        assert!(residual.abs() < 1e-9, "residual {residual} W");
    }

    #[test]
    fn elimination_solves_what_a_dense_solver_solves() {
        let (network, links, _) = three_node_chain();
        let start = [300.0, 290.0, 310.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let end = network.factorise(&links, 2.0).advance(&start, &[0.0; MAXIMUM_NODES]);
        let dense = nalgebra::Matrix3::new(520.0, -20.0, 0.0, -20.0, 275.0, -5.0, 0.0, -5.0, 107.0);
        let right = nalgebra::Vector3::new(500.0 * 300.0, 250.0 * 290.0, 100.0 * 310.0 + 560.0);
        let reference = dense.lu().solve(&right).expect("regular");
        for i in 0..3 {
            assert!((end[i] - reference[i]).abs() < 1e-9);
        }
    }
}
