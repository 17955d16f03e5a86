//! Reads a panorama: Radiance (.hdr) or OpenEXR (.exr).

use std::io::{Cursor, Read as _};
use std::path::Path;

use glam::{DMat3, UVec2, Vec3};
use haze_core::assets::bounded_read;
use haze_core::assets::image::catch_decoder_panic;
use haze_core::error::{Error, one_line};
use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::{DynamicImage, ImageDecoder, ImageResult};

use super::exr_header;
use super::file_limits::MAX_BACKDROP_FILE_BYTES;
use super::sky_image::{MAX_SKY_WIDTH, SkyImage};

/// First line of a Radiance file as the decoder expects it.
const SIGNATURE: &[u8] = b"#?RADIANCE";

/// Format of a Radiance file whose colors are CIE XYZ.
const XYZE: &[u8] = b"32-bit_rle_xyze";
/// Length of a Radiance header in which the format is looked for, bytes.
const MAX_HDR_HEADER: usize = 1 << 16;

/// Loads a panorama. Its colors become linear Rec.709.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Image`] with the reason.
pub fn load_sky(path: &Path) -> Result<SkyImage, Error> {
    let bytes = bounded_read::read(path, "panorama", MAX_BACKDROP_FILE_BYTES)?;
    let refuse = |reason| Error::Image { path: path.into(), reason };
    let decoded = catch_decoder_panic(|| decode(&bytes));
    let damaged = || Err("damaged; expected a whole image".into());
    let Decoded { image, conversion } = decoded.unwrap_or_else(damaged).map_err(refuse)?;
    let size = UVec2::new(image.width(), image.height());
    let radiance = image.into_rgb32f();
    let radiance = radiance.pixels().map(|pixel| {
        let color = Vec3::from(pixel.0);
        conversion.map_or(color, |conversion| (conversion * color.as_dvec3()).as_vec3())
    });
    SkyImage::new(size, radiance, path).map_err(refuse)
}

struct Decoded {
    image: DynamicImage,
    /// Matrix from its colors to linear Rec.709.
    conversion: Option<DMat3>,
}

fn decode(bytes: &[u8]) -> Result<Decoded, String> {
    // By content: either may have the other's ending.
    if bytes.starts_with(&exr_header::MAGIC) {
        let conversion = exr_header::check(bytes)?;
        let image = pixels(OpenExrDecoder::new(Cursor::new(bytes)), "a whole OpenEXR image")?;
        return Ok(Decoded { image, conversion });
    }
    let expected = "a Radiance (.hdr) or OpenEXR (.exr) image";
    // Programs write other first lines too: `#?RGBE`.
    let after_first_line = |rest: &'_ [u8]| rest.iter().position(|byte| *byte == b'\n');
    let rest = bytes.strip_prefix(b"#?").and_then(|rest| rest.get(after_first_line(rest)?..));
    let rest = rest.ok_or_else(|| format!("neither of the two; expected {expected}"))?;
    let header = rest.windows(2).take(MAX_HDR_HEADER).position(|two| two == b"\n\n").and_then(|end| rest.get(..end));
    if header.is_some_and(|header| header.windows(XYZE.len()).any(|text| text == XYZE)) {
        return Err("its colors are XYZ; expected RGB: export it as 32-bit_rle_rgbe".into());
    }
    let image = pixels(HdrDecoder::new(SIGNATURE.chain(rest)), expected)?;
    Ok(Decoded { image, conversion: None })
}

/// Decodes an image whose size is in range, so that little memory is asked for.
fn pixels(decoder: ImageResult<impl ImageDecoder>, expected: &str) -> Result<DynamicImage, String> {
    let refuse = |error| format!("{}; expected {expected}", one_line(error));
    let decoder = decoder.map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    if width > MAX_SKY_WIDTH || height > MAX_SKY_WIDTH {
        let most = MAX_SKY_WIDTH / 2;
        return Err(format!("{width}x{height} texels, more than {MAX_SKY_WIDTH}x{most}; expected a smaller panorama"));
    }
    DynamicImage::from_decoder(decoder).map_err(refuse)
}
