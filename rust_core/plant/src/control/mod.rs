//! The plant's own switches and controls.

pub mod thermal_switch;
pub(crate) mod vehicle_controls;
