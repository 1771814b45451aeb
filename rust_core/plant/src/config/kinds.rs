//! Kinds of configuration files that a plant is made from.

use crate::config::library::{Kind, Reference};

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// A vehicle: `vehicles/*.toml`.
pub const VEHICLE: Kind = Kind {
    word: "vehicle",
    ending: "toml",
    files: embedded::VEHICLES,
    references: &[
        Reference { path: &["architecture"], kind: &ARCHITECTURE, brings: &[] },
        Reference { path: &["refrigerant"], kind: &REFRIGERANT, brings: FLUID_LIMITS },
    ],
};

/// Limits of a vehicle that belong to its refrigerant.
pub const FLUID_LIMITS: &[&[&str]] = &[
    &["refrigeration", "maximum_pressure_bar"],
    &["refrigeration", "minimum_suction_pressure_bar"],
    &["refrigeration", "compressor", "maximum_discharge_temperature_degc"],
];

/// A thermal architecture: `architectures/*.toml`.
pub const ARCHITECTURE: Kind =
    Kind { word: "architecture", ending: "toml", files: embedded::ARCHITECTURES, references: &[] };

/// Properties of a refrigerant: `refrigerants/*.csv`.
pub const REFRIGERANT: Kind =
    Kind { word: "refrigerant", ending: "csv", files: embedded::REFRIGERANTS, references: &[] };
