//! Kinds of configuration files that a decision process is made from.

use hp_plant::config::library::{EACH, Kind, Reference};
use hp_trip::kinds::{CYCLE, SCENARIO};

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/embedded.rs"));
}

/// A distribution of trips: `episodes/*.toml`.
pub const EPISODES: Kind = Kind {
    word: "distribution of episodes",
    ending: "toml",
    files: embedded::EPISODES,
    references: &[
        Reference { path: &["scenario"], kind: &SCENARIO, brings: &[] },
        Reference { path: &["cycles", EACH, "name"], kind: &CYCLE, brings: &[] },
    ],
};

/// Weights of the reward's terms: `rewards/*.toml`.
pub const REWARD: Kind = Kind { word: "reward", ending: "toml", files: embedded::REWARDS, references: &[] };
