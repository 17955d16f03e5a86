//! Renders and writes images as the command line does.

use std::path::Path;

use glam::UVec2;
#[cfg(not(target_arch = "wasm32"))]
use haze::FieldError;
use haze::shader::Sources;
#[cfg(target_arch = "wasm32")]
use haze_core::error::AssetError;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_export::backend::Backend;
#[cfg(not(target_arch = "wasm32"))]
use haze_export::exr_export::{self, ExrOptions};
#[cfg(not(target_arch = "wasm32"))]
use haze_export::flipbook_export::{FlipbookExport, FlipbookOptions};
#[cfg(not(target_arch = "wasm32"))]
use haze_export::material_export::MaterialExport;
#[cfg(target_arch = "wasm32")]
use haze_export::page_renderer::PageRenderer;
#[cfg(not(target_arch = "wasm32"))]
use haze_preset::CompressionEffort;

use super::IS_PAGE;
#[cfg(not(target_arch = "wasm32"))]
use super::file_io::make_folder;

pub use haze_export::image_export::{
    ExportProgress, Frames, SCENE, burns, check_flipbook, column_count, render_flipbook, render_sheet, write_gif,
    write_sequence,
};

pub use haze_export::engine::Engine;
pub use haze_export::image_format::{Alpha, Background, BitDepth, Emission, ImageFormat};

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

/// Writes an OpenEXR file of one image; see `exr_export`.
#[cfg(not(target_arch = "wasm32"))]
pub async fn write_exr(backend: &Backend, shot: &Shot, background: Background, path: &Path) -> Result<(), Error> {
    exr_export::write(backend, shot, ExrOptions::of_image(shot, background), path).await
}

#[cfg(not(target_arch = "wasm32"))]
pub use haze_export::exr_export::write_sequence as write_exr_sequence;

/// A page offers no OpenEXR files.
#[cfg(target_arch = "wasm32")]
pub async fn write_exr(_: &Backend, _: &Shot, _: Background, path: &Path) -> Result<(), Error> {
    Err(Error::from(AssetError::Io { path: path.into(), error: std::io::ErrorKind::Unsupported.into() }))
}

/// A page offers no OpenEXR files.
#[cfg(target_arch = "wasm32")]
pub async fn write_exr_sequence(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    names: &haze_export::frame_range::FrameNames,
    _: &ExportProgress<'_>,
) -> Result<(), Error> {
    write_exr(backend, shot, frames.format.background, &names.of(0)).await
}

/// Writes the material of a system into a folder.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_material(shot: &Shot, system: usize, engine: Engine, folder: &Path) -> Result<(), Error> {
    let shot = &*shot.at_its_time();
    let Some((found, images)) = shot.preset.systems.get(system).zip(shot.materials.get(system)) else {
        return Err(FieldError::new("export", "a material", "a preset with a system").into());
    };
    let export = MaterialExport::new(&shot.preset.name, system, found, images, engine)?;
    make_folder(folder)?;
    export.write(folder)
}

/// Choices of a flipbook for an engine, besides its engine and its cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct FlipbookChoices {
    /// `None`: premultiplied if a system burns.
    pub alpha: Option<Alpha>,
    pub emission: Emission,
    /// Number of frames after the last that are faded into the first.
    pub loop_fade: u32,
    pub has_six_way: bool,
}

/// Flipbook for an engine.
pub struct EngineFlipbook {
    pub engine: Engine,
    /// Rows (`x`) and columns (`y`).
    pub cells: UVec2,
    pub choices: FlipbookChoices,
}

/// Writes sheets of color, normals, motion vectors and fire into a folder.
#[cfg(not(target_arch = "wasm32"))]
pub async fn write_engine_flipbook(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    EngineFlipbook { engine, cells, choices }: EngineFlipbook,
    folder: &Path,
    progress: &ExportProgress<'_>,
) -> Result<(), Error> {
    let FlipbookChoices { alpha, emission, loop_fade, has_six_way } = choices;
    let effort = CompressionEffort::Quick;
    let options = FlipbookOptions { engine, cells, alpha, emission, loop_fade, has_six_way, effort };
    let export = FlipbookExport::render(backend, shot, frames, options, progress, folder).await?;
    make_folder(folder)?;
    export.write(folder)
}

/// A page offers no flipbooks for engines.
#[cfg(target_arch = "wasm32")]
pub async fn write_engine_flipbook(
    _: &Backend,
    _: &Shot,
    _: &Frames,
    _: EngineFlipbook,
    folder: &Path,
    _: &ExportProgress<'_>,
) -> Result<(), Error> {
    Err(Error::from(AssetError::Io { path: folder.into(), error: std::io::ErrorKind::Unsupported.into() }))
}

/// A page offers no materials.
#[cfg(target_arch = "wasm32")]
pub fn write_material(_: &Shot, _: usize, _: Engine, folder: &Path) -> Result<(), Error> {
    Err(Error::from(AssetError::Io { path: folder.into(), error: std::io::ErrorKind::Unsupported.into() }))
}

/// Opens the renderer of thumbnails: the CPU, so that the GPU is left to the viewport; on a page, the GPU.
pub fn open_thumbnail_backend() -> Result<Backend, Error> {
    if IS_PAGE { open_backend(None) } else { Ok(Backend::Cpu) }
}
