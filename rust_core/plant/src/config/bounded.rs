//! Bounds before work: what a file may be, how large and how deep, whoever asks for it.
//!
//! The limits are those of `hp_gym/files.py` and `hp_gym/toml_files.py`.

use std::fs::{File, metadata};
use std::io::Read;
use toml::{Table, Value};

/// Bytes of a TOML file.
pub const LARGEST_TOML_BYTES: u64 = 1 << 20;

/// Bytes of a file of any other kind, which holds a table of numbers.
pub const LARGEST_TABLE_BYTES: u64 = 16 << 20;

/// Tables and lists within each other.
pub const DEEPEST: usize = 32;

/// Characters of a message; of a longer one the middle is left out, as its ends say what and where.
pub const LONGEST_MESSAGE: usize = 500;

/// Reads a regular file of at most `largest` bytes as UTF-8; a byte-order mark at its beginning does not matter.
///
/// Links are followed. Nothing is opened that a reader would have to wait for.
///
/// # Errors
/// What is wrong with it, without its name.
pub fn text(path: &str, largest: u64) -> Result<String, String> {
    let told = |error: std::io::Error| error.to_string();
    let irregular = || "is no regular file".to_owned();
    let too_large = |bytes: u64| format!("has {bytes} bytes, but may have at most {largest}");
    if !metadata(path).map_err(told)?.is_file() {
        return Err(irregular());
    }
    let file = File::open(path).map_err(told)?;
    // What the name stands for may have changed in between.
    let status = file.metadata().map_err(told)?;
    if !status.is_file() {
        return Err(irregular());
    }
    if status.len() > largest {
        return Err(too_large(status.len()));
    }
    let mut bytes = Vec::new();
    // A file may grow while it is read.
    file.take(largest + 1).read_to_end(&mut bytes).map_err(told)?;
    if bytes.len() as u64 > largest {
        return Err(too_large(bytes.len() as u64));
    }
    let text = String::from_utf8(bytes)
        .map_err(|error| format!("byte {} is no UTF-8", error.utf8_error().valid_up_to()))?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Reads TOML.
///
/// # Errors
/// What is wrong and where, in one line: it is no TOML, or too deep.
pub fn toml(text: &str) -> Result<Table, String> {
    if looks_deep(text) {
        return Err(too_deep());
    }
    let table: Table = toml::from_str(text).map_err(|error| {
        let place = error.span().map(|span| place(text, span.start)).unwrap_or_default();
        format!("{place}{}", error.message())
    })?;
    require_flat(&table)?;
    Ok(table)
}

/// Line and column of a byte, for the beginning of a message.
fn place(text: &str, byte: usize) -> String {
    let before = text.get(..byte).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    format!("line {line}, column {column}: ")
}

fn require_flat(table: &Table) -> Result<(), String> {
    let mut level: Vec<&Value> = table.values().collect();
    for _ in 0..DEEPEST {
        level.retain(|value| value.is_table() || value.is_array());
        if level.is_empty() {
            return Ok(());
        }
        level = level.into_iter().flat_map(inner).collect();
    }
    Err(too_deep())
}

fn too_deep() -> String {
    format!("more than {DEEPEST} tables or lists within each other")
}

/// Whether brackets and dotted keys go so deep that a parser should not see them. The one of Rust bounds each, but not both
/// together, and that of Python takes a time that grows with the square. Never true of what has an allowed depth.
#[must_use]
pub fn looks_deep(text: &str) -> bool {
    // One more for a number's point; headers and what stands below them count for themselves.
    let most = DEEPEST + 1;
    let mut rest = text.as_bytes();
    let (mut open, mut depth, mut dots): (Vec<usize>, usize, usize) = (Vec::new(), 0, 0);
    while let Some((&byte, after)) = rest.split_first() {
        rest = match byte {
            b'"' | b'\'' => after_string(rest, byte),
            b'#' => after_line(after),
            _ => after,
        };
        match byte {
            b'[' | b'{' => {
                open.push(dots + 1);
                depth += dots + 1;
                dots = 0;
            }
            b']' | b'}' => {
                depth -= open.pop().unwrap_or(0);
                dots = 0;
            }
            b',' | b'\n' | b'#' => dots = 0,
            b'.' => dots += 1,
            _ => {}
        }
        if depth + dots > most {
            return true;
        }
    }
    false
}

/// What follows a string; one on a single line ends with it.
fn after_string(text: &[u8], quote: u8) -> &[u8] {
    let long = text.starts_with(&[quote; 3]);
    let ends =
        |rest: &[u8]| if long { rest.starts_with(&[quote; 3]) } else { rest[0] == quote || rest[0] == b'\n' };
    let mut rest = &text[if long { 3 } else { 1 }..];
    while !rest.is_empty() && !ends(rest) {
        let escaped = quote == b'"' && rest[0] == b'\\' && rest.len() > 1 && (long || rest[1] != b'\n');
        rest = &rest[if escaped { 2 } else { 1 }..];
    }
    &rest[if long { 3 } else { 1 }.min(rest.len())..]
}

fn after_line(text: &[u8]) -> &[u8] {
    let end = text.iter().position(|&byte| byte == b'\n').unwrap_or(text.len());
    &text[end..]
}

fn inner(value: &Value) -> Box<dyn Iterator<Item = &Value> + '_> {
    match value {
        Value::Table(table) => Box::new(table.values()),
        Value::Array(list) => Box::new(list.iter()),
        _ => Box::new(std::iter::empty()),
    }
}

/// A message without line breaks, at most [`LONGEST_MESSAGE`] characters of it.
#[must_use]
pub fn in_one_line(message: &str) -> String {
    // Much longer texts are cut before their words are looked at.
    let line = cut(message, 4 * LONGEST_MESSAGE).split_whitespace().collect::<Vec<_>>().join(" ");
    let shown = line.chars().map(|character| if character.is_control() { '\u{fffd}' } else { character });
    cut(&shown.collect::<String>(), LONGEST_MESSAGE)
}

fn cut(text: &str, length: usize) -> String {
    let count = text.chars().count();
    if count <= length {
        return text.to_owned();
    }
    let half = (length - 5) / 2;
    let first: String = text.chars().take(half).collect();
    let last: String = text.chars().skip(count - half).collect();
    format!("{first} ... {last}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::write;

    #[test]
    fn a_file_may_have_the_largest_size_and_not_a_byte_more() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("file");
        let path = path.to_str().expect("plain name");
        write(path, "12345").expect("written");
        assert_eq!(text(path, 5), Ok("12345".to_owned()));
        assert_eq!(text(path, 4), Err("has 5 bytes, but may have at most 4".to_owned()));
    }

    #[test]
    fn a_mark_of_byte_order_does_not_matter_and_other_encodings_are_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("file");
        let path = path.to_str().expect("plain name");
        write(path, "\u{feff}a = 1").expect("written");
        assert_eq!(text(path, 100), Ok("a = 1".to_owned()));
        write(path, b"a = \xff").expect("written");
        assert_eq!(text(path, 100), Err("byte 4 is no UTF-8".to_owned()));
    }

    #[test]
    fn folders_and_devices_are_no_files() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let name = |path: &std::path::Path| path.to_str().expect("plain name").to_owned();
        assert_eq!(text(&name(folder.path()), 100), Err("is no regular file".to_owned()));
        #[cfg(unix)]
        {
            let link = folder.path().join("zero");
            std::os::unix::fs::symlink("/dev/zero", &link).expect("linked");
            assert_eq!(text(&name(&link), 100), Err("is no regular file".to_owned()));
        }
        assert!(text(&name(&folder.path().join("none")), 100).is_err());
    }

    #[test]
    fn depth_is_bounded_however_it_is_written() {
        let lists = |depth: usize| format!("x = {}{}", "[".repeat(depth), "]".repeat(depth));
        assert!(toml(&lists(DEEPEST - 1)).is_ok());
        let deep = [
            lists(DEEPEST),
            lists(100_000),
            format!("a{} = 1", ".a".repeat(400_000)),
            format!("[a{}]", ".a".repeat(400_000)),
            format!("x = {}", "{a = ".repeat(100_000)),
            format!("x = {}1{}", format!("{{a{} = ", ".a".repeat(78)).repeat(78), "}".repeat(78)),
            format!("s = \"\\\" [ \"\nx = {}", format!("{{a{} = ", ".a".repeat(78)).repeat(78)),
            format!("s = \"open\nx = {}", format!("{{a{} = ", ".a".repeat(78)).repeat(78)),
            format!("s = '\\'\nx = {}", format!("{{a{} = ", ".a".repeat(78)).repeat(78)),
        ];
        let strings = format!("a = \"{0}\\\"\" # {0}\nb = \"\"\"{0}\n\"\"\"\nc = '{0}'\n", "[.".repeat(100));
        assert!(toml(&strings).is_ok());
        for text in deep {
            // The stack of a thread of a pool.
            let told = std::thread::spawn(move || toml(&text)).join().expect("no panic");
            assert!(told.is_err_and(|message| message.len() < LONGEST_MESSAGE));
        }
    }

    #[test]
    fn messages_are_one_line_of_bounded_length_whose_ends_stay() {
        assert_eq!(in_one_line("file:\n  what \u{7}"), "file: what \u{fffd}");
        let long = in_one_line(&format!("file: {} end", "x".repeat(1_000_000)));
        assert!((LONGEST_MESSAGE - 1..=LONGEST_MESSAGE).contains(&long.chars().count()));
        assert!(long.starts_with("file: x") && long.ends_with("x end"), "{long}");
    }
}
