//! Questions to a file dialog, and its answers.

use std::path::PathBuf;

/// Purpose of a file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    /// A file, or a folder for a sequence, to export to.
    Export,
}

/// Result of a file dialog.
#[derive(Debug, PartialEq, Eq)]
pub enum Answer {
    Chosen(PathBuf),
    Cancelled,
    /// The system turned out to have no dialogs.
    NoDialogs,
}
