//! For build scripts: compiles configuration files in, so that an installed package works anywhere.
//!
//! Each crate embeds the folders of the kinds that it owns and no others, so that a change of a file rebuilds only the
//! crates that know it.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// A folder below `configs/` to embed.
#[derive(Debug, Clone, Copy)]
pub struct Folder {
    /// Name of the static that holds its files.
    pub constant: &'static str,
    /// Folder below `configs/`; its sub-folders belong to it.
    pub folder: &'static str,
    /// File ending, without the dot.
    pub ending: &'static str,
}

/// Writes `OUT_DIR/embedded.rs`: for each folder a static list of name (without ending) and text, sorted by name.
///
/// For build scripts of crates two levels below the repository's root, as those in `rust_core/` are.
///
/// # Errors
/// A folder cannot be read, or the file cannot be written.
pub fn embed(folders: &[Folder]) -> Result<(), Box<dyn Error>> {
    let configs = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../../configs").canonicalize()?;
    let mut code = String::new();
    for Folder { constant, folder, ending } in folders {
        let root = configs.join(folder);
        let mut files = Vec::new();
        collect(&root, ending, &mut files)?;
        files.sort();
        writeln!(code, "pub(super) static {constant}: &[(&str, &str)] = &[")?;
        for file in &files {
            let name = file.strip_prefix(&root)?.with_extension("").to_string_lossy().replace('\\', "/");
            writeln!(code, "    ({name:?}, include_str!({:?})),", file.display().to_string())?;
        }
        writeln!(code, "];")?;
    }
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("embedded.rs"), code)?;
    Ok(())
}

fn collect(folder: &Path, ending: &str, files: &mut Vec<PathBuf>) -> io::Result<()> {
    println!("cargo:rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, ending, files)?;
        } else if path.extension().is_some_and(|found| found == ending) {
            files.push(path);
        }
    }
    Ok(())
}
