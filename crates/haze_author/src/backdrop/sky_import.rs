//! Reads a panorama: Radiance (.hdr) or OpenEXR (.exr).

use std::io::Cursor;
use std::path::Path;

use glam::{UVec2, Vec3};
use haze_core::assets::bounded_read;
use haze_core::assets::image::catch_decoder_panic;
use haze_core::error::{Error, one_line};
use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::{DynamicImage, ImageDecoder};

use super::file_limits::MAX_BACKDROP_FILE_BYTES;
use super::sky_image::{MAX_SKY_WIDTH, SkyImage};

/// Loads a panorama.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Image`] with the reason.
pub fn load_sky(path: &Path) -> Result<SkyImage, Error> {
    let bytes = bounded_read::read(path, "panorama", MAX_BACKDROP_FILE_BYTES)?;
    let refuse = |reason| Error::Image { path: path.into(), reason };
    let decoded = catch_decoder_panic(|| decode(&bytes));
    let image = decoded.unwrap_or_else(|| Err("damaged".into()));
    let image =
        image.map_err(|reason| refuse(format!("{reason}; expected a Radiance (.hdr) or OpenEXR (.exr) image")))?;
    let size = UVec2::new(image.width(), image.height());
    let radiance = image.into_rgb32f();
    SkyImage::new(size, radiance.pixels().map(|pixel| Vec3::from(pixel.0)), path).map_err(refuse)
}

fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    // By content: either may have the other's ending.
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        checked(OpenExrDecoder::new(Cursor::new(bytes)).map_err(one_line)?)
    } else {
        checked(HdrDecoder::new(Cursor::new(bytes)).map_err(one_line)?)
    }
}

/// Decodes an image whose size is in range, so that little memory is asked for.
fn checked(decoder: impl ImageDecoder) -> Result<DynamicImage, String> {
    let (width, height) = decoder.dimensions();
    if width > MAX_SKY_WIDTH || height > MAX_SKY_WIDTH {
        return Err(format!("{width}x{height} texels, more than {MAX_SKY_WIDTH}x{}", MAX_SKY_WIDTH / 2));
    }
    DynamicImage::from_decoder(decoder).map_err(one_line)
}
