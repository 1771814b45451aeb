//! The whole state of a vehicle: plain data, so that a snapshot is a copy.

use crate::architecture::layout::{
    BRANCH_PLACES, CABIN_PLACES, FRONT_END_PLACES, HEATER_PLACES, LOOP_PLACES,
};
use crate::circuits::refrigeration_loop::RefrigerationState;
use crate::components::battery::BatteryState;
use crate::components::cabin_air::CabinAir;
use crate::components::frost::Frost;
use crate::components::pid::ResetPid;
use crate::components::pump::PumpState;
use crate::components::thermal_switch::ThermalSwitches;
use crate::numerics::thermal_network::NodeValues;
use serde::{Deserialize, Serialize};

/// State of the plant, its own controllers included. Arrays are in the order of the architecture's layout; what a vehicle
/// does not have stays 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Time since the start [s].
    pub time_s: f64,
    /// Temperatures of the thermal nodes [K].
    pub temperatures_k: NodeValues,
    /// Air of each cabin.
    pub cabin_air: [CabinAir; CABIN_PLACES],
    /// Battery charge and polarisation.
    pub battery: BatteryState,
    /// Which branches are connected.
    pub connected: [bool; BRANCH_PLACES],
    /// Thermal switches.
    pub switches: ThermalSwitches,
    /// Pumps, by loop.
    pub pumps: [PumpState; LOOP_PLACES],
    /// Controllers of the heaters.
    pub heater_pids: [ResetPid; HEATER_PLACES],
    /// Compressor power against condensing pressure.
    pub pressure_pid: ResetPid,
    /// Compressor envelope and last solution of the refrigerant loop.
    pub refrigeration: RefrigerationState,
    /// Condensing pressure at the end of the last step [Pa].
    pub condensing_pressure_pa: f64,
    /// Heat that each loop's exchanger brought in the last step [W].
    pub entered_w: [f64; LOOP_PLACES],
    /// Temperature rise of the air in each front-end exchanger that may be in front of others, in the last step [K].
    pub front_end_rise_k: [f64; FRONT_END_PLACES],
    /// The battery had less in the last step than driving, pumps, blower and fan asked for.
    pub short_of_power: bool,
    /// Frost on each front-end exchanger.
    pub frosts: [Frost; FRONT_END_PLACES],
    /// Power of all heaters in the last step [W].
    pub heater_power_w: f64,
    /// Compressor power of the last step [W].
    pub compressor_power_w: f64,
}
