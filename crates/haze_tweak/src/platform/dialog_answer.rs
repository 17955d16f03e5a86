//! Questions to a file dialog, and its answers.

use std::path::PathBuf;

use haze_core::settings::BackdropKind;

/// Purpose of a file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    /// A file, or a folder for a sequence, to export to.
    Export,
    /// A scene or a sky to show around the smoke.
    Backdrop(BackdropKind),
}

/// Title of a dialog for a scene or a sky.
pub fn backdrop_title(kind: BackdropKind) -> &'static str {
    match kind {
        BackdropKind::Scene => "Scene",
        BackdropKind::Sky => "Sky",
    }
}

/// Result of a file dialog.
#[derive(Debug, PartialEq, Eq)]
pub enum Answer {
    Chosen(PathBuf),
    Cancelled,
    /// The system turned out to have no dialogs.
    NoDialogs,
}
