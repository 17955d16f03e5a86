//! Thumbnails of built-in presets, kept between runs.

use std::path::{Path, PathBuf};

use glam::UVec2;
use image::RgbImage;

use crate::platform::IS_PAGE;
use crate::platform::file_io::{self, CompressionEffort};

/// Size of a thumbnail, pixels. Browsers keep 5 MiB for a page.
pub const SIZE: UVec2 = if IS_PAGE { UVec2::new(320, 180) } else { UVec2::new(480, 270) };

/// Folder of thumbnails. A file has the name of its preset, and a hash of all that its image depends on.
#[derive(Clone, Debug, Default)]
pub struct ThumbnailCache {
    /// `None` keeps nothing.
    pub folder: Option<PathBuf>,
}

impl ThumbnailCache {
    /// Returns the thumbnail of a preset with this text.
    pub fn read(&self, name: &Path, text: &str) -> Option<RgbImage> {
        // One that cannot be read, or that another program has replaced, is rendered again.
        let image = file_io::read_png(&self.path(name, text)?).ok()?.into_rgb8();
        (image.dimensions() == SIZE.into()).then_some(image)
    }

    /// Keeps a thumbnail, and removes older ones of the same preset.
    pub fn write(&self, name: &Path, text: &str, image: &RgbImage) {
        let Some((folder, path)) = self.folder.as_ref().zip(self.path(name, text)) else { return };
        let beginning = format!("{}.", name.display());
        let is_older = |file: &PathBuf| {
            file.file_name().is_some_and(|file| file.to_string_lossy().starts_with(&beginning)) && *file != path
        };
        file_io::list(folder).iter().filter(|file| is_older(file)).for_each(|file| file_io::remove(file));
        // One that cannot be written is rendered again at the next start.
        let _ = file_io::make_folder(folder)
            .and_then(|()| Ok(file_io::write_png(&path, &image.clone().into(), CompressionEffort::Small)?));
    }

    fn path(&self, name: &Path, text: &str) -> Option<PathBuf> {
        let contents = format!("{} {SIZE} {text}", env!("CARGO_PKG_VERSION"));
        Some(self.folder.as_ref()?.join(format!("{}.{}.png", name.display(), file_io::name_of_contents(&contents))))
    }
}
