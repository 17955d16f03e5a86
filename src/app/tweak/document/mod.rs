//! What is edited: a preset and its steps.

pub mod difference;
pub mod history;
