//! A value of a file as a type.

use super::validate::Validate;
use crate::error::{PlantError, PlantResult};
use serde::de::DeserializeOwned;
use toml::Value;

/// A section's value as parameters, checked.
///
/// # Errors
/// One of its keys is missing or unknown, or a value is not allowed.
pub fn read_value<T: DeserializeOwned + Validate>(name: &str, section: &str, value: Value) -> PlantResult<T> {
    let parameters: T = deserialized(name, section, value)?;
    parameters.validate().map_err(|violation| violation.within(section).in_file(name))?;
    Ok(parameters)
}

/// A value as a type, its checks still to come; `section` is where it stands.
///
/// # Errors
/// A key is missing or unknown, or a value is of the wrong type.
pub fn deserialized<T: DeserializeOwned>(name: &str, section: &str, value: Value) -> PlantResult<T> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        let inner = error.into_inner().message().to_owned();
        let place = match (section, path.as_str()) {
            ("", ".") => String::new(),
            ("", path) => format!("`{path}`: "),
            (section, ".") => format!("`{section}`: "),
            (section, path) => format!("`{section}.{path}`: "),
        };
        PlantError::Syntax { file: name.to_owned(), message: format!("{place}{}", inner.trim()) }
    })
}
