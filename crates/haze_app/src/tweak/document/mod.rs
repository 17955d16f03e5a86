//! Edited preset: its file, its undo history, and its recovery after a crash.

pub mod difference;
#[allow(clippy::module_inception, reason = "one file per part of a document, and one for the whole")]
pub mod document;
pub mod history;
pub mod pictures;
pub mod recipes;
pub mod recovery;
