//! Controllers: the plant's own switches and controls, the HPCU, schedules.

pub mod heat_demand_commander;
pub mod hpcu;
pub mod thermal_switch;
pub(crate) mod vehicle_controls;
