//! Kinds of configuration files that a trip is made from.

use hp_plant::config::library::Kind;

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// Rules and their parameters: `controllers/*.toml`.
pub const CONTROLLER: Kind = Kind { word: "controller", ending: "toml", files: embedded::CONTROLLERS };

/// A scenario: `scenarios/**/*.toml`.
pub const SCENARIO: Kind = Kind { word: "scenario", ending: "toml", files: embedded::SCENARIOS };

/// Speed against time: `cycles/*.csv`.
pub const CYCLE: Kind = Kind { word: "drive cycle", ending: "csv", files: embedded::CYCLES };
