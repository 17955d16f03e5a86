//! Renders and writes images as the command line does.

use haze::Error;
use haze::shader::Sources;

use super::IS_PAGE;
use crate::backend::Backend;
#[cfg(target_arch = "wasm32")]
use crate::page_renderer::PageRenderer;

pub use crate::image_export::{
    Background, ExportProgress, Frames, check_flipbook, column_count, render_flipbook, render_sheet, write_gif,
    write_sequence,
};

/// Opens the renderer of exported images: the GPU, which on a page is that of the canvas.
#[cfg(not(target_arch = "wasm32"))]
pub fn open_backend(sources: Option<&Sources>) -> Result<Backend, Error> {
    Backend::open(sources)
}

/// As on a desktop.
#[cfg(target_arch = "wasm32")]
pub fn open_backend(_: Option<&Sources>) -> Result<Backend, Error> {
    Ok(Backend::Page(Box::new(PageRenderer::open()?)))
}

/// Opens the renderer of thumbnails: the CPU, so that the GPU is left to the viewport; on a page, the GPU.
pub fn open_thumbnail_backend() -> Result<Backend, Error> {
    if IS_PAGE { open_backend(None) } else { Ok(Backend::Cpu) }
}
