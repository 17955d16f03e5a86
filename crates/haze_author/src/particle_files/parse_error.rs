//! Parse errors of particle files.

use std::path::Path;

use haze_core::error::AssetError;

/// A parse error and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParseError {
    /// An error at a position in a text file.
    At {
        /// 1-based.
        line: usize,
        /// 1-based, characters.
        column: usize,
        /// The problem and the expected value.
        reason: String,
    },
    /// An error of the whole file, or at a position that the reason names.
    WholeFile(String),
}

impl ParseError {
    /// An error on a line, at the column that follows `before`.
    pub(super) fn after_text(line: usize, before: &str, reason: impl Into<String>) -> Self {
        Self::At { line, column: before.chars().count() + 1, reason: reason.into() }
    }

    /// The file has more than `max_particles` particles.
    pub(super) fn too_many_particles(line: usize, max_particles: usize) -> Self {
        Self::after_text(
            line,
            "",
            format!("more than {max_particles} particles in a frame; expected at most {max_particles}"),
        )
    }

    /// Two particles of a frame have the same id.
    pub(super) fn duplicate_id(id: i64) -> Self {
        Self::WholeFile(format!("id {id} is used twice; expected unique ids within a frame, or no id column"))
    }

    /// Converts to the error of the file at `path`.
    pub fn into_error(self, path: &Path) -> AssetError {
        match self {
            Self::At { line, column, reason } => AssetError::Text { path: path.into(), line, column, reason },
            Self::WholeFile(reason) => AssetError::Image { path: path.into(), reason },
        }
    }
}
