//! Error types. Every message names the field, file or line, and says what would be right.

mod io_reason;

use std::fmt::Display;
use std::path::{Path, PathBuf};

#[cfg(not(target_arch = "wasm32"))]
pub use io_reason::LINK_LOOP;
pub use io_reason::{io_expected, io_problem, io_reason, is_link_loop};

/// Formats text from outside for a message of one line: control characters and marks that change the direction of
/// writing are escaped, and a long text is cut.
pub fn one_line(text: impl Display) -> String {
    /// Leaves room for the expected value.
    const MAX_CHARS: usize = 200;
    let text = text.to_string();
    let mut line = escape(text.chars().take(MAX_CHARS));
    if text.chars().nth(MAX_CHARS).is_some() {
        line.push('…');
    }
    line
}

/// File name on one line, not cut.
pub fn display_path(path: &Path) -> String {
    escape(path.to_string_lossy().chars())
}

/// Path that errors name for a file that is embedded in a program: `builtin:/name`.
pub fn builtin_path(name: &str) -> PathBuf {
    Path::new("builtin:").join(name)
}

/// True for characters that would change what a terminal shows of a line: control characters, line and paragraph
/// separators, and characters that reverse text.
pub fn alters_line(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn escape(text: impl Iterator<Item = char>) -> String {
    let mut line = String::new();
    for c in text {
        if alters_line(c) {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}

/// Value outside its valid range, or in conflict with another value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {problem}; expected {expected}")]
#[non_exhaustive]
pub struct FieldError {
    /// Dotted path of the field, for example `systems[0].settings.soft_fade.fade_scale`.
    pub field: String,
    /// Problem, on one line: `VALUE is not valid`, or in words.
    pub problem: String,
    /// Description of valid values: a range with its unit, or a list of choices.
    pub expected: String,
}

impl FieldError {
    /// Creates the error of a value that is not valid.
    pub fn new(field: impl Into<String>, value: impl Display, expected: impl Into<String>) -> Self {
        Self::from_problem(field, format!("{} is not valid", one_line(value)), expected)
    }

    /// Creates the error of a problem that "VALUE is not valid" does not describe: `129 lights are too many`.
    pub fn from_problem(field: impl Into<String>, problem: impl AsRef<str>, expected: impl Into<String>) -> Self {
        Self { field: field.into(), problem: escape(problem.as_ref().chars()), expected: expected.into() }
    }
}

/// Error of the renderer: a host's call, or a shader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// A setting, a light, a particle system, the view, or a property of the host's pass is invalid.
    #[error(transparent)]
    Field(#[from] FieldError),

    /// A shader could not be used.
    #[error("{}:{line}:{column}: {reason}", display_path(path))]
    Shader {
        /// File with the error, or `builtin:NAME`.
        path: PathBuf,
        /// Line, 1-based. Errors without a position, for example a missing entry point, are reported at 1:1 of the
        /// pass's file.
        line: usize,
        /// Column, 1-based, in characters.
        column: usize,
        /// Problem.
        reason: String,
    },
}

/// Error of a file, or of what is in it: an image, a preset, a gradient, particles, or shaders.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    /// A name or a value that was given for a file is invalid.
    #[error(transparent)]
    Field(#[from] FieldError),

    /// A ramp, a sprite image or a particle file could not be used.
    #[error("{}: {reason}", display_path(path))]
    Image {
        /// File, or `builtin:NAME`.
        path: PathBuf,
        /// Problem, and what would be right.
        reason: String,
    },

    /// An image or a particle file that a preset names could not be used.
    #[error("{named_by}: {error}")]
    Named {
        /// Field that names it, preceded by the preset's file and the system if they are known:
        /// `my.json: systems[0].material.sprite`.
        named_by: String,
        /// Error of the file.
        error: Box<AssetError>,
    },

    /// A text could not be used: JSON, particles, or a shader.
    #[error("{}:{line}:{column}: {reason}", display_path(path))]
    Text {
        /// File, or `builtin:NAME`.
        path: PathBuf,
        /// Line, 1-based.
        line: usize,
        /// Column, 1-based.
        column: usize,
        /// Problem, and what would be right.
        reason: String,
    },

    /// A value inside a preset or gradient file is out of range.
    #[error("{}: {error}", display_path(path))]
    JsonField {
        /// File, or `builtin:NAME`.
        path: PathBuf,
        /// Field and its range.
        error: FieldError,
    },

    /// A file could not be read or written.
    #[error("{}: {}", display_path(path), io_reason(error))]
    Io {
        /// File.
        path: PathBuf,
        /// Error of the operating system; also the [`source`](std::error::Error::source).
        #[source]
        error: std::io::Error,
    },
}

/// Any failure of a program that draws smoke: of the renderer, a file, or the device.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A setting, a light, a particle system, the view, or a name is invalid.
    #[error(transparent)]
    Field(#[from] FieldError),

    /// A file, or what is in it, could not be used.
    #[error(transparent)]
    Asset(AssetError),

    /// A shader could not be used.
    #[error(transparent)]
    Prepare(PrepareError),

    /// No graphics device is available.
    #[error("{0}")]
    NoDevice(String),

    /// The graphics device failed while it worked: lost, out of memory, or a validation error.
    #[error("the graphics device failed: {0}")]
    Device(String),
}

impl From<PrepareError> for Error {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Field(error) => Self::Field(error),
            error => Self::Prepare(error),
        }
    }
}

impl From<AssetError> for Error {
    fn from(error: AssetError) -> Self {
        match error {
            AssetError::Field(error) => Self::Field(error),
            error => Self::Asset(error),
        }
    }
}
