//! Compiles the configuration files of this crate's kinds in.

use hp_embed::{Folder, embed};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    embed(&[
        Folder { constant: "EPISODES", folder: "episodes", ending: "toml" },
        Folder { constant: "REWARDS", folder: "rewards", ending: "toml" },
    ])
}
