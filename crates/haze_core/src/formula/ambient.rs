//! Light from the hemispheres above and below. WGSL: `shaders/lib/ambient.wgsl`.

use glam::{Vec2, Vec3};

use super::saturate;

/// Number of directions in which openness to a hemisphere is measured.
pub const SKY_DIRECTIONS: usize = 4;

/// Number of steps of a march to the sky.
pub const SKY_STEPS: u32 = 16;

/// Lookup coordinate of the diffuse ramp under even light from a hemisphere around `axis`. A ramp that is Lambert's cosine
/// then gives (1 + cos) ÷ 2, which is exact.
pub fn hemisphere_coordinate(normal: Vec3, axis: Vec3) -> f32 {
    saturate(0.75 + 0.25 * normal.dot(axis))
}

/// Response of six-way maps to even light from a hemisphere around `axis`: the light of the side at its pole, and half of
/// that of each side at its rim.
pub fn six_way_hemisphere(positive: Vec3, negative: Vec3, axis: Vec3) -> f32 {
    0.5 * ((positive + negative).dot(Vec3::ONE) + axis.dot(positive - negative))
}

/// Light of the hemispheres above and below that is closest to that of an environment, of which a white matte surface with
/// the normal n shows `mean` + `slope`·cos(n, up), and more that varies faster over n: the mean-square error over all
/// normals is least. Light from one side is shared by both.
pub fn hemisphere_light(mean: Vec3, slope: Vec3) -> [Vec3; 2] {
    [(mean + slope).max(Vec3::ZERO), (mean - slope).max(Vec3::ZERO)]
}

/// Lookup position in the shadow ramp for light from a hemisphere: as from the side. `openness`: mean of 2^(-optical depth).
pub fn openness_position(openness: f32) -> Vec2 {
    Vec2::new(saturate(1.0 - openness), 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_light_from_all_around_is_the_same_on_every_normal() {
        let lambert = |coordinate: f32| (2.0 * coordinate - 1.0).max(0.0);
        for step in 0..16 {
            let (sin, cos) = (step as f32 * 0.4).sin_cos();
            let normal = Vec3::new(sin, cos, 0.0);
            let [above, below] = [Vec3::Y, Vec3::NEG_Y].map(|axis| lambert(hemisphere_coordinate(normal, axis)));
            assert!((above + below - 1.0).abs() < 1e-6, "{normal}");
            // Six-way maps of a Lambert surface with this normal.
            let positive = normal.max(Vec3::ZERO);
            let negative = (-normal).max(Vec3::ZERO);
            let axis = Vec3::Y;
            let sum = six_way_hemisphere(positive, negative, axis) + six_way_hemisphere(positive, negative, -axis);
            assert!((sum - (positive + negative).element_sum()).abs() < 1e-6);
        }
    }
}
