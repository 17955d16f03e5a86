//! What is edited: a preset with its file, its steps, and what is kept for after a crash.

pub mod difference;
#[allow(clippy::module_inception, reason = "one file per part of a document, and one for the whole")]
pub mod document;
pub mod history;
pub mod pictures;
pub mod recipes;
pub mod recovery;
