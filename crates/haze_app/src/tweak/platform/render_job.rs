//! Renders and writes images as the command line does.

pub use crate::image_export::{
    ExportProgress, Frames, check_flipbook, column_count, render_flipbook, render_sheet, write_gif, write_sequence,
};
