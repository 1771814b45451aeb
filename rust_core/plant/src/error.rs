//! The one error type of this crate.

use thiserror::Error;

/// Everything that can go wrong while a vehicle is loaded, checked or run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlantError {
    /// A file is not TOML, lacks a key, holds an unknown key or a value of the wrong type.
    #[error("{file}: {message}")]
    Syntax {
        /// File or built-in configuration that was read.
        file: String,
        /// What the parser found, with the key.
        message: String,
    },
    /// A value is outside what is allowed.
    #[error("{file}: `{key}` is {value}, but {allowed}")]
    OutOfRange {
        /// File or built-in configuration that was read.
        file: String,
        /// Dotted path of the key.
        key: String,
        /// The value given.
        value: String,
        /// What would have been accepted, as a sentence fragment ("must be ...").
        allowed: String,
    },
    /// A named thing (scenario, vehicle, cycle, refrigerant, signal) does not exist.
    #[error("unknown {kind} `{name}`; available: {available}")]
    Unknown {
        /// Kind of thing.
        kind: &'static str,
        /// Name asked for.
        name: String,
        /// Names that exist.
        available: String,
    },
    /// An argument of a call is not usable.
    #[error("{what} is {value}, but {allowed}")]
    InvalidArgument {
        /// Name of the argument.
        what: String,
        /// The value given.
        value: String,
        /// What would have been accepted, as a sentence fragment ("must be ...").
        allowed: String,
    },
    /// A saved state is damaged, or of something else.
    #[error("state is {value}, but {allowed}")]
    State {
        /// What it is.
        value: String,
        /// What would have been accepted, as a sentence fragment ("must be ...").
        allowed: String,
    },
    /// A mistake of this package: something panicked.
    #[error("internal error ({message}); please report it")]
    Internal {
        /// What was told, and where.
        message: String,
    },
    /// Anything wrong in a file that another one names.
    #[error("{error} (named by {by})")]
    Named {
        /// File that names it.
        by: String,
        /// What is wrong.
        error: Box<PlantError>,
    },
}

impl PlantError {
    /// The same error with the file that asked for the one that is wrong; of several the innermost.
    #[must_use]
    pub fn named_by(self, file: &str) -> Self {
        match self {
            Self::Syntax { .. } | Self::OutOfRange { .. } | Self::Unknown { .. } => {
                Self::Named { by: file.to_owned(), error: Box::new(self) }
            }
            _ => self,
        }
    }

    /// The message in one line that is short enough to read.
    #[must_use]
    pub fn in_one_line(&self) -> String {
        crate::config::bounded::in_one_line(&self.to_string())
    }
}

/// Result of this crate.
pub type PlantResult<T> = Result<T, PlantError>;
