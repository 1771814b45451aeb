//! Kinds of configuration files that a trip is made from.

use hp_plant::config::kinds::VEHICLE;
use hp_plant::config::library::{Kind, Reference};

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// Rules and their parameters: `controllers/*.toml`.
pub const CONTROLLER: Kind =
    Kind { word: "controller", ending: "toml", files: embedded::CONTROLLERS, references: &[] };

/// A scenario: `scenarios/**/*.toml`.
pub const SCENARIO: Kind = Kind {
    word: "scenario",
    ending: "toml",
    files: embedded::SCENARIOS,
    references: &[
        Reference { path: &["vehicle"], kind: &VEHICLE, brings: &[] },
        Reference { path: &["cycle"], kind: &CYCLE, brings: &[] },
        Reference { path: &["controller"], kind: &CONTROLLER, brings: &[] },
        Reference { path: &["climate", "series"], kind: &SERIES, brings: &[] },
        Reference { path: &["settings", "series"], kind: &SERIES, brings: &[] },
    ],
};

/// Climate or settings against time, none of which is built in.
pub const SERIES: Kind = Kind { word: "series", ending: "csv", files: &[], references: &[] };

/// Speed against time: `cycles/*.csv`.
pub const CYCLE: Kind = Kind { word: "drive cycle", ending: "csv", files: embedded::CYCLES, references: &[] };
