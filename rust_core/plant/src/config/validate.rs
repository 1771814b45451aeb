//! Range checks that name the key: every parameter declares what is allowed where it is declared.

use crate::error::PlantError;
use serde::{Deserialize, Serialize};

/// A value outside its range; the loader adds the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Violation {
    /// Dotted path of the key.
    pub key: String,
    /// Value found.
    pub value: String,
    /// What is allowed, as "must be ...".
    pub allowed: String,
}

impl Violation {
    /// A violation at `key`.
    pub fn new(key: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The same violation seen from one level further out.
    #[must_use]
    pub fn within(mut self, section: &str) -> Self {
        self.key = if self.key.is_empty() { section.to_owned() } else { format!("{section}.{}", self.key) };
        self
    }
}

impl Violation {
    /// The error for a file.
    #[must_use]
    pub fn in_file(self, file: &str) -> PlantError {
        PlantError::OutOfRange {
            file: file.to_owned(),
            key: self.key,
            value: self.value,
            allowed: self.allowed,
        }
    }
}

/// Parameters that know what values they accept.
pub trait Validate {
    /// Checks every value; the first violation is returned.
    ///
    /// # Errors
    /// The first value outside its range.
    fn validate(&self) -> Result<(), Violation>;
}

/// A section that may be absent.
impl<T: Validate> Validate for Option<T> {
    fn validate(&self) -> Result<(), Violation> {
        self.as_ref().map_or(Ok(()), Validate::validate)
    }
}

/// A temperature that configuration files give in degC and the plant uses in kelvin.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Celsius(pub f64);

/// 0 degC in kelvin.
pub const ZERO_CELSIUS_K: f64 = 273.15;

impl Celsius {
    /// The temperature in kelvin.
    #[must_use]
    #[inline]
    pub fn kelvin(self) -> f64 {
        self.0 + ZERO_CELSIUS_K
    }
}

/// What a range check reads from a value.
pub trait Scalar: Copy {
    /// The number that is compared with the limits, in the unit of the file.
    fn number(self) -> f64;
}

impl Scalar for f64 {
    fn number(self) -> f64 {
        self
    }
}

impl Scalar for u32 {
    fn number(self) -> f64 {
        f64::from(self)
    }
}

impl Scalar for Celsius {
    fn number(self) -> f64 {
        self.0
    }
}

/// Checks one value against an inclusive range.
///
/// # Errors
/// The value is not finite or outside `low..=high`.
pub fn check_range<T: Scalar>(key: &str, value: T, low: f64, high: f64) -> Result<(), Violation> {
    let number = value.number();
    if number >= low && number <= high {
        Ok(())
    } else {
        Err(Violation::new(key, number, format!("must be between {low} and {high}")))
    }
}

/// Declares a parameter struct: each scalar with its allowed range, each nested section checked in turn.
///
/// Unknown keys are refused; the docstring of each field is its documentation.
#[macro_export]
macro_rules! parameters {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $( $(#[$field_meta:meta])* $field:ident : $type:ty = $low:literal .. $high:literal, )*
            $( ; $( $(#[$nested_meta:meta])* $nested:ident : $nested_type:ty, )* )?
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $( $(#[$field_meta])* pub $field: $type, )*
            $( $( $(#[$nested_meta])* pub $nested: $nested_type, )* )?
        }

        impl $crate::config::Validate for $name {
            fn validate(&self) -> Result<(), $crate::config::Violation> {
                $( $crate::config::check_range(stringify!($field), self.$field, $low as f64, $high as f64)?; )*
                $( $( $crate::config::Validate::validate(&self.$nested)
                    .map_err(|violation| violation.within(stringify!($nested)))?; )* )?
                Ok(())
            }
        }
    };
}
