//! Configuration: TOML files to typed, checked parameters.

pub mod controller;
pub mod library;
pub mod scenario;
mod validate;
pub mod vehicle;

pub use validate::{Celsius, Validate, Violation, ZERO_CELSIUS_K, check_range};
