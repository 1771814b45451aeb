//! The energy ledger of the whole vehicle, wheel and cell to ambient.
//!
//! It counts boundary flows and stored energies only (all others count nothing, unless they are no numbers). It never
//! sees the network's matrix or the refrigerant solve, so an error in one of those shows up here.

use crate::architecture::layout::{FLOW_PLACES, Layout};
use crate::components::cabin_air::{SMALLEST_WATER_KG_S, WaterFlows};
use crate::flows::{Crossing, Flows};
use serde::{Deserialize, Serialize};
use wide::f64x4;

/// Energy stored in the vehicle, relative to fixed references [J].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StoredEnergyChange {
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Potential energy.
    pub potential_j: f64,
    /// Chemical energy of the cells.
    pub chemical_j: f64,
    /// Energy in the RC pairs.
    pub polarisation_j: f64,
    /// Heat in all thermal masses.
    pub heat_j: f64,
}

/// How each flow of a vehicle counts: -1 enters, 1 leaves, 0 does not cross the boundary. Air enters at ambient temperature,
/// so the exhaust is counted relative to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    crossings: [f64; FLOW_PLACES],
}

/// So many flows are summed up side by side.
const SIDE_BY_SIDE: usize = 4;

/// Smallest power that the residual is compared with [W].
pub const SMALLEST_POWER_W: f64 = 1000.0;

/// Outcome of the ledger for one step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LedgerEntry {
    /// Change of stored energy less what crossed the boundary [W].
    pub residual_w: f64,
    /// Power in play: the largest flow or change of store, at least [`SMALLEST_POWER_W`] [W].
    pub scale_w: f64,
}

impl LedgerEntry {
    /// Residual as a share of the power in play [-].
    #[must_use]
    pub fn relative(&self) -> f64 {
        self.residual_w.abs() / self.scale_w
    }
}

/// Outcome of the ledger of water for one step: what is stored in the air of a cabin and on its windscreen against what enters
/// and leaves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WaterEntry {
    /// Change of stored water less what crossed the boundary [kg/s].
    pub residual_kg_s: f64,
    /// Water in play: the largest flow or change of store, at least [`SMALLEST_WATER_KG_S`] [kg/s].
    pub scale_kg_s: f64,
}

impl WaterEntry {
    /// Balances a step in which so much more water was stored.
    #[must_use]
    #[inline]
    pub fn balance(flows: &WaterFlows, stored_kg: f64, step_s: f64) -> Self {
        let stored_kg_s = stored_kg / step_s;
        let entering = [flows.fresh_kg_s, flows.occupants_kg_s];
        let leaving = [flows.exhaust_kg_s, flows.core_kg_s, flows.drained_kg_s];
        let largest = |flows: &[f64]| flows.iter().fold(0.0, |most: f64, flow| most.max(flow.abs()));
        Self {
            residual_kg_s: stored_kg_s - entering.iter().sum::<f64>() + leaving.iter().sum::<f64>(),
            scale_kg_s: largest(&entering)
                .max(largest(&leaving))
                .max(stored_kg_s.abs())
                .max(SMALLEST_WATER_KG_S),
        }
    }

    /// Residual as a share of the water in play [-]; 0 before the first step.
    #[must_use]
    pub fn relative(&self) -> f64 {
        self.residual_kg_s.abs() / self.scale_kg_s.max(SMALLEST_WATER_KG_S)
    }
}

impl Ledger {
    /// The ledger of a layout.
    #[must_use]
    pub fn of(layout: &Layout) -> Self {
        let mut crossings = [0.0; FLOW_PLACES];
        for row in &layout.flows {
            crossings[row.flow.index()] = match row.crossing {
                Crossing::Enters => -1.0,
                Crossing::Leaves => 1.0,
                Crossing::Inside => 0.0,
            };
        }
        Self { crossings }
    }

    /// Balances a step with so many flows, perhaps known while compiling.
    #[must_use]
    #[inline(always)]
    pub fn balance(
        &self,
        count: usize,
        flows: &Flows,
        stored: &StoredEnergyChange,
        step_s: f64,
    ) -> LedgerEntry {
        let stores_w = f64x4::new(
            [stored.kinetic_j + stored.potential_j, stored.chemical_j, stored.polarisation_j, stored.heat_j]
                .map(|joule| joule / step_s),
        );
        let mut residuals_w = stores_w;
        let mut scales_w = stores_w.abs();
        let (flows, _) = flows.values().as_chunks::<SIDE_BY_SIDE>();
        let (crossings, _) = self.crossings.as_chunks::<SIDE_BY_SIDE>();
        for group in 0..count.div_ceil(SIDE_BY_SIDE).min(FLOW_PLACES / SIDE_BY_SIDE) {
            let crossing_w = f64x4::new(flows[group]) * f64x4::new(crossings[group]);
            residuals_w += crossing_w;
            // In this order what is no number spoils the residual only.
            scales_w = crossing_w.abs().fast_max(scales_w);
        }
        let pair = |values: f64x4, join: fn(f64, f64) -> f64| {
            let values = values.to_array();
            join(join(values[0], values[1]), join(values[2], values[3]))
        };
        LedgerEntry {
            residual_w: pair(residuals_w, |a, b| a + b),
            scale_w: pair(scales_w, f64::max).max(SMALLEST_POWER_W),
        }
    }
}
