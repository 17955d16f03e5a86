//! Sprites that are stretched along their motion, as a camera with an open shutter sees them. WGSL: `shaders/lib/stretch.wgsl`.
//!
//! A stretch is a vector q along the motion on the screen. It stands for the matrix (I - q qᵀ)⁻¹, which scales by 1 / (1 - |q|²)
//! along q and leaves the other axis as it is. Its inverse I - q qᵀ takes positions back to the sprite, and normals forward.

use glam::{Vec2, Vec3, Vec3Swizzles};

/// Length of a stretched sprite, in lengths of the sprite at rest. `length`: of its path, metres.
pub fn stretch_ratio(length: f32, radius: f32, limit: f32) -> f32 {
    (1.0 + 0.5 * length / radius.max(1.0e-6)).min(limit)
}

/// Velocity across the line of sight at a particle's depth. `center` and `velocity`: view space.
pub fn velocity_on_screen(center: Vec3, velocity: Vec3, orthographic: f32) -> Vec2 {
    let approach = velocity.z * (1.0 - orthographic) / (-center.z).max(1.0e-3);
    velocity.xy() + center.xy() * approach
}

/// Stretch of a sprite. `seconds`: time for which the shutter is open.
pub fn sprite_stretch(center: Vec3, velocity: Vec3, seconds: f32, radius: f32, limit: f32, orthographic: f32) -> Vec2 {
    let across = velocity_on_screen(center, velocity, orthographic);
    let speed = across.length();
    // Beside the viewer, a particle that comes closer passes faster than it moves.
    let ratio = stretch_ratio(speed.min(velocity.length()) * seconds, radius, limit);
    across * ((1.0 - 1.0 / ratio).max(0.0).sqrt() / speed.max(1.0e-6))
}

/// Least radius of a stretched sprite, texels of the target. Thinner ones would flicker from texel to texel.
pub const MIN_RADIUS: f32 = 0.75;

/// Fraction of its amount that a sprite keeps if its radius grows from `radius` to `wide`, so that it hides as much as before.
/// `thin` and `stretch`: its stretch with either radius.
pub fn widened_fraction(radius: f32, wide: f32, thin: Vec2, stretch: Vec2) -> f32 {
    let ratio = radius / wide.max(1.0e-9);
    (ratio * ratio * (1.0 - stretch.dot(stretch)) / (1.0 - thin.dot(thin)).max(1.0e-4)).min(1.0)
}

/// Position on a sprite at rest to its position on the stretched one, relative to the center.
pub fn stretched(position: Vec2, stretch: Vec2) -> Vec2 {
    position + stretch * (stretch.dot(position) / (1.0 - stretch.dot(stretch)).max(1.0e-4))
}

/// Inverse of [`stretched`].
pub fn unstretched(position: Vec2, stretch: Vec2) -> Vec2 {
    position - stretch * stretch.dot(position)
}

/// Normal on a stretched sprite, of the same length.
pub fn stretched_normal(normal: Vec3, stretch: Vec2) -> Vec3 {
    let turned = unstretched(normal.xy(), stretch).extend(normal.z);
    turned * (normal.dot(normal) / turned.dot(turned).max(1.0e-8)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sprite_grows_by_its_path_up_to_the_limit() {
        let center = Vec3::new(0.0, 0.0, -5.0);
        for (speed, expected) in [(0.0, 1.0), (2.0, 2.0), (6.0, 4.0), (1.0e6, 4.0)] {
            let stretch = sprite_stretch(center, Vec3::new(speed, 0.0, 0.0), 0.5, 0.5, 4.0, 0.0);
            let tip = stretched(Vec2::new(1.0, 1.0), stretch);
            assert!((tip - Vec2::new(expected, 1.0)).abs().max_element() < 1e-4, "{tip}");
            assert!((unstretched(tip, stretch) - Vec2::ONE).abs().max_element() < 1e-4);
        }
    }

    #[test]
    fn a_wider_sprite_hides_as_much_as_before() {
        let center = Vec3::new(0.0, 0.0, -5.0);
        let of = |radius| sprite_stretch(center, Vec3::X * 3.0, 0.1, radius, 100.0, 0.0);
        let area = |radius: f32| radius * radius / (1.0 - of(radius).length_squared());
        let radius = 0.01;
        let wide = 0.05;
        let kept = widened_fraction(radius, wide, of(radius), of(wide));
        assert!((area(wide) * kept - area(radius)).abs() < 1.0e-3 * area(radius));
        assert!((widened_fraction(wide, wide, of(wide), of(wide)) - 1.0).abs() < 1.0e-6);
    }

    #[test]
    fn motion_towards_the_viewer_does_not_stretch_the_middle_of_the_view() {
        let towards = |x| sprite_stretch(Vec3::new(x, 0.0, -5.0), Vec3::Z * 9.0, 0.1, 0.3, 8.0, 0.0);
        assert_eq!(towards(0.0), Vec2::ZERO);
        assert!(towards(2.0).x > 0.3);
        assert_eq!(sprite_stretch(Vec3::new(2.0, 0.0, -5.0), Vec3::Z * 9.0, 0.1, 0.3, 8.0, 1.0), Vec2::ZERO);
    }

    #[test]
    fn normals_turn_away_from_the_stretch() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let turned = stretched_normal(normal, Vec2::new(0.8, 0.0));
        assert!(turned.x < 0.35 && (turned.length() - 1.0).abs() < 1e-5, "{turned}");
    }
}
