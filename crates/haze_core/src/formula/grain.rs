//! Grain: noise that is finer than the texels of a sprite. WGSL: `shaders/lib/grain.wgsl`.

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use super::noise_volume::sample_noise_volume;
use super::saturate;
use super::texture::Texture3d;

/// Axes of the plane through the noise that a sprite shows.
const GRAIN_RIGHT: Vec3 = Vec3::new(0.80409, -0.52483, -0.27926);
const GRAIN_DOWN: Vec3 = Vec3::new(0.14178, 0.62548, -0.76725);

/// Density that half of the noise is above.
const MIDDLE_DENSITY: f32 = 0.5;

/// Fraction of an octave that a target can show. `fineness`: texels of the noise per texel of the target.
pub fn octave_fraction(fineness: f32) -> f32 {
    saturate(1.5 / fineness.max(1.0e-6) - 0.5)
}

/// Noise at a position on a sprite: the tilt of the normal (xy, y up), and the density above the middle (z). `phase`: share
/// of the flipbook's loop that has passed. `tiles`: of the noise, across the sprite. `fineness`: of the first octave, as
/// above.
pub fn sample_grain(noise: &impl Texture3d, uv: Vec2, phase: f32, tiles: f32, fineness: f32, octaves: u32) -> Vec3 {
    let mut sum = Vec4::ZERO;
    let mut total = 0.0;
    let mut position = (GRAIN_RIGHT * uv.x + GRAIN_DOWN * uv.y) * tiles + phase;
    let mut weight = 1.0;
    let mut fine = fineness;
    for _ in 0..octaves {
        let fraction = weight * octave_fraction(fine);
        sum += sample_noise_volume(noise, position) * fraction;
        total += fraction;
        position *= 3.0;
        fine *= 3.0;
        weight *= 0.5;
    }
    // The texels' offset of 1/2 along all axes is perpendicular to the plane.
    let gradient = 2.0 * sum.xyz();
    Vec3::new(gradient.dot(GRAIN_RIGHT), -gradient.dot(GRAIN_DOWN), sum.w - MIDDLE_DENSITY * total)
}

/// Erosion of a sprite at an age.
pub fn sprite_erosion(erosion: f32, dissolve: f32, age: f32) -> f32 {
    saturate(erosion + dissolve * saturate(age))
}

/// Amount of a sprite's image after erosion: the higher it is, the more noise it withstands. `density`: of
/// [`sample_grain`].
pub fn eroded(amount: f32, density: f32, erosion: f32) -> f32 {
    let threshold = erosion * saturate(MIDDLE_DENSITY - density);
    saturate((amount - threshold) / (1.0 - threshold).max(0.01))
}

/// Fraction of a sprite's density that erosion keeps. `eroded_fraction`: the same at an erosion of 1.
pub fn kept_fraction(eroded_fraction: f32, erosion: f32) -> f32 {
    1.0 - (1.0 - eroded_fraction) * erosion
}

/// Normal with a tilt, at most of unit length.
pub fn tilted_normal(normal: Vec3, tilt: Vec2) -> Vec3 {
    let turned = normal + tilt.extend(0.0);
    turned / turned.length_squared().max(1.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_is_across_its_motion() {
        for axis in [GRAIN_RIGHT, GRAIN_DOWN] {
            assert!((axis.length() - 1.0).abs() < 1e-4 && axis.element_sum().abs() < 1e-4, "{axis}");
        }
        assert!(GRAIN_RIGHT.dot(GRAIN_DOWN).abs() < 1e-4);
    }

    #[test]
    fn thick_smoke_withstands_erosion() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} and {b}");
        for amount in [0.0, 0.5, 1.0] {
            near(eroded(amount, 0.3, 0.0), amount);
        }
        near(eroded(0.3, -0.4, 0.5), 0.0);
        near(eroded(1.0, -0.4, 0.5), 1.0);
        assert!(eroded(1.0, -1.0, 1.0) <= 1.0);
    }
}
