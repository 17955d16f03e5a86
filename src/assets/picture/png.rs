//! PNG in and out, with the limits that any file from outside must respect.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ImageDecoder as _, ImageError, Limits};

use super::chunks::colour_tags;
use super::file::write_file;
use crate::assets::file;
use crate::assets::threads::on_all_processors;
use crate::error::Error;

/// Largest side of a picture that is read, pixels.
pub const MAX_SIDE: u32 = 4096;
/// Most bytes of a PNG file, and most memory that its decoded pixels may take.
pub const MAX_BYTES: u64 = 64 << 20;

/// Three times as fast as the best there is, and 3 % larger.
const SMALL: CompressionType = CompressionType::Level(6);

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// True for a file that begins as a PNG does.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(SIGNATURE)
}

/// Decodes a PNG held in memory. `path` is only named in errors.
///
/// # Errors
/// [`Error::Image`] for a broken file, one that is no PNG, or one beyond 4096 pixels a side or 64 MiB once decoded.
pub fn decode_png(path: &Path, bytes: &[u8]) -> Result<DynamicImage, Error> {
    decode_with_profile(path, bytes).map(|(picture, _)| picture)
}

/// The same with its colour profile.
pub(super) fn decode_with_profile(path: &Path, bytes: &[u8]) -> Result<(DynamicImage, Option<Vec<u8>>), Error> {
    let refuse = |reason: String| Err(Error::Image { path: path.into(), reason });
    if !is_png(bytes) {
        return refuse("not a PNG file; export it as PNG".into());
    }
    // A PNG begins with its header, and that with width and height.
    let side = |at: usize| bytes.get(at..at + 4).and_then(|side| side.try_into().ok()).map(u32::from_be_bytes);
    let (Some(width), Some(height)) = (side(16), side(20)) else { return refuse(broken(None)) };
    if width.max(height) > MAX_SIDE {
        return refuse(format!("{width}x{height} pixels; expected at most {MAX_SIDE}x{MAX_SIDE}"));
    }
    if colour_tags(bytes).is_none() {
        return refuse(broken(None));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    let mut decoder = match PngDecoder::with_limits(Cursor::new(bytes), limits) {
        Ok(decoder) => decoder,
        Err(error) => return refuse(broken(Some(&error))),
    };
    // The decoder's own limit leaves out the picture that it decodes into.
    let (decoded, most) = (decoder.total_bytes(), MAX_BYTES >> 20);
    if decoded > MAX_BYTES {
        let texel = decoded / (u64::from(width) * u64::from(height));
        return refuse(format!(
            "{} MiB in memory, {width}x{height} pixels of {texel} bytes; expected at most {most} MiB",
            decoded >> 20
        ));
    }
    // A profile that cannot be read is none.
    let profile = decoder.icc_profile().unwrap_or_default();
    match DynamicImage::from_decoder(decoder) {
        Ok(picture) => Ok((picture, profile)),
        Err(error) => refuse(broken(Some(&error))),
    }
}

/// What is wrong with a PNG. The decoder's own words are for those who know its code.
fn broken(error: Option<&ImageError>) -> String {
    let most = MAX_BYTES >> 20;
    match error {
        None => "the file ends too early; expected a whole PNG".into(),
        Some(ImageError::IoError(error)) if error.kind() == ErrorKind::UnexpectedEof => broken(None),
        Some(ImageError::Limits(_)) => format!("it takes more than {most} MiB to decode; expected a smaller PNG"),
        Some(_) => "a damaged PNG; expected one that other programs can open: export it again".into(),
    }
}

/// Reads and decodes a PNG file.
///
/// # Errors
/// [`Error::Io`] when it cannot be read or is larger than 64 MiB, else as [`decode_png`].
pub fn read_png(path: &Path) -> Result<DynamicImage, Error> {
    decode_png(path, &file::read(path, "PNG file", MAX_BYTES)?)
}

/// How long to look for a smaller file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// Fifteen times as fast, half as large again.
    #[default]
    Quick,
    /// Small: for files that are kept and shipped.
    Small,
}

/// Writes a PNG as [`write_file`] does.
///
/// # Errors
/// [`Error::Io`] when it cannot be written.
pub fn write_png(path: &Path, picture: &DynamicImage, effort: Effort) -> Result<(), Error> {
    let encoded = |compression, filter| -> Result<Vec<u8>, Error> {
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut bytes, compression, filter);
        let io = |error| Error::Io { path: path.into(), error: std::io::Error::other::<ImageError>(error) };
        picture.write_with_encoder(encoder).map_err(io)?;
        Ok(bytes)
    };
    let bytes = match effort {
        Effort::Quick => encoded(CompressionType::Fast, FilterType::Adaptive)?,
        Effort::Small => {
            // Which is smaller is found by trying.
            let mut tries = [FilterType::Adaptive, FilterType::Paeth].map(|filter| (filter, Ok(Vec::new())));
            on_all_processors(tries.iter_mut(), |(filter, bytes)| *bytes = encoded(SMALL, *filter));
            let [adaptive, paeth] = tries.map(|(_, bytes)| bytes);
            let (adaptive, paeth) = (adaptive?, paeth?);
            if paeth.len() < adaptive.len() { paeth } else { adaptive }
        }
    };
    write_file(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_pictures_are_one_error_that_names_the_file() {
        let path = Path::new("ramps/broken.png");
        let message = |bytes: &[u8]| decode_png(path, bytes).unwrap_err().to_string();
        assert!(message(b"GIF89a").starts_with("ramps/broken.png: not a PNG"));
        assert!(message(b"\x89PNG\r\n\x1a\n garbage").starts_with("ramps/broken.png: "));
        // A header that promises 100000 x 100000 pixels is refused before anything is allocated.
        let mut huge = Vec::new();
        DynamicImage::new_rgb8(1, 1).write_to(&mut Cursor::new(&mut huge), image::ImageFormat::Png).unwrap();
        huge[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
        huge[20..24].copy_from_slice(&100_000_u32.to_be_bytes());
        assert!(message(&huge).contains("4096x4096"), "{}", message(&huge));
    }

    #[test]
    fn a_picture_that_is_cut_anywhere_is_refused() {
        let mut whole = Vec::new();
        let picture = image::RgbImage::from_fn(16, 2, |x, y| image::Rgb([(x * 16) as u8, y as u8, (x * y) as u8]));
        picture.write_to(&mut Cursor::new(&mut whole), image::ImageFormat::Png).unwrap();
        for end in 0..whole.len() {
            let error = decode_png(Path::new("a.png"), &whole[..end]).unwrap_err().to_string();
            assert!(error.starts_with("a.png: ") && error.lines().count() == 1, "{end}: {error}");
        }
        assert!(decode_png(Path::new("a.png"), &whole).is_ok());
    }

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.png");
        assert!(write_png(&path, &DynamicImage::new_rgb8(2, 2), Effort::Quick).is_err());
        write_png(&folder.path().join("a.png"), &DynamicImage::new_rgb8(2, 2), Effort::Small).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
