//! Opacity of a sheet: in alpha, or in a gray sheet of its own.

use image::RgbaImage;

/// Fraction of full alpha above which a sheet has no opacity. Filters of paint programs may leave a few other texels.
const OPAQUE_FRACTION: f32 = 0.98;

/// Difference between channels of a gray texel, of 255. Files that were compressed with losses on their way have some.
const GRAY_TOLERANCE: u8 = 3;

/// True if nearly all of these alphas are full.
pub(super) fn is_opaque(alphas: impl Iterator<Item = u8>) -> bool {
    let mut count = 0.0_f32;
    let mut full = 0.0;
    for alpha in alphas {
        count += 1.0;
        full += f32::from(alpha >= 250);
    }
    full > OPAQUE_FRACTION * count
}

/// True if alpha differs between texels and is not full nearly everywhere.
pub(super) fn has_alpha(sheet: &RgbaImage) -> bool {
    let mut least = u8::MAX;
    let mut most = u8::MIN;
    for texel in sheet.pixels() {
        least = least.min(texel.0[3]);
        most = most.max(texel.0[3]);
    }
    most.saturating_sub(least) > 2 && !is_opaque(sheet.pixels().map(|texel| texel.0[3]))
}

/// True if nearly all texels are gray.
pub(super) fn is_gray(sheet: &RgbaImage) -> bool {
    let colored = sheet.pixels().filter(|texel| {
        let [r, g, b, _] = texel.0;
        r.max(g).max(b) - r.min(g).min(b) > GRAY_TOLERANCE
    });
    let texels = u64::from(sheet.width()) * u64::from(sheet.height());
    (colored.count() as u64) * 50 <= texels
}

/// Returns the opacity of a sheet, row by row: its alpha, or its gray if it has no alpha.
pub(super) fn opacities(sheet: &RgbaImage) -> Vec<u8> {
    let channel = if has_alpha(sheet) { 3 } else { 0 };
    sheet.pixels().map(|texel| texel.0[channel]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    #[test]
    fn opacity_is_alpha_that_varies_or_else_gray() {
        let sheet = |texel: fn(u8) -> [u8; 4]| RgbaImage::from_fn(16, 16, |x, y| Rgba(texel((y * 16 + x) as u8)));
        let gray = sheet(|code| [code, code, code, 255]);
        assert!(is_gray(&gray) && !has_alpha(&gray));
        assert_eq!(opacities(&gray)[7], 7);
        let alpha = sheet(|code| [200, 100, 50, code]);
        assert!(!is_gray(&alpha) && has_alpha(&alpha));
        assert_eq!(opacities(&alpha)[7], 7);
        assert!(!has_alpha(&sheet(|_| [9, 9, 9, 128])) && !has_alpha(&sheet(|code| [9, 9, 9, 250 + code % 6])));
    }
}
