//! Compiles the configuration files of this crate's kinds in.

use hp_embed::{Folder, embed};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    embed(&[
        Folder { constant: "CONTROLLERS", folder: "controllers", ending: "toml" },
        Folder { constant: "SCENARIOS", folder: "scenarios", ending: "toml" },
        Folder { constant: "CYCLES", folder: "cycles", ending: "csv" },
    ])
}
