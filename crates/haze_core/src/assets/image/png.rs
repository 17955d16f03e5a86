//! Reads PNG files, with size limits for files from users.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder as _, ImageError, Limits};

use super::decoder_panic::catch_decoder_panic;
use super::png_chunks::color_tags;
use crate::assets::bounded_read;
use crate::error::AssetError;

/// Maximum side of an image, pixels.
pub const MAX_SIDE: u32 = 4096;
/// Maximum size of a PNG file, and of its decoded pixels, bytes.
pub const MAX_BYTES: u64 = 64 << 20;

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// True if the data begins with the PNG signature.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(SIGNATURE)
}

/// Decodes a PNG in memory. `path` is used only in errors.
///
/// # Errors
/// [`AssetError::Image`] if the data is damaged, not a PNG, larger than 4096 pixels per side, or larger than 64 MiB when
/// decoded.
pub fn decode_png(path: &Path, bytes: &[u8]) -> Result<DynamicImage, AssetError> {
    decode_with_profile(path, bytes).map(|(image, _)| image)
}

/// Decodes a PNG and returns the image with its ICC profile.
pub(super) fn decode_with_profile(path: &Path, bytes: &[u8]) -> Result<(DynamicImage, Option<Vec<u8>>), AssetError> {
    let refuse = |reason: String| Err(AssetError::Image { path: path.into(), reason });
    if !is_png(bytes) {
        return refuse("not a PNG file; export it as PNG".into());
    }
    // The first chunk is the header, which begins with width and height.
    let side = |at: usize| bytes.get(at..at + 4).and_then(|side| side.try_into().ok()).map(u32::from_be_bytes);
    let (Some(width), Some(height)) = (side(16), side(20)) else { return refuse(describe_decode_error(None)) };
    if width.max(height) > MAX_SIDE {
        return refuse(format!("{width}x{height} pixels; expected at most {MAX_SIDE}x{MAX_SIDE}"));
    }
    let Some(tags) = color_tags(bytes) else { return refuse(describe_decode_error(None)) };
    if let Some(palette) = tags.palette_bytes.filter(|&palette| !is_palette_length(palette)) {
        return refuse(format!("a palette of {palette} bytes; expected 3 bytes for each of 1 to 256 colors"));
    }
    match catch_decoder_panic(|| decode_pixels(bytes)) {
        Some(Ok(decoded)) => Ok(decoded),
        Some(Err(DecodeError::TooLarge(decoded))) => {
            let texel = decoded / (u64::from(width) * u64::from(height));
            let most = MAX_BYTES >> 20;
            refuse(format!(
                "{} MiB in memory, {width}x{height} pixels of {texel} bytes; expected at most {most} MiB",
                decoded >> 20
            ))
        }
        Some(Err(DecodeError::Damaged(error))) => refuse(describe_decode_error(Some(&error))),
        None => refuse(DAMAGED.into()),
    }
}

/// True for 3 bytes for each of 1 to 256 colors. (PNG specification, 11.2.2)
fn is_palette_length(bytes: usize) -> bool {
    bytes.is_multiple_of(3) && (3..=768).contains(&bytes)
}

enum DecodeError {
    /// Bytes of the decoded image.
    TooLarge(u64),
    Damaged(ImageError),
}

/// Calls the decoder, which may panic.
fn decode_pixels(bytes: &[u8]) -> Result<(DynamicImage, Option<Vec<u8>>), DecodeError> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(DecodeError::Damaged)?;
    // The decoder's own limit does not count the decoded image.
    let decoded = decoder.total_bytes();
    if decoded > MAX_BYTES {
        return Err(DecodeError::TooLarge(decoded));
    }
    // A profile that cannot be decoded is ignored.
    let profile = decoder.icc_profile().unwrap_or_default();
    let image = DynamicImage::from_decoder(decoder).map_err(DecodeError::Damaged)?;
    Ok((image, profile))
}

const DAMAGED: &str = "a damaged PNG; expected one that other programs can open: export it again";

/// Returns a message about a damaged PNG. The decoder's own messages assume knowledge of its code.
fn describe_decode_error(error: Option<&ImageError>) -> String {
    let most = MAX_BYTES >> 20;
    match error {
        None => "the file ends too early; expected a whole PNG".into(),
        Some(ImageError::IoError(error)) if error.kind() == ErrorKind::UnexpectedEof => describe_decode_error(None),
        Some(ImageError::Limits(_)) => format!("it takes more than {most} MiB to decode; expected a smaller PNG"),
        Some(_) => DAMAGED.into(),
    }
}

/// Reads a PNG file of at most 64 MiB, without decoding it.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be read or is larger.
pub fn read_file(path: &Path) -> Result<Vec<u8>, AssetError> {
    bounded_read::read(path, "PNG file", MAX_BYTES)
}

/// Reads and decodes a PNG file.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be read or is larger than 64 MiB, otherwise as [`decode_png`].
pub fn read_png(path: &Path) -> Result<DynamicImage, AssetError> {
    decode_png(path, &read_file(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::image::png_chunks::chunk;

    #[test]
    fn damaged_pngs_are_refused_with_the_file_name() {
        let path = Path::new("ramps/broken.png");
        let message = |bytes: &[u8]| decode_png(path, bytes).unwrap_err().to_string();
        assert!(message(b"GIF89a").starts_with("ramps/broken.png: not a PNG"));
        assert!(message(b"\x89PNG\r\n\x1a\n garbage").starts_with("ramps/broken.png: "));
        // A header with 100000 x 100000 pixels is refused before memory is allocated.
        let mut huge = Vec::new();
        DynamicImage::new_rgb8(1, 1).write_to(&mut Cursor::new(&mut huge), image::ImageFormat::Png).unwrap();
        huge[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
        huge[20..24].copy_from_slice(&100_000_u32.to_be_bytes());
        assert!(message(&huge).contains("4096x4096"), "{}", message(&huge));
    }

    #[test]
    fn a_palette_of_broken_length_is_refused() {
        let header = [&1_u32.to_be_bytes()[..], &1_u32.to_be_bytes(), &[8, 3, 0, 0, 0]].concat();
        // One row: no filter, index 0; stored without compression, with its Adler-32 checksum.
        let pixels = [0x78, 0x01, 0x01, 2, 0, 0xfd, 0xff, 0, 0, 0, 2, 0, 1];
        let png = |palette: usize| {
            let chunks = [chunk(b"IHDR", &header), chunk(b"PLTE", &vec![7; palette]), chunk(b"IDAT", &pixels)];
            [SIGNATURE, &chunks.concat(), &chunk(b"IEND", &[])].concat()
        };
        assert_eq!(decode_png(Path::new("a.png"), &png(3)).unwrap().into_rgb8().get_pixel(0, 0).0, [7; 3]);
        for length in [0, 771] {
            let error = decode_png(Path::new("a.png"), &png(length)).unwrap_err().to_string();
            assert!(error.starts_with(&format!("a.png: a palette of {length} bytes; expected 3 bytes")), "{error}");
        }
        assert!([3, 6, 765, 768].into_iter().all(is_palette_length));
        assert!(![0, 1, 4, 5, 767, 769, 771].into_iter().any(is_palette_length));
    }

    #[test]
    fn a_truncated_png_is_refused() {
        let mut whole = Vec::new();
        let image = image::RgbImage::from_fn(16, 2, |x, y| image::Rgb([(x * 16) as u8, y as u8, (x * y) as u8]));
        image.write_to(&mut Cursor::new(&mut whole), image::ImageFormat::Png).unwrap();
        for end in 0..whole.len() {
            let error = decode_png(Path::new("a.png"), &whole[..end]).unwrap_err().to_string();
            assert!(error.starts_with("a.png: ") && error.lines().count() == 1, "{end}: {error}");
        }
        assert!(decode_png(Path::new("a.png"), &whole).is_ok());
    }
}
