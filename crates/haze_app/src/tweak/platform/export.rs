//! Pictures as the command line draws and writes them.

pub use crate::export::{Frames, Watch, check_flipbook, columns, flipbook, gif, sequence, sheet};
