//! Finding, merging and checking configuration files.
//!
//! A name is looked up among the files compiled into the crate that owns the kind, then on disk. A file may name a `base` whose
//! values it replaces. A relative path inside a file counts from the folder of that file, any other one from the working
//! folder. Overrides replace single values by dotted key.

use super::{Validate, bounded, deserialized, read_value};
use crate::error::{PlantError, PlantResult};
use serde::de::DeserializeOwned;
use std::path::Path;
use toml::{Table, Value};

/// Longest chain of `base` files.
const LONGEST_BASE_CHAIN: usize = 8;

/// A kind of configuration file; the crate that owns it defines it as a constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Word for messages.
    pub word: &'static str,
    /// File ending, without the dot.
    pub ending: &'static str,
    /// Names and texts of the files compiled in.
    pub files: &'static [(&'static str, &'static str)],
    /// Keys under which its files name other files, besides `base`.
    pub references: &'static [Reference],
}

/// A key under which a file names another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reference {
    /// Keys from the outermost section inwards; [`EACH`] stands for all entries of a list.
    pub path: &'static [&'static str],
    /// Kind of the other file.
    pub kind: &'static Kind,
    /// Keys whose values belong to the other file: where a file names another one than its base does, those of the base do not
    /// count.
    pub brings: &'static [&'static [&'static str]],
}

/// All entries of a list in [`Reference::path`].
pub const EACH: &str = "[]";

impl Kind {
    /// Whether a file of this name is compiled in.
    fn holds(&self, name: &str) -> bool {
        self.files.iter().any(|(file, _)| *file == name)
    }

    /// Whether a name is the path of a file on disk.
    fn on_disk(&self, name: &str) -> bool {
        !self.holds(name) && Path::new(name).extension().is_some_and(|found| found == self.ending)
    }

    /// Bytes that a file on disk may have.
    fn largest_bytes(&self) -> u64 {
        if self.ending == "toml" { bounded::LARGEST_TOML_BYTES } else { bounded::LARGEST_TABLE_BYTES }
    }

    /// Name or path, seen from the working folder, of what `file` of this kind names.
    fn named_by(&self, file: &str, kind: &Self, named: &str) -> String {
        match Path::new(file).parent() {
            Some(folder) if self.on_disk(file) && kind.on_disk(named) => {
                folder.join(named).to_string_lossy().into_owned()
            }
            _ => named.to_owned(),
        }
    }
}

/// Names of the files compiled in.
#[must_use]
pub fn names(kind: Kind) -> Vec<&'static str> {
    kind.files.iter().map(|(name, _)| *name).collect()
}

/// Text of a file compiled in or on disk.
///
/// # Errors
/// No such file, or it cannot be read.
pub fn text(kind: Kind, name: &str) -> PlantResult<String> {
    if let Some((_, text)) = kind.files.iter().find(|(file, _)| *file == name) {
        return Ok((*text).to_owned());
    }
    if kind.on_disk(name) {
        return bounded::text(name, kind.largest_bytes())
            .map_err(|message| PlantError::Syntax { file: name.to_owned(), message });
    }
    let path = format!("the path of a .{} file", kind.ending);
    let available =
        if kind.files.is_empty() { path } else { format!("{}, or {path}", names(kind).join(", ")) };
    Err(PlantError::Unknown { kind: kind.word, name: name.to_owned(), available })
}

/// One replacement of a value by its dotted key (`battery.cell_capacity_ah`, `table.values[2]`).
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Dotted key within the file.
    pub key: String,
    /// New value.
    pub value: Value,
}

impl Override {
    /// Reads `key=value`; a value that is not TOML counts as text.
    ///
    /// # Errors
    /// There is no `=`.
    pub fn parse(assignment: &str) -> PlantResult<Self> {
        let (key, value) = assignment.split_once('=').ok_or_else(|| PlantError::InvalidArgument {
            what: "override".into(),
            value: format!("`{assignment}`"),
            allowed: "must have the form key=value".into(),
        })?;
        Ok(Self { key: key.trim().to_owned(), value: parse_value(value.trim()) })
    }
}

fn parse_value(text: &str) -> Value {
    let parsed = bounded::toml(&format!("value = {text}")).ok();
    parsed.and_then(|mut table| table.remove("value")).unwrap_or_else(|| Value::String(text.to_owned()))
}

/// Loads parameters: file, its bases, overrides, then all checks.
///
/// # Errors
/// Anything wrong, with file and key.
pub fn load<T: DeserializeOwned + Validate>(
    kind: Kind,
    name: &str,
    overrides: &[Override],
) -> PlantResult<T> {
    read(name, table(kind, name, overrides)?)
}

/// A file with its bases and overrides, not checked.
///
/// # Errors
/// There is no such file, it is not TOML, or an override names a section that it does not have.
pub fn table(kind: Kind, name: &str, overrides: &[Override]) -> PlantResult<Table> {
    let mut table = merged(kind, name, 0)?;
    for change in overrides {
        leave_out_brought(kind, &mut table, &Table::from_iter([(change.key.clone(), change.value.clone())]));
    }
    for change in overrides {
        set(&mut table, &change.key, change.value.clone())
            .map_err(|message| PlantError::Syntax { file: name.to_owned(), message })?;
    }
    Ok(table)
}

/// Reads and checks parameters; `name` is the file that an error names.
///
/// # Errors
/// A key is missing or unknown, or a value is not allowed.
pub fn read<T: DeserializeOwned + Validate>(name: &str, table: Table) -> PlantResult<T> {
    let parameters: T = deserialized(name, "", Value::Table(table))?;
    parameters.validate().map_err(|violation| violation.in_file(name))?;
    Ok(parameters)
}

/// Takes a section out of a file's table, reads and checks it.
///
/// # Errors
/// It is not there, one of its keys is missing or unknown, or a value is not allowed.
pub fn read_section<T: DeserializeOwned + Validate>(
    name: &str,
    table: &mut Table,
    section: &str,
) -> PlantResult<T> {
    read_value(name, section, take(name, table, section)?)
}

/// Takes a value out of a file's table.
///
/// # Errors
/// It is not there.
pub fn take(name: &str, table: &mut Table, key: &str) -> PlantResult<Value> {
    table
        .remove(key)
        .ok_or_else(|| PlantError::Syntax { file: name.to_owned(), message: format!("`{key}` is missing") })
}

/// What a file itself gives, that of its base left out, with the overrides.
///
/// # Errors
/// There is no such file, or it is not TOML.
pub fn own_table(kind: Kind, name: &str, overrides: &[Override]) -> PlantResult<Table> {
    let mut table = parsed(kind, name)?;
    for change in overrides {
        let mut value = change.value.clone();
        for part in change.key.rsplit('.') {
            let key = part.split('[').next().unwrap_or_default().to_owned();
            value = Value::Table(Table::from_iter([(key, value)]));
        }
        if let Value::Table(change) = value {
            merge(&mut table, change);
        }
    }
    Ok(table)
}

/// A file's own TOML.
fn parsed(kind: Kind, name: &str) -> PlantResult<Table> {
    bounded::toml(&text(kind, name)?).map_err(|message| PlantError::Syntax { file: name.to_owned(), message })
}

fn merged(kind: Kind, name: &str, depth: usize) -> PlantResult<Table> {
    let syntax = |message: String| PlantError::Syntax { file: name.to_owned(), message };
    if depth > LONGEST_BASE_CHAIN {
        return Err(syntax("the chain of `base` files is too long or closed".into()));
    }
    let mut table = parsed(kind, name)?;
    for Reference { path, kind: other, .. } in kind.references {
        if let [section, rest @ ..] = path
            && let Some(value) = table.get_mut(*section)
        {
            change_texts(value, rest, &|named| kind.named_by(name, other, named));
        }
    }
    match table.remove("base") {
        None => Ok(table),
        Some(Value::String(base)) => {
            let base = kind.named_by(name, &kind, &base);
            let mut whole = merged(kind, &base, depth + 1).map_err(|error| error.named_by(name))?;
            leave_out_brought(kind, &mut whole, &table);
            merge(&mut whole, table);
            Ok(whole)
        }
        Some(other) => Err(syntax(format!("`base` is {other}, but must be the name of a {}", kind.word))),
    }
}

/// Takes the values out of a base that belong to another file which `changes` replaces by a different one.
fn leave_out_brought(kind: Kind, base: &mut Table, changes: &Table) {
    for Reference { path, brings, .. } in kind.references {
        let [key] = path else { continue };
        let (Some(Value::String(new)), Some(Value::String(old))) = (changes.get(*key), base.get(*key)) else {
            continue;
        };
        if new.eq_ignore_ascii_case(old) {
            continue;
        }
        for keys in *brings {
            let Some((last, sections)) = keys.split_last() else { continue };
            let start = Some(&mut *base);
            let place =
                sections.iter().fold(start, |table, section| table?.get_mut(*section)?.as_table_mut());
            if let Some(table) = place {
                table.remove(*last);
            }
        }
    }
}

/// Changes the texts at a place; what is of another type is refused when the parameters are read.
fn change_texts(value: &mut Value, path: &[&str], change: &impl Fn(&str) -> String) {
    match (path, value) {
        ([], Value::String(text)) => *text = change(text),
        ([EACH, rest @ ..], Value::Array(entries)) => {
            for entry in entries {
                change_texts(entry, rest, change);
            }
        }
        ([key, rest @ ..], Value::Table(table)) => {
            if let Some(inner) = table.get_mut(*key) {
                change_texts(inner, rest, change);
            }
        }
        _ => {}
    }
}

/// Puts the values of one table in place of those of another, section by section.
pub fn merge(whole: &mut Table, part: Table) {
    for (key, value) in part {
        match (whole.get_mut(&key), value) {
            (Some(Value::Table(inner)), Value::Table(changes)) => merge(inner, changes),
            (_, value) => {
                whole.insert(key, value);
            }
        }
    }
}

/// Replaces one value; the key's sections must exist.
fn set(table: &mut Table, key: &str, new: Value) -> Result<(), String> {
    let missing = |part: &str| format!("`{key}`: there is no `{part}`");
    let parts: Vec<&str> = key.split('.').collect();
    let (last, sections) = parts.split_last().ok_or_else(|| "empty key".to_owned())?;
    let mut place = table;
    for section in sections {
        place = match place.get_mut(*section) {
            Some(Value::Table(inner)) => inner,
            _ => return Err(missing(section)),
        };
    }
    let mut indices = last.split('[');
    let name = indices.next().unwrap_or_default();
    let mut target = place.entry(name).or_insert_with(|| Value::Boolean(false));
    for index in indices {
        let number: usize =
            index.strip_suffix(']').and_then(|digits| digits.parse().ok()).ok_or_else(|| missing(last))?;
        target =
            target.as_array_mut().and_then(|array| array.get_mut(number)).ok_or_else(|| missing(last))?;
    }
    *target = new;
    Ok(())
}
