//! Compiles the configuration files of this crate's kinds in.

use hp_embed::{Folder, embed};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    embed(&[
        Folder { constant: "VEHICLES", folder: "vehicles", ending: "toml" },
        Folder { constant: "REFRIGERANTS", folder: "refrigerants", ending: "csv" },
    ])
}
