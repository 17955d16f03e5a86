//! Renders and writes images as the command line does.

use haze::Error;
use haze::shader::Sources;

use super::IS_PAGE;
use crate::backend::Backend;

pub use crate::image_export::{
    ExportProgress, Frames, check_flipbook, column_count, render_flipbook, render_sheet, write_gif, write_sequence,
};

/// Opens the renderer of exported images. On a page it is the CPU's, because a page must not wait for the GPU.
pub fn open_backend(sources: Option<&Sources>) -> Result<Backend, Error> {
    if IS_PAGE { Ok(Backend::Cpu) } else { Backend::open(sources) }
}
