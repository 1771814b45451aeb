//! Configuration: TOML files to typed, checked parameters.

pub mod battery;
pub mod cabin;
pub mod controller;
pub mod coolant;
pub mod library;
pub mod powertrain;
pub mod refrigeration;
pub mod scenario;
mod validate;
pub mod vehicle;

pub use validate::{Celsius, Validate, Violation, ZERO_CELSIUS_K, check_range};
