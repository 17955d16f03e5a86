//! What can go wrong, and where it is said. Every message names the field, file or line, and what would be right.

use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A text from outside, for a message of one line: control characters and marks that turn the direction of writing are
/// escaped, and a long text is cut.
pub fn one_line(text: impl Display) -> String {
    /// Leaves room for what is expected.
    const MOST: usize = 200;
    let text = text.to_string();
    let mut line = escape(text.chars().take(MOST));
    if text.chars().nth(MOST).is_some() {
        line.push('…');
    }
    line
}

/// A file's name on one line, whole.
pub fn name(path: &Path) -> String {
    escape(path.to_string_lossy().chars())
}

fn escape(text: impl Iterator<Item = char>) -> String {
    let mut line = String::new();
    for c in text {
        if c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}') {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}

/// A value outside its valid range, or in conflict with another.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {} is not valid; expected {expected}", one_line(value))]
pub struct FieldError {
    /// Dotted path to the field, for example `systems[0].settings.soft_fade.fade_scale`.
    pub field: String,
    /// The value that was given.
    pub value: String,
    /// What would be right: a range with its unit, or a list of choices.
    pub expected: String,
}

impl FieldError {
    /// Builds the error from anything printable.
    pub fn new(field: impl Into<String>, value: impl ToString, expected: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), expected: expected.into() }
    }
}

/// Any failure of the library that a caller, a file or a driver can cause.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A setting, a light, a particle system or the view is not usable.
    #[error(transparent)]
    Field(#[from] FieldError),

    /// A ramp or sprite picture, or a file of particles, could not be used.
    #[error("{}: {reason}", name(path))]
    Image {
        /// The file, or `builtin:NAME`.
        path: PathBuf,
        /// What is wrong and what would be right.
        reason: String,
    },

    /// A picture or a file of particles that a preset names could not be used.
    #[error("{named_by}: {error}")]
    Picture {
        /// The field that names it, after the preset's file and the system where they are known:
        /// `my.json: systems[0].material.sprite`.
        named_by: String,
        /// What is wrong with the file.
        error: Box<Error>,
    },

    /// A preset or gradient file, or particles as text, could not be used.
    #[error("{}:{line}:{column}: {reason}", name(path))]
    Json {
        /// The file, or `builtin:NAME`.
        path: PathBuf,
        /// 1-based.
        line: usize,
        /// 1-based.
        column: usize,
        /// What is wrong and what would be right.
        reason: String,
    },

    /// A shader could not be used.
    #[error("{}:{line}:{column}: {reason}", name(path))]
    Shader {
        /// The file that has the mistake, or `builtin:NAME`.
        path: PathBuf,
        /// 1-based. A mistake that is of no one place, an entry point that is missing for example, stands at 1:1 of the pass's
        /// file.
        line: usize,
        /// 1-based, characters.
        column: usize,
        /// What is wrong.
        reason: String,
    },

    /// A value inside a preset or gradient file is out of range.
    #[error("{}: {error}", name(path))]
    JsonField {
        /// The file, or `builtin:NAME`.
        path: PathBuf,
        /// The field and its range.
        error: FieldError,
    },

    /// A file could not be read or written.
    #[error("{}: {error}", name(path))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },

    /// No graphics device could be had.
    #[error("{0}")]
    NoDevice(String),

    /// The graphics device failed while it worked: lost, out of memory, or a validation error.
    #[error("the graphics device failed: {0}")]
    Device(String),
}
