//! Converts six-way light maps of other tools: two images of three sides each, with linear values instead of square
//! roots.

use std::path::Path;

use glam::Vec3;
use image::{Rgba, RgbaImage};

use haze_core::error::AssetError;
use haze_core::formula::six_way::{SixWay, six_way_from_texel};
use haze_core::settings::choice;

choice! {
    /// Assignment of sides to the red, green and blue of two light maps. Alpha of the first map is the amount; alpha of the
    /// second too, unless it is emission.
    Packing {
        /// Unity's VFX Graph: right, top, back; left, bottom, front. Alpha of the second is emission.
        #[default]
        Unity = "unity",
        /// Common for Unreal and Houdini: right, left, top; bottom, back, front.
        RltBbf = "rlt_bbf",
    }
}

impl Packing {
    /// Returns true if alpha of the second map is emission, the luminance of fire. It is the amount otherwise.
    pub fn has_emission(self) -> bool {
        self == Self::Unity
    }

    /// Unpacks the six sides from two texels.
    pub fn six_way(self, first: Vec3, second: Vec3) -> SixWay {
        let a = first;
        let b = second;
        match self {
            Self::Unity => SixWay { positive: Vec3::new(a.x, a.y, b.z), negative: Vec3::new(b.x, b.y, a.z) },
            Self::RltBbf => SixWay { positive: Vec3::new(a.x, a.z, b.z), negative: Vec3::new(a.y, b.x, b.y) },
        }
    }

    /// Packs the six sides into two texels.
    pub fn texels(self, SixWay { positive: p, negative: n }: SixWay) -> [Vec3; 2] {
        match self {
            Self::Unity => [Vec3::new(p.x, p.y, n.z), Vec3::new(n.x, n.y, p.z)],
            Self::RltBbf => [Vec3::new(p.x, n.x, p.y), Vec3::new(n.y, n.z, p.z)],
        }
    }
}

/// Builds a sheet of six-way maps from two light maps of equal size.
pub fn pack(first: &RgbaImage, second: &RgbaImage, packing: Packing) -> RgbaImage {
    let (width, height) = first.dimensions();
    RgbaImage::from_fn(width, 2 * height, |x, y| {
        let [a, b] = [first, second].map(|map| map.get_pixel(x, y % height));
        let light = packing.six_way(decode_texel(a), decode_texel(b));
        encode_texel(if y < height { light.positive } else { light.negative }, a.0[3])
    })
}

/// Splits a sheet into two light maps. Alpha is the amount; in the second map 0 if the packing has emission there, because a
/// sprite does not burn.
///
/// # Errors
/// [`AssetError::Image`] if the sheet's height is odd or 0.
pub fn unpack(path: &Path, sheet: &RgbaImage, packing: Packing) -> Result<[RgbaImage; 2], AssetError> {
    let width = sheet.width();
    let height = sheet.height() / 2;
    if !sheet.height().is_multiple_of(2) || height == 0 {
        let reason =
            format!("{width}x{} pixels; expected six-way maps, of two halves below each other", sheet.height());
        return Err(AssetError::Image { path: path.into(), reason });
    }
    Ok([0, 1].map(|map| {
        RgbaImage::from_fn(width, height, |x, y| {
            let [positive, negative] = [y, y + height].map(|y| sheet.get_pixel(x, y));
            let [p, n] = [positive, negative].map(|texel| six_way_from_texel(decode_texel(texel)));
            let light = packing.texels(SixWay { positive: p, negative: n })[map];
            let [r, g, b] = light.to_array().map(|light| (light * 255.0).round() as u8);
            let is_emission = map == 1 && packing.has_emission();
            Rgba([r, g, b, if is_emission { 0 } else { positive.0[3] }])
        })
    }))
}

/// Encodes a texel of either half.
pub(in crate::sprite) fn encode_texel(light: Vec3, alpha: u8) -> Rgba<u8> {
    let [r, g, b] = light.to_array().map(|light| (light.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8);
    Rgba([r, g, b, alpha])
}

fn decode_texel(texel: &Rgba<u8>) -> Vec3 {
    let [r, g, b, _] = texel.0.map(|channel| f32::from(channel) / 255.0);
    Vec3::new(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet with a different value per side, coarse enough for 8-bit linear values.
    fn sheet() -> RgbaImage {
        RgbaImage::from_fn(3, 4, |x, y| {
            let half = (y / 2) as f32;
            encode_texel(Vec3::new(0.9, 0.5, 0.2) - 0.1 * half - 0.01 * x as f32, 40 * (y % 2) as u8)
        })
    }

    #[test]
    fn unpacking_and_packing_round_trips() {
        for &packing in Packing::ALL {
            let sheet = sheet();
            let [first, second] = unpack(Path::new("smoke.png"), &sheet, packing).unwrap();
            assert_eq!(first.dimensions(), (3, 2));
            let again = pack(&first, &second, packing).into_raw();
            let apart = again.into_iter().zip(sheet.into_raw()).map(|(a, b)| a.abs_diff(b));
            assert!(apart.max().unwrap() <= 1, "{}", packing.name());
            let is_amount = second.pixels().zip(first.pixels()).all(|(second, first)| second.0[3] == first.0[3]);
            assert_eq!(is_amount, packing != Packing::Unity);
            assert!(is_amount || second.pixels().all(|texel| texel.0[3] == 0));
        }
        let odd = RgbaImage::new(4, 5);
        assert!(unpack(Path::new("smoke.png"), &odd, Packing::Unity).unwrap_err().to_string().contains("two halves"));
    }

    #[test]
    fn sides_are_in_the_channels_that_other_tools_use() {
        let a = Vec3::new(1.0, 2.0, 3.0);
        let b = Vec3::new(4.0, 5.0, 6.0);
        let unity = SixWay { positive: Vec3::new(1.0, 2.0, 6.0), negative: Vec3::new(4.0, 5.0, 3.0) };
        let rlt_bbf = SixWay { positive: Vec3::new(1.0, 3.0, 6.0), negative: Vec3::new(2.0, 4.0, 5.0) };
        for (packing, light) in [(Packing::Unity, unity), (Packing::RltBbf, rlt_bbf)] {
            assert_eq!(packing.six_way(a, b), light);
            assert_eq!(packing.texels(light), [a, b]);
        }
    }
}
