//! What is wrong with an architecture, and which name was meant.

use std::fmt;

/// What is wrong with an architecture; the loader adds the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flaw {
    /// Dotted path of the key.
    pub key: String,
    /// Value found.
    pub value: String,
    /// What is allowed, as "must be ...".
    pub allowed: String,
}

impl Flaw {
    /// A flaw at `key`.
    pub fn new(key: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.to_string(), allowed: allowed.into() }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is {}, but {}", self.key, self.value, self.allowed)
    }
}
/// A name among others, as "must be one of ... (nearest: ...)".
#[must_use]
pub fn among(names: &[&str], wanted: &str) -> String {
    let nearest =
        names.iter().map(|name| (similarity(name, wanted), name)).max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = match nearest {
        Some((share, name)) if share >= 0.5 && names.len() > 1 => format!(" (nearest: {name})"),
        _ => String::new(),
    };
    if names.is_empty() {
        "there is none".to_owned()
    } else {
        format!("must be one of {}{hint}", names.join(", "))
    }
}

/// Share of letter pairs that two words have in common (Dice).
#[must_use]
pub fn similarity(one: &str, other: &str) -> f64 {
    let pairs = |word: &str| word.as_bytes().windows(2).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let (mine, mut theirs) = (pairs(one), pairs(other));
    let total = mine.len() + theirs.len();
    let mut common = 0;
    for pair in mine {
        if let Some(place) = theirs.iter().position(|other| *other == pair) {
            theirs.swap_remove(place);
            common += 1;
        }
    }
    if total == 0 { 0.0 } else { 2.0 * f64::from(common) / total as f64 }
}
