//! Numerical building blocks; nothing here knows physics.

pub mod cubic_table;
pub mod dual;
pub mod elementary;
pub(crate) mod elimination;
pub mod interpolation;
pub mod root;
pub mod thermal_network;
pub mod three_equations;
pub mod topology;
