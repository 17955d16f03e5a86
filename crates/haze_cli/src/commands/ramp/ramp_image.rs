//! Draws a ramp as an image.

use glam::{UVec2, Vec3};
use haze_core::assets::ramp::Ramp;
use haze_core::formula::color::srgb_from_linear;
use haze_core::formula::texture::Texture2d as _;
use image::{Rgb, RgbImage};

/// Returns the sRGB code, 0 to 1, of the texel nearest to `u` and `v`, both 0 to 1.
pub fn srgb_code_at(ramp: &Ramp, u: f32, v: f32) -> Vec3 {
    let at = |fraction: f32, count: u32| (fraction * (count - 1) as f32).round() as u32;
    let size = ramp.dimensions();
    ramp.texel(UVec2::new(at(u, size.x), at(v, size.y))).map(srgb_from_linear)
}

pub fn fraction(index: u32, count: u32) -> f32 {
    index as f32 / (count - 1).max(1) as f32
}

/// Draws the ramp as an image of this size.
pub fn ramp_image(ramp: &Ramp, size: UVec2) -> RgbImage {
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let color = srgb_code_at(ramp, fraction(x, size.x), fraction(size.y - 1 - y, size.y)) * 255.0;
        Rgb(color.to_array().map(|channel| channel.round() as u8))
    })
}
