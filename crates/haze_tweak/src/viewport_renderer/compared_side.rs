//! Side of the comparison that an image stands on.

/// One of the two compared images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedSide {
    First,
    Second,
}
