//! Writes PNG files.

use std::path::Path;

use haze_core::assets::parallel::parallel_for_each;
use haze_core::error::AssetError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ImageError};

use crate::atomic_write::write_file;

/// Compression effort.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompressionEffort {
    /// At least fifteen times as fast as [`CompressionEffort::Small`], for files 1.5 times as large.
    #[default]
    Quick,
    /// Small files, for images that are kept or shipped.
    Small,
}

impl CompressionEffort {
    /// Level of [`CompressionEffort::Small`]: three times as fast as the best compression, for files 3 % larger.
    pub const SMALL_LEVEL: u8 = 6;
}

/// Writes a PNG as [`write_file`] does.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be written.
pub fn write_png(path: &Path, image: &DynamicImage, effort: CompressionEffort) -> Result<(), AssetError> {
    write_file(path, &encode_png(path, image, effort)?)
}

/// Encodes an image as PNG. `path` is used only in errors.
pub fn encode_png(path: &Path, image: &DynamicImage, effort: CompressionEffort) -> Result<Vec<u8>, AssetError> {
    let encoded = |compression, filter| -> Result<Vec<u8>, AssetError> {
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut bytes, compression, filter);
        let io = |error| AssetError::Io { path: path.into(), error: std::io::Error::other::<ImageError>(error) };
        image.write_with_encoder(encoder).map_err(io)?;
        Ok(bytes)
    };
    match effort {
        CompressionEffort::Quick => encoded(CompressionType::Fast, FilterType::Adaptive),
        CompressionEffort::Small => {
            // Encodes with every filter that is the best one for some images, and keeps the smallest file.
            let filters = [FilterType::Adaptive, FilterType::Paeth, FilterType::Sub, FilterType::Up];
            let mut tries = filters.map(|filter| (filter, Ok(Vec::new())));
            parallel_for_each(tries.iter_mut(), |(filter, bytes)| {
                *bytes = encoded(CompressionType::Level(CompressionEffort::SMALL_LEVEL), *filter);
            });
            let files: Vec<_> = tries.into_iter().map(|(_, bytes)| bytes).collect::<Result<_, _>>()?;
            Ok(files.into_iter().min_by_key(Vec::len).unwrap_or_default())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_no_temporary_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.png");
        assert!(write_png(&path, &DynamicImage::new_rgb8(2, 2), CompressionEffort::Quick).is_err());
        write_png(&folder.path().join("a.png"), &DynamicImage::new_rgb8(2, 2), CompressionEffort::Small).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
