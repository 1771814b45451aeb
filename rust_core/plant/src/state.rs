//! The whole state of a vehicle: plain data, so that a snapshot is a copy.

use crate::circuits::branches::{BRANCH_COUNT, Branch};
use crate::circuits::refrigeration_loop::RefrigerationState;
use crate::command::{Connection, Member};
use crate::components::battery::BatteryState;
use crate::components::pid::ResetPid;
use crate::components::pump::PumpState;
use crate::control::thermal_switch::ThermalSwitches;
use crate::numerics::thermal_network::NodeValues;
use serde::{Deserialize, Serialize};

/// State of the plant, its own controllers included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time since the start [s].
    pub time_s: f64,
    /// Temperatures of the thermal nodes [K].
    pub temperatures_k: NodeValues,
    /// Battery charge and polarisation.
    pub battery: BatteryState,
    /// Which branches are connected.
    pub connected: [bool; BRANCH_COUNT],
    /// Thermal switches.
    pub switches: ThermalSwitches,
    /// HTC pump.
    pub htc_pump: PumpState,
    /// Chiller pump.
    pub chiller_pump: PumpState,
    /// PTC controller.
    pub ptc_pid: ResetPid,
    /// Compressor power against condensing pressure.
    pub pressure_pid: ResetPid,
    /// Compressor envelope and last solution of the refrigerant loop.
    pub refrigeration: RefrigerationState,
    /// Condensing pressure at the end of the last step [Pa].
    pub condensing_pressure_pa: f64,
    /// Condenser heat flow of the last step [W].
    pub condenser_heat_flow_w: f64,
    /// PTC power of the last step [W].
    pub ptc_power_w: f64,
    /// Compressor power of the last step [W].
    pub compressor_power_w: f64,
}

impl State {
    /// Which loop a member is connected to.
    #[must_use]
    pub fn connection(&self, member: Member) -> Connection {
        let own = |(branch, on): &(Branch, bool)| *on && branch.member() == member;
        let connected = Branch::ALL.into_iter().zip(self.connected).find(own);
        connected.map_or(Connection::Isolated, |(branch, _)| branch.connection())
    }
}
