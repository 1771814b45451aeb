//! The vehicle's thermal network: the links of an architecture with this moment's conductances, stepped by one of two
//! executors that agree to the last bit.
//!
//! [`compiled`] is made while compiling for the shapes of the built-in architectures, [`planned`] when any other is loaded.

pub mod built_in;
pub mod compiled;
pub mod conditions;
pub mod planned;
pub mod shape;

use crate::architecture::indices::OwnedIndices;
use crate::architecture::layout::Layout;
use crate::numerics::planned_network::TooLarge;
use crate::numerics::thermal_network::{NodeValues, heat_gained_j};
use built_in::Shaped;
use conditions::Constants;
use planned::PlannedWiring;

/// Most places where heat enters loops.
pub const INLET_PLACES: usize = 3;

/// What is known of a loop's supply before the step is solved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Forecast {
    /// Its temperature at the end of the step with the heat known so far [K].
    pub base_k: f64,
    /// Its change per watt that enters there [K/W].
    pub sensitivity_k_w: f64,
}

/// Network of a vehicle.
#[derive(Debug, Clone)]
pub struct Network {
    pub(crate) indices: OwnedIndices,
    pub(crate) capacities_j_k: NodeValues,
    pub(crate) constants: Constants,
    /// The compiled shape, if the architecture has one.
    pub(crate) shaped: Option<Shaped>,
    pub(crate) planned: Option<PlannedWiring>,
    nodes: usize,
}

impl Network {
    /// The network of a layout; heat capacities by node.
    ///
    /// # Errors
    /// It is too large to be planned.
    pub fn new(layout: &Layout, capacities_j_k: NodeValues, constants: Constants) -> Result<Self, TooLarge> {
        let indices = OwnedIndices::of(layout);
        let shaped = Shaped::of(&indices.view());
        let planned = shaped.is_none().then(|| PlannedWiring::of(&indices.view())).transpose()?;
        Ok(Self { indices, capacities_j_k, constants, shaped, planned, nodes: layout.nodes.len() })
    }

    /// The same, stepped by the executor for any architecture; a compiled one that is too large for it stays compiled.
    #[must_use]
    pub fn planned(mut self) -> Self {
        if let Ok(planned) = PlannedWiring::of(&self.indices.view()) {
            (self.shaped, self.planned) = (None, Some(planned));
        }
        self
    }

    /// Whether its shape was compiled.
    #[must_use]
    pub fn is_compiled(&self) -> bool {
        self.shaped.is_some()
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Heat capacities of the nodes [J/K].
    #[must_use]
    pub fn capacities_j_k(&self) -> &NodeValues {
        &self.capacities_j_k
    }

    /// Heat gained between two sets of temperatures [J].
    #[must_use]
    pub fn heat_gained_j(&self, before_k: &NodeValues, after_k: &NodeValues) -> f64 {
        heat_gained_j(self.nodes, &self.capacities_j_k, before_k, after_k)
    }
}
