//! Reads a panorama: Radiance (.hdr) or OpenEXR (.exr).

use std::io::{Cursor, Read as _};
use std::ops::RangeInclusive;
use std::path::Path;

use glam::{DMat3, DVec3, UVec2, Vec3};
use haze_core::assets::bounded_read;
use haze_core::assets::image::catch_decoder_panic;
use haze_core::error::AssetError;
use image::codecs::hdr::{HdrDecoder, HdrMetadata};
use image::codecs::openexr::OpenExrDecoder;
use image::{DynamicImage, ImageDecoder, ImageResult};

use super::decode_problem::decode_problem;
use super::exr_header;
use super::file_limits::MAX_BACKDROP_FILE_BYTES;
use super::sky_image::{MAX_SKY_WIDTH, SkyImage};

/// First line of a Radiance file as the decoder expects it.
const SIGNATURE: &[u8] = b"#?RADIANCE";

/// Format of a Radiance file whose colors are CIE XYZ.
const XYZE: &[u8] = b"32-bit_rle_xyze";
/// Factors of the colors of a Radiance file. Those of photographs are within by far, and radiance stays finite.
const EXPOSURES: RangeInclusive<f64> = 1.0e-9..=1.0e9;
/// Length of a Radiance header in which the format is looked for, bytes.
const MAX_HDR_HEADER: usize = 1 << 16;

/// Loads a panorama. Its colors become linear Rec.709.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be read; [`AssetError::Image`] with the reason.
pub fn load_sky(path: &Path) -> Result<SkyImage, AssetError> {
    let bytes = bounded_read::read(path, "panorama", MAX_BACKDROP_FILE_BYTES)?;
    let refuse = |reason| AssetError::Image { path: path.into(), reason };
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
    /// Matrix from its colors to radiance in linear Rec.709.
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
    let decoder = HdrDecoder::new(SIGNATURE.chain(rest));
    let conversion = decoder.as_ref().map_or(Ok(None), |decoder| to_radiance(&decoder.metadata()))?;
    let image = pixels(decoder, expected)?;
    Ok(Decoded { image, conversion })
}

/// Matrix from the colors of a Radiance file to radiance. A program that multiplies all colors says the factor in its header:
/// `EXPOSURE`, and for each channel `COLORCORR`. Several lines multiply each other, as the decoder returns them.
/// (Radiance, "The RADIANCE Image File Format")
fn to_radiance(header: &HdrMetadata) -> Result<Option<DMat3>, String> {
    let exposure = header.exposure.unwrap_or(1.0);
    let (red, green, blue) = header.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let factors = DVec3::new(f64::from(red), f64::from(green), f64::from(blue)) * f64::from(exposure);
    if factors.to_array().iter().all(|factor| EXPOSURES.contains(factor)) {
        return Ok((factors != DVec3::ONE).then(|| DMat3::from_diagonal(factors.recip())));
    }
    let found = match header.color_correction {
        None => format!("EXPOSURE {exposure}"),
        Some(_) => format!("EXPOSURE times COLORCORR {} {} {}", factors.x, factors.y, factors.z),
    };
    Err(format!("its header has {found}; expected {} to {}", EXPOSURES.start(), EXPOSURES.end()))
}

/// Decodes an image whose size is in range, so that little memory is asked for.
fn pixels(decoder: ImageResult<impl ImageDecoder>, expected: &str) -> Result<DynamicImage, String> {
    let refuse = |error| decode_problem(&error, expected);
    let decoder = decoder.map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    if width > MAX_SKY_WIDTH || height > MAX_SKY_WIDTH {
        let most = MAX_SKY_WIDTH / 2;
        return Err(format!("{width}x{height} texels, more than {MAX_SKY_WIDTH}x{most}; expected a smaller panorama"));
    }
    DynamicImage::from_decoder(decoder).map_err(refuse)
}
