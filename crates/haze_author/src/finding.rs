//! Findings of image checks.

/// One visible defect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Kind of defect, as listed in the check's documentation.
    pub name: &'static str,
    /// Description: what is wrong, where, and what is expected.
    pub description: String,
    /// True if the image is usable as it is, and only looks better without the defect.
    pub is_warning: bool,
}
