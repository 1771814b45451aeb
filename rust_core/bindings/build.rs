//! Compiles the configuration files of this crate's kinds and the reference policies in, so that an installed package works
//! anywhere.

use hp_embed::{Folder, embed as embed_configs};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> Result<(), Box<dyn Error>> {
    embed_configs(&[
        Folder { constant: "CALIBRATIONS", folder: "calibration", ending: "toml" },
        Folder { constant: "BENCHMARKS", folder: "benchmark", ending: "toml" },
        Folder { constant: "VALIDATIONS", folder: "validation", ending: "toml" },
        Folder { constant: "TRAININGS", folder: "agents", ending: "toml" },
    ])?;
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../..").canonicalize()?;
    let code = embed(&root, "agents/reference_policies", &["safetensors"], "REFERENCE_POLICIES")?;
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("policies.rs"), code)?;
    Ok(())
}

/// Rust code of a constant with all files of a folder and those below it: their paths in it, sorted, and their bytes.
fn embed(root: &Path, folder: &str, endings: &[&str], constant_name: &str) -> Result<String, Box<dyn Error>> {
    let folder = root.join(folder);
    let mut files = Vec::new();
    collect(&folder, endings, &mut files)?;
    files.sort();
    let mut code = format!("pub static {constant_name}: &[(&str, &[u8])] = &[\n");
    for file in &files {
        let name = file.strip_prefix(&folder)?.to_string_lossy().replace('\\', "/");
        writeln!(code, "    ({name:?}, include_bytes!({:?})),", file.display().to_string())?;
    }
    code.push_str("];\n");
    Ok(code)
}

fn collect(folder: &Path, endings: &[&str], files: &mut Vec<PathBuf>) -> io::Result<()> {
    println!("cargo:rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, endings, files)?;
        } else if path.extension().and_then(|ending| ending.to_str()).is_some_and(|e| endings.contains(&e)) {
            files.push(path);
        }
    }
    Ok(())
}
