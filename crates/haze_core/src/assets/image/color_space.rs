//! Decodes PNGs of colors and converts them to sRGB by the file's color tags.

use std::path::Path;

use glam::{DMat3, Vec3};
use image::{DynamicImage, ImageBuffer, Rgba};

use super::icc_profile::is_srgb;
use super::png::{decode_with_profile, is_png, read_file};
use super::png_chunks::{ColorTags, color_tags};
use super::primaries::{self, BT2020, D65, DISPLAY_P3, Primaries, SRGB, differs, xyz_from_linear};
use crate::error::{AssetError, display_path};
use crate::formula::color::{linear_from_srgb, srgb_from_linear};

/// Decodes a PNG of colors, such as a ramp or a motif. The result is sRGB and opaque.
///
/// Of several tags the first of cICP, iCCP, sRGB, gAMA with cHRM applies (PNG 3, 4.3); without tags the image is sRGB.
/// cICP may have the primaries of sRGB, Display P3 or BT.2020 and the transfer function sRGB, linear, 2.2 or 2.8. cHRM
/// may have any primaries with white point D65. An ICC profile must be sRGB. Colors outside sRGB are clamped.
/// Transparent pixels are composited over black in linear light.
///
/// # Errors
/// As [`decode_png`](super::decode_png), and [`AssetError::Image`] for an unsupported color space.
pub fn decode_color_png(path: &Path, bytes: &[u8]) -> Result<DynamicImage, AssetError> {
    let tags = color_tags(bytes).unwrap_or_default();
    let space = |profile: Option<&[u8]>| {
        tags.space(profile).map_err(|found| {
            let reason = format!("{found}; expected sRGB: convert the image to sRGB when exporting it");
            AssetError::Image { path: path.into(), reason }
        })
    };
    // The decoder reports some code points as a damaged file, so they are checked first.
    if is_png(bytes) && tags.cicp.is_some() {
        space(None)?;
    }
    let (image, profile) = decode_with_profile(path, bytes)?;
    let space = space(profile.as_deref())?;
    Ok(space.to_srgb(image))
}

/// Reads and decodes a PNG file of colors.
///
/// # Errors
/// [`AssetError::Io`] if the file cannot be read or is larger than 64 MiB, otherwise as [`decode_color_png`].
pub fn read_color_png(path: &Path) -> Result<DynamicImage, AssetError> {
    decode_color_png(path, &read_file(path)?)
}

/// Returns notes about the conversions that [`decode_color_png`] applies to a file, or why it refuses the file. Empty
/// for an opaque sRGB image.
///
/// # Errors
/// As [`read_color_png`], except that an unsupported color space is a note.
pub fn color_conversion_notes(path: &Path) -> Result<Vec<String>, AssetError> {
    let bytes = read_file(path)?;
    let (image, profile) = decode_with_profile(path, &bytes)?;
    let mut notes = Vec::new();
    match color_tags(&bytes).unwrap_or_default().space(profile.as_deref()) {
        Err(found) => notes.push(format!("{found}; expected sRGB: it is refused")),
        Ok(space) => {
            if let Transfer::Power(power) = space.transfer {
                notes.push(format!("gamma {power:.2}; expected sRGB: it is converted"));
            }
            if space.srgb_from_linear.is_some() {
                notes.push("primaries of another color space; expected sRGB: colors outside sRGB are clamped".into());
            }
        }
    }
    if !is_opaque(&image) {
        notes.push("transparent texels; expected opaque ones: they are composited over black".into());
    }
    Ok(notes)
}

fn is_opaque(image: &DynamicImage) -> bool {
    !image.color().has_alpha() || image.to_rgba16().pixels().all(|pixel| pixel.0[3] == u16::MAX)
}

/// Conversion from an image's code values to linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Space {
    transfer: Transfer,
    /// Matrix from the image's primaries to linear sRGB; `None` for sRGB primaries.
    srgb_from_linear: Option<DMat3>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Transfer {
    Srgb,
    /// Light = code ^ power.
    Power(f32),
}

impl ColorTags {
    /// Returns the color space of the tags. The error describes an unsupported one.
    fn space(&self, profile: Option<&[u8]>) -> Result<Space, String> {
        let srgb = Space { transfer: Transfer::Srgb, srgb_from_linear: None };
        if let Some(code @ [primaries, transfer, matrix, full]) = self.cicp {
            let [a, b, c, d] = code;
            let found = || format!("colors of the cICP code points {a}-{b}-{c}-{d}");
            let primaries = match primaries {
                1 => SRGB,
                9 => BT2020,
                12 => DISPLAY_P3,
                _ => return Err(found()),
            };
            let transfer = match transfer {
                4 => Transfer::Power(2.2),
                5 => Transfer::Power(2.8),
                8 => Transfer::Power(1.0),
                13 => Transfer::Srgb,
                _ => return Err(found()),
            };
            if (matrix, full) != (0, 1) {
                return Err(found());
            }
            return Ok(Space { transfer, srgb_from_linear: from_primaries(primaries)? });
        }
        if let Some(profile_name) = &self.profile {
            let found = || format!("the color profile \"{}\"", display_path(Path::new(profile_name)));
            return if profile.is_some_and(is_srgb) { Ok(srgb) } else { Err(found()) };
        }
        if self.srgb {
            return Ok(srgb);
        }
        // An exponent of 0 is invalid and ignored.
        let power = |&gamma: &u32| (gamma > 0).then(|| Transfer::Power(100_000.0 / gamma as f32));
        let transfer = self.gamma.as_ref().and_then(power).unwrap_or(Transfer::Srgb);
        let primaries =
            self.primaries.map(|primaries| primaries.map(|position| position.map(|x| f64::from(x) / 100_000.0)));
        Ok(Space { transfer, srgb_from_linear: from_primaries(primaries.unwrap_or(SRGB))? })
    }
}

/// Returns the matrix from linear light of these primaries to linear sRGB; `None` for sRGB primaries.
fn from_primaries(primaries: Primaries) -> Result<Option<DMat3>, String> {
    if differs(&primaries[0], &D65) {
        return Err(format!("colors with the white point {}, {}", primaries[0][0], primaries[0][1]));
    }
    if primaries::is_srgb(&primaries) {
        return Ok(None);
    }
    let matrix = xyz_from_linear(SRGB).inverse() * xyz_from_linear(primaries);
    if matrix.is_finite() { Ok(Some(matrix)) } else { Err("degenerate primaries".into()) }
}

impl Space {
    fn to_srgb(self, image: DynamicImage) -> DynamicImage {
        let is_srgb = self.transfer == Transfer::Srgb && self.srgb_from_linear.is_none();
        if is_srgb && is_opaque(&image) {
            return image;
        }
        let light = |code: u16| {
            let code = f32::from(code) / 65535.0;
            match self.transfer {
                Transfer::Srgb => linear_from_srgb(code),
                Transfer::Power(power) => code.powf(power),
            }
        };
        let lights: Vec<_> = (0..=u16::MAX).map(light).collect();
        let image = image.into_rgba16();
        let texel = |pixel: &Rgba<u16>| {
            let [r, g, b, a] = pixel.0;
            let mut light = Vec3::from([r, g, b].map(|code| lights[usize::from(code)]));
            if let Some(matrix) = self.srgb_from_linear {
                light = (matrix * light.as_dvec3()).as_vec3();
            }
            let light = light.clamp(Vec3::ZERO, Vec3::ONE) * (f32::from(a) / 65535.0);
            light.to_array().map(|light| (srgb_from_linear(light) * 65535.0).round() as u16)
        };
        let texels = image.pixels().flat_map(texel).collect();
        ImageBuffer::from_raw(image.width(), image.height(), texels)
            .map_or_else(DynamicImage::default, DynamicImage::ImageRgb16)
    }
}

#[cfg(test)]
mod tests;
