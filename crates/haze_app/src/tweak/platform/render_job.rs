//! Renders and writes images as the command line does.

pub use crate::export::{Frames, Watch, check_flipbook, columns, flipbook, gif, sequence, sheet};
