//! Kinds of configuration files that only the Python side reads.

use hp_plant::config::library::Kind;

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// Free parameters and targets: `calibration/*.toml`.
pub const CALIBRATION: Kind =
    Kind { word: "calibration", ending: "toml", files: embedded::CALIBRATIONS, references: &[] };

/// Held-out trips: `benchmark/*.toml`.
pub const BENCHMARK: Kind =
    Kind { word: "benchmark", ending: "toml", files: embedded::BENCHMARKS, references: &[] };

/// Published values and how the model is set beside them: `validation/*.toml`.
pub const VALIDATION: Kind =
    Kind { word: "validation", ending: "toml", files: embedded::VALIDATIONS, references: &[] };

/// A training: `agents/*.toml`.
pub const TRAINING: Kind =
    Kind { word: "training configuration", ending: "toml", files: embedded::TRAININGS, references: &[] };
