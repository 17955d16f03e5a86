//! What can go wrong, and where it is said. Every message names the field, file or line, and what would be right.

use std::path::PathBuf;

/// A value outside its valid range, or in conflict with another.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {value} is not valid; expected {expected}")]
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

    /// A ramp or sprite picture could not be used.
    #[error("{}: {reason}", path.display())]
    Image {
        /// The file, or `builtin:NAME`.
        path: PathBuf,
        /// What is wrong and what would be right.
        reason: String,
    },

    /// A picture that a preset names could not be used.
    #[error("{named_by}: {error}")]
    Picture {
        /// The field that names it, after the preset's file and the system where they are known:
        /// `my.json: systems[0].material.sprite`.
        named_by: String,
        /// What is wrong with the picture.
        error: Box<Error>,
    },

    /// A preset or gradient file could not be used.
    #[error("{}:{line}:{column}: {reason}", path.display())]
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

    /// A value inside a preset or gradient file is out of range.
    #[error("{}: {error}", path.display())]
    JsonField {
        /// The file, or `builtin:NAME`.
        path: PathBuf,
        /// The field and its range.
        error: FieldError,
    },

    /// A file could not be read or written.
    #[error("{}: {error}", path.display())]
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
