//! Controllers: the plant's own PIDs and switches, the HPCU, schedules.

pub mod heat_demand_commander;
pub mod hpcu;
pub mod pid;
pub mod thermal_switch;
pub(crate) mod vehicle_controls;
