//! Parse errors of particle files.

use std::path::Path;

use haze::error::Error;

/// A parse error and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mistake {
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
    Whole(String),
}

impl Mistake {
    /// An error on a line, at the column that follows `before`.
    pub(super) fn after(line: usize, before: &str, reason: impl Into<String>) -> Self {
        Self::At { line, column: before.chars().count() + 1, reason: reason.into() }
    }

    /// The file has more than `most` particles.
    pub(super) fn crowded(line: usize, most: usize) -> Self {
        Self::after(line, "", format!("more than {most} particles; expected at most that many in a frame"))
    }

    /// Two particles of a frame have the same id.
    pub(super) fn twice(id: i64) -> Self {
        Self::Whole(format!("id {id} is used twice; expected unique ids within a frame, or no id column"))
    }

    /// Converts to the error of the file at `path`.
    pub fn of(self, path: &Path) -> Error {
        match self {
            Self::At { line, column, reason } => Error::Json { path: path.into(), line, column, reason },
            Self::Whole(reason) => Error::Image { path: path.into(), reason },
        }
    }
}
