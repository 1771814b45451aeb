//! The plant's own switches.

pub mod thermal_switch;
