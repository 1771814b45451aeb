//! heatDemandCommander: requested heat flows, constant or by schedule (paper section 2.5), and connections that
//! follow a schedule instead of the controller (paper section 4).

use hp_plant::command::{Connection, MAXIMUM_REQUEST_W, Member};
use hp_plant::config::{Validate, Violation, check_range};
use serde::{Deserialize, Serialize};

/// Requested heat flows [W]: constants, then changes in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatDemandParameters {
    /// Battery.
    pub battery_w: f64,
    /// Motor and inverter.
    pub motor_w: f64,
    /// Transmission.
    pub transmission_w: f64,
    /// Ambient.
    pub ambient_w: f64,
    /// Thermal battery.
    pub thermal_battery_w: f64,
    /// Cabin.
    pub cabin_w: f64,
    /// Changes, in order of time.
    #[serde(default)]
    pub schedule: Vec<HeatDemandChange>,
}

/// From a time on, one member's requested heat flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatDemandChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: Member,
    /// Heat flow [W].
    pub heat_flow_w: f64,
}

impl HeatDemandParameters {
    /// Constants, by member.
    #[must_use]
    pub fn constants_w(&self) -> [f64; 6] {
        [
            self.battery_w,
            self.motor_w,
            self.transmission_w,
            self.ambient_w,
            self.thermal_battery_w,
            self.cabin_w,
        ]
    }
}

impl Validate for HeatDemandParameters {
    fn validate(&self) -> Result<(), Violation> {
        let keys = ["battery_w", "motor_w", "transmission_w", "ambient_w", "thermal_battery_w", "cabin_w"];
        for (key, value) in keys.into_iter().zip(self.constants_w()) {
            check_range(key, value, 0.0, MAXIMUM_REQUEST_W)?;
        }
        check_order("schedule", self.schedule.iter().map(|change| change.from_s))?;
        for (i, change) in self.schedule.iter().enumerate() {
            let key = format!("schedule[{i}].heat_flow_w");
            check_range(&key, change.heat_flow_w, 0.0, MAXIMUM_REQUEST_W)?;
        }
        Ok(())
    }
}

/// From a time on, one member's connection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConnectionChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: Member,
    /// Connection.
    pub connection: Connection,
}

/// Checks that the times of a schedule rise.
pub(crate) fn check_order(key: &str, times: impl Iterator<Item = f64>) -> Result<(), Violation> {
    let mut last = 0.0;
    for (i, time) in times.enumerate() {
        let key = format!("{key}[{i}].from_s");
        check_range(&key, time, 0.0, 1e7)?;
        if time < last {
            return Err(Violation::new(
                key,
                time,
                format!("must not be before the change above it ({last} s)"),
            ));
        }
        last = time;
    }
    Ok(())
}

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
