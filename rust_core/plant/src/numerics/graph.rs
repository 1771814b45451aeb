//! Nodes of a network and what a link connects: positions only, no numbers.

/// Index of a node in temperatures and heat sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Node(pub u8);

impl Node {
    /// Node number `position` of a network.
    #[must_use]
    pub const fn new(position: u8) -> Self {
        Self(position)
    }

    /// Position in arrays of node values.
    #[must_use]
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Which nodes a link connects; `None` is the surroundings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    pub const fn between(from: Node, to: Node) -> Self {
        Self { loses: Some(from), gains: Some(to), hot: Some(from), cold: Some(to) }
    }

    /// Plain conduction from a node to the surroundings; their temperature is the (negative) offset.
    #[must_use]
    pub const fn to_surroundings(from: Node) -> Self {
        Self { loses: Some(from), gains: None, hot: Some(from), cold: None }
    }
}
