//! Henyey-Greenstein phase function and its sampling. (Henyey and Greenstein, 1941)

use std::f32::consts::PI;

use glam::Vec3;
use haze_core::formula::six_way::henyey_greenstein;

use super::random::Random;

/// Returns the phase function for the cosine of a scattering angle, per steradian.
pub(super) fn phase_function(cos: f32, g: f32) -> f32 {
    henyey_greenstein(cos, g) * (1.0 - g * g) / (4.0 * PI)
}

/// Samples a scattered direction for light that travels along `direction`, with the phase function's probability.
pub(super) fn sample_scattered_direction(direction: Vec3, g: f32, random: &mut Random) -> Vec3 {
    let fraction = random.unit();
    let cos = if g.abs() < 1.0e-3 {
        1.0 - 2.0 * fraction
    } else {
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * fraction);
        ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    let (x, y) = direction.any_orthonormal_pair();
    let around = random.on_circle() * (1.0 - cos * cos).max(0.0).sqrt();
    (direction * cos + x * around.x + y * around.y).normalize()
}
