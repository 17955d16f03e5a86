//! PNGs that are encoded row by row, so that no image has to be in memory.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use haze_core::assets::parallel::parallel_for_each;
use haze_core::error::{AssetError, Error};
use haze_preset::{CompressionEffort, write_file_from};
use png::{BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, StreamWriter};

/// PNG with 8 bits per channel that gets its rows from the top. Until it is written it is a temporary file without a name, which
/// the system removes with the process.
pub struct PngStream {
    path: PathBuf,
    tries: Vec<Try>,
}

/// The PNG with one of the filters.
struct Try {
    rows: StreamWriter<'static, BufWriter<File>>,
    file: File,
    result: io::Result<()>,
}

/// Image of a [`PngStream`].
pub struct PngShape<'a> {
    /// Pixels along a row.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// True for four channels, false for three.
    pub has_alpha: bool,
    /// File that it becomes.
    pub path: PathBuf,
    /// Folder of the temporary files. It must exist.
    pub scratch: &'a Path,
}

impl PngStream {
    /// Starts a PNG.
    ///
    /// # Errors
    /// [`AssetError::Io`] if no temporary file can be created.
    pub fn new(shape: PngShape<'_>, effort: CompressionEffort) -> Result<Self, Error> {
        let filters = match effort {
            CompressionEffort::Quick => &[Filter::Adaptive][..],
            // As in `write_png`.
            CompressionEffort::Small => &[Filter::Adaptive, Filter::Paeth, Filter::Sub, Filter::Up],
        };
        let start = |filter: &Filter| {
            let file = tempfile::tempfile_in(shape.scratch)?;
            let mut encoder = Encoder::new(BufWriter::new(file.try_clone()?), shape.width, shape.height);
            encoder.set_color(if shape.has_alpha { ColorType::Rgba } else { ColorType::Rgb });
            encoder.set_depth(BitDepth::Eight);
            encoder.set_deflate_compression(match effort {
                CompressionEffort::Quick => DeflateCompression::FdeflateUltraFast,
                CompressionEffort::Small => DeflateCompression::Level(CompressionEffort::SMALL_LEVEL),
            });
            encoder.set_filter(*filter);
            Ok(Try { rows: encoder.write_header()?.into_stream_writer()?, file, result: Ok(()) })
        };
        let tries: Result<_, EncodingError> = filters.iter().map(start).collect();
        match tries {
            Ok(tries) => Ok(Self { path: shape.path, tries }),
            Err(error) => Err(Error::from(AssetError::Io { path: shape.path, error: error.into() })),
        }
    }

    /// Adds rows: the codes of their pixels.
    ///
    /// # Errors
    /// [`AssetError::Io`] if they cannot be written.
    pub fn write_rows(&mut self, codes: &[u8]) -> Result<(), Error> {
        parallel_for_each(self.tries.iter_mut(), |attempt| attempt.result = attempt.rows.write_all(codes));
        for attempt in &mut self.tries {
            let result = std::mem::replace(&mut attempt.result, Ok(()));
            result.map_err(|error| Error::from(AssetError::Io { path: self.path.clone(), error }))?;
        }
        Ok(())
    }

    /// Ends the PNG after its last row.
    ///
    /// # Errors
    /// [`AssetError::Io`] if rows are missing, or it cannot be written.
    pub fn finish(self) -> Result<EncodedPng, Error> {
        let Self { path, tries } = self;
        let finish = |attempt: Try| -> io::Result<(u64, File)> {
            attempt.rows.finish()?;
            Ok((attempt.file.metadata()?.len(), attempt.file))
        };
        let files: io::Result<Vec<_>> = tries.into_iter().map(finish).collect();
        let smallest = files.map(|files| files.into_iter().min_by_key(|(bytes, _)| *bytes));
        match smallest {
            Ok(Some((_, file))) => Ok(EncodedPng { path, file }),
            // Never: every effort has a filter.
            Ok(None) => Err(Error::from(AssetError::Io { path, error: io::ErrorKind::InvalidInput.into() })),
            Err(error) => Err(Error::from(AssetError::Io { path, error })),
        }
    }
}

/// A complete PNG that is not in its place yet.
pub struct EncodedPng {
    path: PathBuf,
    file: File,
}

impl EncodedPng {
    /// Writes the file as [`haze_preset::write_file`] does.
    ///
    /// # Errors
    /// [`AssetError::Io`] if it cannot be written.
    pub fn write(&self) -> Result<(), Error> {
        let mut file = &self.file;
        file.rewind().map_err(|error| Error::from(AssetError::Io { path: self.path.clone(), error }))?;
        Ok(write_file_from(&self.path, &mut file)?)
    }
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage, RgbaImage};

    use super::*;
    use haze_preset::write_png;

    #[test]
    fn rows_become_the_pixels_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        // Smooth: noise would be stored without compression in one file and not in the other.
        let code = |index: usize| (index / 29 % 251) as u8;
        let codes: Vec<_> = (0..37 * 24 * 4).map(code).collect();
        let rgb = codes[..37 * 24 * 3].to_vec();
        let images: [DynamicImage; 2] =
            [RgbImage::from_raw(37, 24, rgb).unwrap().into(), RgbaImage::from_raw(37, 24, codes).unwrap().into()];
        for image in &images {
            for effort in [CompressionEffort::Quick, CompressionEffort::Small] {
                let [path, whole] = ["rows.png", "whole.png"].map(|name| folder.path().join(name));
                let has_alpha = image.color().has_alpha();
                let shape = PngShape { width: 37, height: 24, has_alpha, path: path.clone(), scratch: folder.path() };
                let mut rows = PngStream::new(shape, effort).unwrap();
                // Three times eight rows.
                image.as_bytes().chunks(image.as_bytes().len() / 3).for_each(|part| rows.write_rows(part).unwrap());
                let encoded = rows.finish().unwrap();
                assert!(!path.exists());
                encoded.write().unwrap();
                write_png(&whole, image, effort).unwrap();
                assert_eq!(image::open(&path).unwrap(), *image);
                let bytes = |path| std::fs::metadata(path).unwrap().len();
                // The stream has more chunks.
                assert!(bytes(&path) < bytes(&whole) + 200, "{} {}", bytes(&path), bytes(&whole));
                std::fs::remove_file(path).unwrap();
            }
        }
    }

    #[test]
    fn missing_rows_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let shape = PngShape { width: 4, height: 4, has_alpha: false, path, scratch: folder.path() };
        let mut rows = PngStream::new(shape, CompressionEffort::Quick).unwrap();
        rows.write_rows(&[0; 24]).unwrap();
        assert!(rows.finish().is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
