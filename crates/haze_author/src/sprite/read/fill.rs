//! Continues colors into clear texels, so that filters blend no other color in at the edge of smoke.

use glam::{IVec2, UVec2, Vec4};
use haze_core::assets::image::Image;

/// Returns the colors, with those of clear texels replaced by the mean of the smoke around them. Alpha is the amount.
pub(super) fn continue_edges(image: &Image<Vec4>) -> Image<Vec4> {
    // Each level has premultiplied sums of four texels of the one before.
    let mut levels = vec![Image { size: image.size, texels: image.texels.iter().map(weighted).collect() }];
    while let Some(fine) = levels.last().filter(|level| level.size.max_element() > 1) {
        let size = fine.size.map(|side| side.div_ceil(2));
        let mut coarse = Image::new(size, Vec4::ZERO);
        coarse.for_each(|at, sum| {
            for offset in [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE] {
                let near = 2 * at + offset;
                if near.cmplt(fine.size).all() {
                    *sum += fine.load(near.as_ivec2());
                }
            }
        });
        levels.push(coarse);
    }
    let mut filled = image.clone();
    filled.for_each(|at, texel| {
        if texel.w > MIN_AMOUNT {
            return;
        }
        let sums = (1..levels.len()).map(|level| levels[level].load((at.as_ivec2()) / IVec2::splat(1 << level)));
        if let Some(sum) = sums.into_iter().find(|sum| sum.w > MIN_AMOUNT) {
            *texel = (sum.truncate() / sum.w).extend(texel.w);
        }
    });
    filled
}

/// Amount of a texel that has a color of its own.
const MIN_AMOUNT: f32 = 1.5 / 255.0;

fn weighted(texel: &Vec4) -> Vec4 {
    if texel.w > MIN_AMOUNT { (texel.truncate() * texel.w).extend(texel.w) } else { Vec4::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn clear_texels_take_the_color_beside_them() {
        let mut image = Image::new(UVec2::new(7, 5), Vec3::ONE.extend(0.0));
        image.texels[7 * 2 + 3] = Vec4::new(0.2, 0.4, 0.6, 0.5);
        let filled = continue_edges(&image);
        assert!(filled.texels.iter().all(|texel| texel.truncate().distance(Vec3::new(0.2, 0.4, 0.6)) < 1.0e-6));
        assert!(filled.texels.iter().zip(&image.texels).all(|(a, b)| (a.w - b.w).abs() < 1.0e-6));
        let clear = Image::new(UVec2::new(3, 3), Vec3::ONE.extend(0.0));
        assert_eq!(continue_edges(&clear), clear);
    }
}
