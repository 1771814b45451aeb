//! heatDemandCommander: requested heat flows, constant or by schedule (paper section 2.5), and connections that
//! follow a schedule instead of the HPCU (paper section 4).

use crate::command::Connection;
use crate::config::scenario::{ConnectionChange, HeatDemandParameters};

/// Requested heat flow of each member at a time [W].
#[must_use]
pub fn requests_w(parameters: &HeatDemandParameters, time_s: f64) -> [f64; 6] {
    let mut requests = parameters.constants_w();
    for change in parameters.schedule.iter().take_while(|change| change.from_s <= time_s) {
        requests[change.member as usize] = change.heat_flow_w;
    }
    requests
}

/// Replaces the connections that a schedule fixes at a time.
pub fn apply_schedule(schedule: &[ConnectionChange], time_s: f64, connections: &mut [Connection; 6]) {
    for change in schedule.iter().take_while(|change| change.from_s <= time_s) {
        connections[change.member as usize] = change.connection;
    }
}
