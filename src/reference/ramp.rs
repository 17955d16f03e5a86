//! Ramp lookups. `shaders/lib/ramp.wgsl`.

use glam::{UVec2, Vec2, Vec3};

use crate::ramp::Ramp;

/// Bilinear; the first and last texel centres stand for 0 and 1.
pub fn sample_ramp_2d(ramp: &Ramp, coordinate: Vec2) -> Vec3 {
    let size = ramp.size();
    let texel = coordinate.clamp(Vec2::ZERO, Vec2::ONE) * (size.as_vec2() - 1.0);
    let base = texel.floor();
    let fraction = texel - base;
    let low = base.as_uvec2();
    let high = (low + 1).min(size - 1);
    let bottom = ramp.texel(low).lerp(ramp.texel(UVec2::new(high.x, low.y)), fraction.x);
    let top = ramp.texel(UVec2::new(low.x, high.y)).lerp(ramp.texel(high), fraction.x);
    bottom.lerp(top, fraction.y)
}

/// A ramp of one row.
pub fn sample_ramp(ramp: &Ramp, u: f32) -> Vec3 {
    sample_ramp_2d(ramp, Vec2::new(u, 0.0))
}
