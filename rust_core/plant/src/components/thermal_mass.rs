//! A mass that takes up heat and gives it off, and produces none: what the network has to know of it.

use crate::config::{Validate, read_value};
use crate::error::PlantResult;
use serde::de::DeserializeOwned;
use toml::Value;

/// Numbers of a passive mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThermalMass {
    /// Heat capacity [J/K].
    pub heat_capacity_j_k: f64,
    /// Coolant conductance [W/K].
    pub coolant_ua_w_k: f64,
    /// Loss conductance to ambient [W/K].
    pub ambient_conductance_w_k: f64,
}

/// Reads the numbers of a passive mass: file, section, value of the section.
pub type ReadMass = fn(&str, &str, Value) -> PlantResult<ThermalMass>;

/// Reads a section as the parameters of a kind, and takes from them what the network has to know.
///
/// # Errors
/// A key is missing or unknown, or a value is not allowed.
pub fn read<T>(file: &str, section: &str, value: Value) -> PlantResult<ThermalMass>
where
    T: DeserializeOwned + Validate,
    ThermalMass: From<T>,
{
    read_value::<T>(file, section, value).map(ThermalMass::from)
}
