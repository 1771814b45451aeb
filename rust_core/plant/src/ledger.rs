//! The energy ledger of the whole vehicle, wheel and cell to ambient.
//!
//! It counts boundary flows and stored energies only (all others count nothing, unless they are no numbers). It never
//! sees the network's matrix or the refrigerant solve, so an error in one of those shows up here.

use crate::flows::{FLOW_COUNT, Flow, Flows};
use serde::{Deserialize, Serialize};

/// Energy stored in the vehicle, relative to fixed references [J].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StoredEnergyChange {
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Chemical energy of the cells.
    pub chemical_j: f64,
    /// Energy in the RC pairs.
    pub polarisation_j: f64,
    /// Heat in all thermal masses.
    pub heat_j: f64,
}

/// Flows that enter the vehicle.
pub const INFLOWS: [Flow; 4] = [Flow::Solar, Flow::Occupants, Flow::AmbientChiller, Flow::Unserved];

/// Flows that leave the vehicle. Air enters at ambient temperature, so the exhaust is counted relative to it.
pub const OUTFLOWS: [Flow; 17] = [
    Flow::Drag,
    Flow::Rolling,
    Flow::FrictionBrake,
    Flow::Auxiliary,
    Flow::Fan,
    Flow::CompressorLoss,
    Flow::HtcSupplyHose,
    Flow::HtcReturnHose,
    Flow::ChillerSupplyHose,
    Flow::ChillerReturnHose,
    Flow::AmbientHtc,
    Flow::BatteryAmbient,
    Flow::MotorAmbient,
    Flow::TransmissionAmbient,
    Flow::ThermalBatteryAmbient,
    Flow::PanelAmbient,
    Flow::ExhaustAmbient,
];

/// How each flow counts: -1 enters, 1 leaves, 0 does not cross the boundary.
const CROSSINGS: [f64; FLOW_COUNT] = {
    let mut crossings = [0.0; FLOW_COUNT];
    let mut place = 0;
    while place < INFLOWS.len() {
        crossings[INFLOWS[place] as usize] = -1.0;
        place += 1;
    }
    place = 0;
    while place < OUTFLOWS.len() {
        crossings[OUTFLOWS[place] as usize] = 1.0;
        place += 1;
    }
    crossings
};

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

/// Balances a step.
#[must_use]
pub fn balance(flows: &Flows, stored: &StoredEnergyChange, step_s: f64) -> LedgerEntry {
    let stores_w: [f64; SIDE_BY_SIDE] =
        [stored.kinetic_j, stored.chemical_j, stored.polarisation_j, stored.heat_j]
            .map(|joule| joule / step_s);
    let mut residuals_w = stores_w;
    let mut scales_w = stores_w.map(f64::abs);
    let (flows, last_flows) = flows.values().as_chunks::<SIDE_BY_SIDE>();
    let (crossings, last_crossings) = CROSSINGS.as_chunks::<SIDE_BY_SIDE>();
    for (flows, crossings) in flows.iter().zip(crossings) {
        for place in 0..SIDE_BY_SIDE {
            let crossing_w = flows[place] * crossings[place];
            residuals_w[place] += crossing_w;
            scales_w[place] = scales_w[place].max(crossing_w.abs());
        }
    }
    for (place, (flow, crossing)) in last_flows.iter().zip(last_crossings).enumerate() {
        residuals_w[place] += flow * crossing;
        scales_w[place] = scales_w[place].max((flow * crossing).abs());
    }
    let pair = |values: [f64; SIDE_BY_SIDE], join: fn(f64, f64) -> f64| {
        join(join(values[0], values[1]), join(values[2], values[3]))
    };
    LedgerEntry {
        residual_w: pair(residuals_w, |a, b| a + b),
        scale_w: pair(scales_w, f64::max).max(SMALLEST_POWER_W),
    }
}
