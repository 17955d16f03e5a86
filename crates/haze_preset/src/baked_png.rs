//! PNGs that were baked from a recipe carry a mark. It tells them from painted PNGs, which no bake may replace.
//!
//! The mark is a tEXt chunk before the last chunk: the hash of all bytes before it. A program that saves the PNG drops the
//! chunk or changes the bytes, so the mark is valid only in a file as it was baked. The time of the last change does
//! not tell: copies and checkouts have another one.

use std::path::Path;

use image::DynamicImage;

use haze_core::assets::image::png_chunks::chunk;
use haze_core::assets::image::read_file;
use haze_core::error::AssetError;

use crate::atomic_write::write_file;
use crate::png_writer::{CompressionEffort, encode_png};

const KEYWORD: &[u8] = b"haze bake\0";
const MARK_BYTES: usize = 12 + KEYWORD.len() + 16;

/// Writes the image of a recipe as a small PNG with a mark, as [`write_file`] does.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be written.
pub fn write_baked_png(path: &Path, image: &DynamicImage) -> Result<(), AssetError> {
    write_file(path, &encode_baked_png(path, image)?)
}

/// Encodes the image of a recipe as [`write_baked_png`] writes it. `path` is used only in errors.
///
/// # Errors
/// [`AssetError::Io`] if the encoder fails.
pub fn encode_baked_png(path: &Path, image: &DynamicImage) -> Result<Vec<u8>, AssetError> {
    Ok(marked(encode_png(path, image, CompressionEffort::Small)?))
}

/// Returns true if [`write_baked_png`] wrote the file and its bytes have not changed since.
pub fn is_baked_png(path: &Path) -> bool {
    read_file(path).is_ok_and(|bytes| is_marked(&bytes))
}

fn marked(mut png: Vec<u8>) -> Vec<u8> {
    let end = chunk(b"IEND", &[]);
    if png.ends_with(&end) {
        png.truncate(png.len() - end.len());
        let mark = mark(&png);
        png.extend(mark);
        png.extend(end);
    }
    png
}

fn is_marked(png: &[u8]) -> bool {
    let content = png.strip_suffix(&*chunk(b"IEND", &[]));
    let parts = content.and_then(|content| content.split_last_chunk::<MARK_BYTES>());
    parts.is_some_and(|(pixels, last)| *last == *mark(pixels))
}

fn mark(bytes: &[u8]) -> Vec<u8> {
    // FNV-1a of 64 bits: it only has to notice changes that nobody makes on purpose.
    let hash = bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    chunk(b"tEXt", &[KEYWORD, format!("{hash:016x}").as_bytes()].concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png_writer::write_png;
    use haze_core::assets::image::read_png;

    #[test]
    fn a_baked_png_is_told_from_the_same_pixels_saved_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(!is_baked_png(&path));
        let pixels = image::ImageBuffer::from_fn(9, 3, |x, y| image::Rgb([x as u16, y as u16, 65535]));
        let image = DynamicImage::from(pixels);
        write_baked_png(&path, &image).unwrap();
        assert!(is_baked_png(&path) && read_png(&path).unwrap() == image);
        write_png(&path, &image, CompressionEffort::Small).unwrap();
        assert!(!is_baked_png(&path));
    }

    #[test]
    fn a_change_of_any_byte_invalidates_the_mark() {
        let image = DynamicImage::new_rgb8(3, 2);
        let good = marked(encode_png(Path::new("a.png"), &image, CompressionEffort::Small).unwrap());
        assert!(is_marked(&good));
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 1;
            assert!(!is_marked(&bytes), "{at}");
        }
        assert!((0..good.len()).all(|end| !is_marked(&good[..end])));
    }
}
