//! What checks of pictures find.

/// One thing that would show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its kind, as the check lists them.
    pub name: &'static str,
    /// What it is, where, and what would be right.
    pub what: String,
}
