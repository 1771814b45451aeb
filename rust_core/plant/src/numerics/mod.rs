//! Numerical building blocks; nothing here knows physics.

pub mod cubic_table;
pub mod dual;
pub mod elementary;
pub(crate) mod elimination;
pub mod graph;
pub mod interpolation;
pub mod planned_network;
pub mod root;
pub mod thermal_network;
pub mod three_equations;
