//! Compiles the configuration files of this crate's kinds in, and writes the shapes of the built-in architectures as
//! constants.

use hp_embed::{Folder, embed};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

// Components say in their own files what an architecture has to know of them, so they and what they need are compiled here too.

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/architecture/mod.rs"]
mod architecture;

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/components/mod.rs"]
mod components;

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/error.rs"]
mod error;

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/config"]
mod config {
    pub mod bounded;
    mod reading;
    mod validate;
    pub use reading::read_value;
    pub use validate::{Celsius, Validate, Violation, ZERO_CELSIUS_K, check_range};
}

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/media"]
mod media {
    pub mod air;
    pub mod moist_air;
}

#[allow(dead_code, clippy::all, reason = "the crate uses and checks all of it")]
#[path = "src/numerics"]
mod numerics {
    pub mod dual;
    pub mod elementary;
    pub mod elimination;
    pub mod graph;
    pub mod interpolation;
    pub mod thermal_network;
}

/// Shapes of all architectures in a folder, and what finds that of a layout.
fn shapes(folder: &Path) -> Result<String, Box<dyn Error>> {
    let mut files =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    let mut code = String::new();
    let mut names = Vec::new();
    for file in &files {
        let declaration: architecture::declaration::Declaration = toml::from_str(&fs::read_to_string(file)?)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        let layout = architecture::layout::Layout::of(&declaration)
            .map_err(|flaw| format!("{}: {flaw}", file.display()))?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().replace('-', "_");
        let name = format!("Shape_{stem}");
        let own = architecture::indices::OwnedIndices::of(&layout);
        write_shape(&mut code, &name, &own)?;
        names.push(name);
    }
    write_finder(&mut code, &names)?;
    Ok(code)
}

/// The shape of an architecture as constants: what `Debug` prints of the lists is Rust.
fn write_shape(code: &mut String, name: &str, own: &architecture::indices::OwnedIndices) -> std::fmt::Result {
    writeln!(
        code,
        "#[allow(non_camel_case_types, reason = \"named after its file\")]\n#[derive(Debug)]\npub struct {name};\n\
         #[rustfmt::skip]\n#[allow(clippy::all, reason = \"written by a program\")]\nimpl Wiring for {name} {{"
    )?;
    let lists = [
        ("LOOPS", "", "LoopIndices", format!("{:?}", own.loops)),
        (
            "BRANCHES",
            "use crate::architecture::layout::BranchSide::*; ",
            "BranchIndices",
            format!("{:?}", own.branches),
        ),
        ("CABINS", "", "CabinLayout", format!("{:?}", own.cabins)),
        ("FRONT_ENDS", "", "FrontEndIndices", format!("{:?}", own.front_ends)),
        (
            "EXCHANGERS",
            "use crate::architecture::layout::ExchangerSide::*; ",
            "ExchangerIndices",
            format!("{:?}", own.exchangers),
        ),
        (
            "HEATERS",
            "use crate::architecture::layout::HeaterTarget::*; ",
            "HeaterIndices",
            format!("{:?}", own.heaters),
        ),
        ("LINKS", "use crate::architecture::wiring::Law::*; ", "Link", format!("{:?}", own.links)),
        ("PORTS", "", "LinkPorts", format!("{:?}", own.ports)),
        ("SOURCES", "", "HeatSource", format!("{:?}", own.sources)),
        ("INLETS", "", "Inlet", format!("{:?}", own.inlets)),
        ("KNOWN_FIRST", "", "Node", format!("{:?}", own.known_first)),
        ("BASE_LOADS", "", "Flow", format!("{:?}", own.base_loads)),
    ];
    writeln!(code, "    const INDICES: Indices<'static> = {{")?;
    for (list, uses, kind, values) in &lists {
        writeln!(code, "        const {list}: &[{kind}] = {{ {uses}&{values} }};")?;
    }
    let view = own.view();
    writeln!(
        code,
        "        Indices {{ nodes: {}, stores: {}, battery: {:?}, motor: {:?}, transmission: {:?}, \
         compressor_row: {:?}, set_point_row: {:?}, flows: {}, actuators: {}, weights: {}, {} }}\n    }};\n}}",
        view.nodes,
        view.stores,
        view.battery,
        view.motor,
        view.transmission,
        view.compressor_row,
        view.set_point_row,
        view.flows,
        view.actuators,
        view.weights,
        lists
            .iter()
            .map(|(list, ..)| format!("{}: {list}", list.to_lowercase()))
            .collect::<Vec<_>>()
            .join(", "),
    )
}

/// What finds the shape of a layout, and what runs a step with it.
fn write_finder(code: &mut String, names: &[String]) -> std::fmt::Result {
    let variants = names.join(", ");
    let each = |line: &dyn Fn(&String) -> String| names.iter().map(line).collect::<Vec<_>>().join("\n");
    writeln!(
        code,
        "/// A compiled shape.\n#[allow(non_camel_case_types, reason = \"named after files\")]\n\
         #[derive(Debug, Clone, Copy, PartialEq, Eq)]\npub enum Shaped {{ {variants} }}\n\
         impl Shaped {{\n    /// The shape of a layout, if it was compiled.\n    #[must_use]\n    \
         pub fn of(indices: &Indices<'_>) -> Option<Self> {{\n{}\n        None\n    }}\n}}\n\
         /// Calls a function that is generic over a shape with that of a vehicle.\n\
         macro_rules! with_shape {{\n    ($shaped:expr, $shape:ident => $call:expr) => {{\n        \
         match $shaped {{\n{}\n            None => {{ type $shape = $crate::network::planned::Planned; $call }}\n        }}\n    }};\n}}\npub(crate) use with_shape;",
        each(&|name| format!("        if *indices == {name}::INDICES {{ return Some(Self::{name}); }}")),
        each(&|name| format!(
            "            Some($crate::network::built_in::Shaped::{name}) => {{ type $shape = \
             $crate::network::compiled::Compiled<$crate::network::built_in::{name}>; $call }}"
        )),
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    embed(&[
        Folder { constant: "VEHICLES", folder: "vehicles", ending: "toml" },
        Folder { constant: "ARCHITECTURES", folder: "architectures", ending: "toml" },
        Folder { constant: "REFRIGERANTS", folder: "refrigerants", ending: "csv" },
    ])?;
    for used in ["architecture", "components", "config", "error.rs", "media", "numerics"] {
        println!("cargo:rerun-if-changed=src/{used}");
    }
    println!("cargo:rerun-if-changed=build.rs");
    let folder = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../../configs/architectures");
    let code = shapes(&folder)?;
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("built_in_shapes.rs"), code)?;
    Ok(())
}
