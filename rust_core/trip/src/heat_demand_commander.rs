//! heatDemandCommander: requested heat flows, constant or by schedule (paper section 2.5), and connections that
//! follow a schedule instead of the controller (paper section 4).

use hp_plant::architecture::flaw::among;
use hp_plant::architecture::layout::Layout;
use hp_plant::command::{Demand, MAXIMUM_REQUEST_W};
use hp_plant::config::{Validate, Violation, check_range};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

/// Requested heat flows [W]: constants, then changes in time. In a file each member's constant has a key of its own,
/// `battery_w`; nothing limits members that are not named.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatDemandParameters {
    /// Constants by member.
    pub constants_w: BTreeMap<String, f64>,
    /// Changes, in order of time.
    pub schedule: Vec<HeatDemandChange>,
}

/// As a file gives it.
#[derive(Deserialize)]
struct InFile {
    #[serde(default)]
    schedule: Vec<HeatDemandChange>,
    #[serde(flatten)]
    constants_w: BTreeMap<String, f64>,
}

impl<'de> Deserialize<'de> for HeatDemandParameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let file = InFile::deserialize(deserializer)?;
        let mut constants_w = BTreeMap::new();
        for (key, value) in file.constants_w {
            let member = key.strip_suffix("_w").ok_or_else(|| {
                D::Error::custom(format!("unknown field `{key}`, expected `schedule` or `<member>_w`"))
            })?;
            constants_w.insert(member.to_owned(), value);
        }
        Ok(Self { constants_w, schedule: file.schedule })
    }
}

/// From a time on, one member's requested heat flow.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatDemandChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: String,
    /// Heat flow [W].
    pub heat_flow_w: f64,
}

impl Validate for HeatDemandParameters {
    fn validate(&self) -> Result<(), Violation> {
        for (member, &value) in &self.constants_w {
            check_range(&format!("{member}_w"), value, 0.0, MAXIMUM_REQUEST_W)?;
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
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConnectionChange {
    /// Time since the start [s].
    pub from_s: f64,
    /// Member.
    pub member: String,
    /// Loop, or `isolated`.
    pub connection: String,
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

/// From a time on, the value of a row of the demand.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RowChange {
    from_s: f64,
    row: usize,
    value: f64,
}

/// The heatDemandCommander of one vehicle: rows and values instead of names.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatDemandCommander {
    /// Everything off, with the constant requests.
    requested: Demand,
    requests: Vec<RowChange>,
    connections: Vec<RowChange>,
}

impl HeatDemandCommander {
    /// The commander of a scenario for a vehicle.
    ///
    /// # Errors
    /// A schedule names a member or connection that the vehicle does not have.
    pub fn of(
        parameters: &HeatDemandParameters,
        schedule: &[ConnectionChange],
        idle: Demand,
        layout: &Layout,
    ) -> Result<Self, Violation> {
        let mut requested = idle;
        for (member, &value) in &parameters.constants_w {
            let place = layout.member(member);
            if let Some(row) = place.and_then(|place| layout.members[place].request_row) {
                requested[row] = value;
            }
        }
        let mut requests = Vec::with_capacity(parameters.schedule.len());
        for (i, change) in parameters.schedule.iter().enumerate() {
            let member = scheduled(layout, &format!("heat_demand.schedule[{i}].member"), &change.member)?;
            let row = layout.members[member].request_row.unwrap_or(0);
            requests.push(RowChange { from_s: change.from_s, row, value: change.heat_flow_w });
        }
        let mut connections = Vec::with_capacity(schedule.len());
        for (i, change) in schedule.iter().enumerate() {
            let member = scheduled(layout, &format!("connection_schedule[{i}].member"), &change.member)?;
            let row = layout.members[member].connection_row.unwrap_or(0);
            let options: Vec<&str> = layout.actuators[row].options().iter().map(String::as_str).collect();
            let option = options.iter().position(|option| *option == change.connection).ok_or_else(|| {
                let key = format!("connection_schedule[{i}].connection");
                Violation::new(key, format!("`{}`", change.connection), among(&options, &change.connection))
            })?;
            connections.push(RowChange { from_s: change.from_s, row, value: option as f64 });
        }
        Ok(Self { requested, requests, connections })
    }

    /// Whether requests change in time.
    #[must_use]
    pub fn requests_change(&self) -> bool {
        !self.requests.is_empty()
    }

    /// Everything off, with the requests of a time.
    #[must_use]
    pub fn requested(&self, time_s: f64) -> Demand {
        let mut demand = self.requested;
        self.change_requests(time_s, &mut demand);
        demand
    }

    /// Everything off, with the constant requests.
    #[must_use]
    #[inline(always)]
    pub fn constant(&self) -> &Demand {
        &self.requested
    }

    /// Enters the requests that a schedule has changed up to a time.
    #[inline(always)]
    pub fn change_requests(&self, time_s: f64, demand: &mut Demand) {
        for change in self.requests.iter().take_while(|change| change.from_s <= time_s) {
            demand[change.row] = change.value;
        }
    }

    /// Replaces the connections that a schedule fixes at a time.
    #[inline]
    pub fn apply_schedule(&self, time_s: f64, demand: &mut Demand) {
        for change in self.connections.iter().take_while(|change| change.from_s <= time_s) {
            demand[change.row] = change.value;
        }
    }
}

/// A member that a schedule names and that can be connected.
fn scheduled(layout: &Layout, key: &str, name: &str) -> Result<usize, Violation> {
    let connectable = |member: &usize| layout.members[*member].connection_row.is_some();
    layout.member(name).filter(connectable).ok_or_else(|| {
        let members = layout.members.iter().filter(|member| member.connection_row.is_some());
        let names: Vec<&str> = members.map(|member| member.name.as_str()).collect();
        Violation::new(key, format!("`{name}`"), among(&names, name))
    })
}
