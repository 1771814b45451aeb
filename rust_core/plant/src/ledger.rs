//! The energy ledger of the whole vehicle, wheel and cell to ambient.
//!
//! It knows boundary flows and stored energies only. It never sees the network's matrix, the refrigerant
//! solve or any flow inside the vehicle, so an error in one of those shows up here.

use crate::flows::{Flow, Flows};
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
    let stores_w = [stored.kinetic_j, stored.chemical_j, stored.polarisation_j, stored.heat_j]
        .map(|joule| joule / step_s);
    let mut residual_w: f64 = stores_w.iter().sum();
    let mut scale_w = stores_w.iter().fold(SMALLEST_POWER_W, |largest, power| largest.max(power.abs()));
    for flow in INFLOWS {
        residual_w -= flows[flow];
        scale_w = scale_w.max(flows[flow].abs());
    }
    for flow in OUTFLOWS {
        residual_w += flows[flow];
        scale_w = scale_w.max(flows[flow].abs());
    }
    LedgerEntry { residual_w, scale_w }
}
