//! What is wrong with a file of particles.

use std::path::Path;

use haze::error::Error;

/// What is wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// In a text.
    At {
        /// 1-based.
        line: usize,
        /// 1-based, characters.
        column: usize,
        /// What is wrong and what would be right.
        reason: String,
    },
    /// In the whole, or at a place that the reason tells.
    Whole(String),
}

impl Mistake {
    /// On a line, after `before` of it.
    pub(super) fn after(line: usize, before: &str, reason: impl Into<String>) -> Self {
        Self::At { line, column: before.chars().count() + 1, reason: reason.into() }
    }

    /// More particles than there may be.
    pub(super) fn crowded(line: usize, most: usize) -> Self {
        Self::after(line, "", format!("more than {most} particles; expected at most that many in a frame"))
    }

    /// An id of two particles.
    pub(super) fn twice(id: i64) -> Self {
        Self::Whole(format!("id {id} is there twice; expected ids of their own within a frame, or none"))
    }

    /// The error of a file.
    pub fn of(self, path: &Path) -> Error {
        match self {
            Self::At { line, column, reason } => Error::Json { path: path.into(), line, column, reason },
            Self::Whole(reason) => Error::Image { path: path.into(), reason },
        }
    }
}
