//! Ramp lookups. WGSL: `shaders/lib/ramp.wgsl`.

use glam::{UVec2, Vec2, Vec3, Vec4Swizzles};

use super::texture::Texture2d;
use crate::settings::RampFilter;

/// Texel coordinate of a ramp coordinate: 0 and 1 map to the centers of the first and the last texel.
pub fn ramp_texel(size: UVec2, coordinate: Vec2) -> Vec2 {
    coordinate.clamp(Vec2::ZERO, Vec2::ONE) * (size.as_vec2() - 1.0)
}

/// Value of the nearest texel.
pub fn sample_ramp_nearest(ramp: &impl Texture2d, coordinate: Vec2) -> Vec3 {
    ramp.load((ramp_texel(ramp.dimensions(), coordinate) + 0.5).as_uvec2()).xyz()
}

/// Samples a ramp with two axes.
pub fn sample_ramp_2d(ramp: &impl Texture2d, filter: RampFilter, coordinate: Vec2) -> Vec3 {
    if filter == RampFilter::Nearest {
        return sample_ramp_nearest(ramp, coordinate);
    }
    let size = ramp.dimensions();
    let texel = ramp_texel(size, coordinate);
    let base = texel.floor();
    let fraction = texel - base;
    let low = base.as_uvec2();
    let high = (low + 1).min(size - 1);
    let load = |x, y| ramp.load(UVec2::new(x, y));
    let bottom = load(low.x, low.y).lerp(load(high.x, low.y), fraction.x);
    let top = load(low.x, high.y).lerp(load(high.x, high.y), fraction.x);
    bottom.lerp(top, fraction.y).xyz()
}

/// Samples a ramp with one row.
pub fn sample_ramp(ramp: &impl Texture2d, filter: RampFilter, u: f32) -> Vec3 {
    sample_ramp_2d(ramp, filter, Vec2::new(u, 0.0))
}
