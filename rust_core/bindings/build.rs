//! Compiles the configuration files of this crate's kinds in.

use hp_embed::{Folder, embed};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    embed(&[
        Folder { constant: "CALIBRATIONS", folder: "calibration", ending: "toml" },
        Folder { constant: "BENCHMARKS", folder: "benchmark", ending: "toml" },
        Folder { constant: "TRAININGS", folder: "agents", ending: "toml" },
    ])
}
