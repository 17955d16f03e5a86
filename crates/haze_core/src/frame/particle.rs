//! One sprite of a particle system.

use glam::{Vec3, Vec4};

use super::bounds::Bounds;
use super::sprite_extent::SpriteExtent;

/// Camera-facing sprite, in the layout of the instance buffer: 48 bytes, tightly packed.
///
/// In WGSL: `vec4f` position and radius, `vec4f` rotation, amount, frame and age, `vec3f` velocity, and a `u32` that is
/// `pack4x8unorm(vec4f(tint, heat))`. Its bits may be those of a NaN, so copy it as `u32`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Particle {
    /// Center in world space, metres.
    pub position: Vec3,
    /// Half the side of the square sprite, metres. 0 draws nothing.
    pub radius: f32,
    /// Rotation on the screen, radians, counter-clockwise. Rotates the sprite's normals too.
    pub rotation: f32,
    /// Multiplies the sprite's amount, 0..=1; larger values are clamped. 0 draws nothing.
    pub amount: f32,
    /// Flipbook frame. Wraps around; a fraction blends with the next frame.
    pub frame: f32,
    /// Fraction of the particle's life that has passed, 0..=1.
    pub age: f32,
    /// Velocity in world space, metres per second. Read if `sprite.stretch` is above 0.
    pub velocity: Vec3,
    /// Color by which the light on the sprite is multiplied, linear, 255 for 1. Read if `sprite.tint` is above 0.
    pub tint: [u8; 3],
    /// Multiplies the heat that the heat ramp has for its age, 255 for 1. Read if the system burns.
    pub heat: u8,
}

/// Largest magnitude of a particle's numbers that is drawn: far beyond any scene, and far below the limits of f32.
pub const MAX_MAGNITUDE: f32 = 1.0e9;

impl Default for Particle {
    fn default() -> Self {
        Self {
            position: Vec3::ZERO,
            radius: 1.0,
            rotation: 0.0,
            amount: 1.0,
            frame: 0.0,
            age: 0.0,
            velocity: Vec3::ZERO,
            tint: [255; 3],
            heat: 255,
        }
    }
}

impl Particle {
    /// True if every number is finite, in range and at most [`MAX_MAGNITUDE`]. Sprites that are not valid are skipped.
    pub fn is_valid(&self) -> bool {
        // Comparisons are false for NaN.
        let in_range = |numbers: Vec4| numbers.abs().cmple(Vec4::splat(MAX_MAGNITUDE));
        let position = in_range(self.position.extend(self.radius));
        let look = in_range(Vec4::new(self.rotation, self.amount, self.frame, self.age));
        (position & look & in_range(self.velocity.extend(0.0))).all() && self.radius >= 0.0
    }

    /// True if the particle is valid, and its radius and amount are above 0.
    pub fn is_visible(&self) -> bool {
        self.is_valid() && self.radius > 0.0 && self.amount > 0.0
    }

    /// Amount, clamped to 0..=1.
    pub fn shown_amount(&self) -> f32 {
        self.amount.clamp(0.0, 1.0)
    }
}

/// Box that contains the sprites of all visible particles. `extent` is that of the sprites.
pub fn particle_bounds(particles: &[Particle], extent: SpriteExtent) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for particle in particles.iter().filter(|particle| particle.is_visible()) {
        bounds.include(particle.position, extent.radius(particle.radius, particle.velocity.length()));
    }
    bounds
}
