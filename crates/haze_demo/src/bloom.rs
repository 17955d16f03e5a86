//! Light that spreads around bright areas, as a lens spreads it; on the CPU. `bloom_pass.rs` does so on the GPU, WGSL:
//! `bloom.wgsl`. (Pyramid after Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", 2014)

use glam::{IVec2, UVec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;

/// Part of a level that comes from coarser ones: wider glows for more.
const SPREAD: f32 = 0.85;
/// Shorter side of the coarsest level, texels: the glow reaches as far in an image of any size.
const COARSEST: f32 = 8.0;
/// Brightest light that spreads: half floats end not far above.
const BRIGHTEST: f32 = 6.0e4;

/// Levels of the pyramid of an image, without the image itself: finest first, each half as large as the one before. With
/// each goes the part of it that comes from the next; 0 for the last.
pub(crate) fn levels(size: UVec2) -> Vec<(UVec2, f32)> {
    let count = (size.min_element() as f32 / COARSEST).log2().max(1.0);
    let mut levels = Vec::new();
    let mut size = size;
    while (levels.len() as f32) < count {
        size = size.map(|side| side.div_ceil(2));
        // The coarsest comes in gradually as images grow.
        let rest = count - levels.len() as f32 - 1.0;
        levels.push((size, SPREAD * rest.clamp(0.0, 1.0)));
    }
    levels
}

/// Adds bloom to an image. `strength`: fraction of the light that spreads, 0..=1.
pub fn add_bloom(image: &mut Image<Vec4>, strength: f32) {
    if strength <= 0.0 {
        return;
    }
    let mut light = Image::new(image.size, Vec3::ZERO);
    light.for_each(|at, out| *out = image.load(at.as_ivec2()).xyz().clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST)));
    let sizes = levels(image.size);
    let mut levels: Vec<Image<Vec3>> = Vec::new();
    for &(size, _) in &sizes {
        let finer = levels.last().unwrap_or(&light);
        let mut level = Image::new(size, Vec3::ZERO);
        level.for_each(|at, out| *out = halved(finer, at.as_ivec2()));
        levels.push(level);
    }
    let Some(mut coarser) = levels.pop() else { return };
    for (mut level, (_, spread)) in levels.into_iter().zip(sizes).rev() {
        level.for_each(|at, out| *out = out.lerp(doubled(&coarser, at.as_ivec2()), spread));
        coarser = level;
    }
    image.for_each(|at, out| {
        let spread = doubled(&coarser, at.as_ivec2());
        *out = out.xyz().lerp(spread, strength).extend(out.w);
    });
}

/// Texel of a level half the size: sixteen texels around its middle, weighted 1 3 3 1 along both axes.
fn halved(level: &Image<Vec3>, at: IVec2) -> Vec3 {
    let weights = [1.0, 3.0, 3.0, 1.0].map(|weight: f32| weight / 8.0);
    let mut sum = Vec3::ZERO;
    for (y, weight_y) in (0..).zip(weights) {
        for (x, weight_x) in (0..).zip(weights) {
            sum += level.load(2 * at + IVec2::new(x, y) - 1) * (weight_x * weight_y);
        }
    }
    sum
}

/// Texel of a level twice the size: bilinear between the four nearest.
fn doubled(level: &Image<Vec3>, at: IVec2) -> Vec3 {
    let nearest = at / 2;
    let aside = (at & IVec2::ONE) * 2 - 1;
    let row = level.load(nearest) * 3.0 + level.load(nearest + IVec2::new(aside.x, 0));
    let next_row = level.load(nearest + IVec2::new(0, aside.y)) * 3.0 + level.load(nearest + aside);
    (row * 3.0 + next_row) / 16.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bloom_spreads_light_and_loses_none() {
        let size = UVec2::new(128, 96);
        let mut image = Image::new(size, Vec4::W);
        image.for_each(|at, texel| {
            if at == UVec2::new(60, 50) {
                *texel = Vec4::new(900.0, 300.0, 60.0, 1.0);
            }
        });
        let sum = |image: &Image<Vec4>| image.texels.iter().fold(Vec3::ZERO, |sum, texel| sum + texel.xyz());
        let before = sum(&image);
        let mut bloomed = image.clone();
        add_bloom(&mut bloomed, 0.2);
        // Borders repeat a little of the light.
        assert!((sum(&bloomed) / before - 1.0).abs().max_element() < 0.01, "{}", sum(&bloomed) / before);
        // Falls off with the distance, and keeps the hue.
        let along: Vec<_> = [0, 3, 8, 20, 30].map(|x| bloomed.load(IVec2::new(60 + x, 50))).to_vec();
        assert!(along.windows(2).all(|pair| pair[0].x > pair[1].x), "{along:?}");
        assert!(along.iter().all(|texel| (texel.x / texel.y - 3.0).abs() < 0.01 && texel.w > 0.999), "{along:?}");
        assert!((bloomed.load(IVec2::new(60, 50)).x / 720.0 - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_glow_reaches_as_far_in_an_image_of_any_size() {
        // A bright square of a tenth of the height; light at a quarter of the height beside it.
        let beside = |side: u32| {
            let size = UVec2::splat(side);
            let mut image = Image::new(size, Vec4::W);
            let middle = size.as_vec2() * 0.5;
            image.for_each(|at, texel| {
                if (at.as_vec2() + 0.5 - middle).abs().max_element() < 0.05 * side as f32 {
                    *texel = Vec4::splat(10.0);
                }
            });
            add_bloom(&mut image, 0.5);
            image.load((middle + glam::Vec2::new(0.25 * side as f32, 0.0)).as_ivec2()).x
        };
        let lights = [120, 160, 200, 240, 400].map(beside);
        let mean = lights.iter().sum::<f32>() / lights.len() as f32;
        // The coarsest level comes in as images grow, in steps of its texels.
        assert!(lights.iter().all(|light| (light / mean - 1.0).abs() < 0.25), "{lights:?}");
    }

    #[test]
    fn without_strength_nothing_changes() {
        let mut image = Image::new(UVec2::new(5, 3), Vec4::splat(f32::INFINITY));
        add_bloom(&mut image, 0.0);
        assert!(image.texels.iter().all(|texel| texel.x > f32::MAX));
    }
}
