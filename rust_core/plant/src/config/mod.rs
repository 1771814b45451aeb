//! Configuration: TOML files to typed, checked parameters.

pub mod bounded;
pub mod initial;
pub mod kinds;
pub mod library;
mod orders;
mod reading;
mod validate;
pub mod vehicle;

pub use reading::{deserialized, read_value};
pub use validate::{Celsius, Validate, Violation, ZERO_CELSIUS_K, check_range};
