//! Fills what is clear in a frame with what is next to it.
//!
//! Textures are filtered before they are multiplied by alpha. Without this, the black of clear texels would darken the
//! outline of smoke, and motion vectors would end at it.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;

/// Opacity from which a texel keeps its own value: the least that 8 bits hold.
const OPAQUE: f32 = 0.5 / 255.0;

/// Divides a layer by its opacity, and fills clear texels by smooth continuation. Alpha stays. (Burt, "Moment images,
/// polynomial fit filters and the problem of surface interpolation", 1988: pull-push)
pub fn filled(layer: &Image<Vec4>) -> Image<Vec4> {
    let mut levels = vec![layer.clone()];
    while let Some(last) = levels.last().filter(|last| last.size.max_element() > 1) {
        levels.push(halved(last));
    }
    let mut coarse = Image::new(UVec2::ONE, Vec3::ZERO);
    for level in levels.iter().rev() {
        let mut fine = Image::new(level.size, Vec3::ZERO);
        fine.for_each(|at, value| {
            let texel = level.load(at.as_ivec2());
            let kept = (texel.w / OPAQUE).min(1.0);
            *value = between(&coarse, at).lerp(texel.xyz() / texel.w.max(1.0e-9), kept);
        });
        coarse = fine;
    }
    let texels = coarse.texels.iter().zip(&layer.texels).map(|(value, texel)| value.extend(texel.w));
    Image { size: layer.size, texels: texels.collect() }
}

/// Sums of two by two texels.
fn halved(image: &Image<Vec4>) -> Image<Vec4> {
    let mut half = Image::new(image.size.map(|side| side.div_ceil(2)), Vec4::ZERO);
    half.for_each(|at, sum| {
        for offset in [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE] {
            let fine = at * 2 + offset;
            if fine.cmplt(image.size).all() {
                *sum += image.load(fine.as_ivec2());
            }
        }
    });
    half
}

/// Value of a coarser level at a texel of the next finer one, bilinear.
fn between(coarse: &Image<Vec3>, at: UVec2) -> Vec3 {
    let position = (at.as_vec2() - 0.5) * 0.5;
    let low = position.floor();
    let fraction = position - position.floor();
    let load = |x: f32, y: f32| {
        let last = coarse.size.as_ivec2() - 1;
        coarse.load(glam::Vec2::new(x, y).as_ivec2().clamp(glam::IVec2::ZERO, last))
    };
    let row = |y: f32| load(low.x, y).lerp(load(low.x + 1.0, y), fraction.x);
    row(low.y).lerp(row(low.y + 1.0), fraction.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoke_keeps_its_color_and_clear_texels_get_that_beside_them() {
        let mut layer = Image::new(UVec2::new(13, 9), Vec4::ZERO);
        let red = Vec3::new(0.8, 0.1, 0.0);
        let blue = Vec3::new(0.0, 0.2, 0.9);
        layer.for_each(|at, texel| {
            let (color, alpha) = match at.x {
                0..3 => (red, 0.5),
                10.. => (blue, 0.01),
                _ => (red, 0.0),
            };
            *texel = (color * alpha).extend(alpha);
        });
        let filled = filled(&layer);
        let at = |x: i32| filled.load(glam::IVec2::new(x, 4));
        assert!((at(1).xyz() - red).length() < 1.0e-5 && (at(11).xyz() - blue).length() < 1.0e-5);
        assert_eq!([1, 5].map(|x| at(x).w.to_bits()), [0.5_f32, 0.0].map(f32::to_bits));
        assert!((at(3).xyz() - red).length() < 0.4, "{}", at(3));
        assert!((at(9).xyz() - blue).length() < (at(9).xyz() - red).length(), "{}", at(9));
    }
}
