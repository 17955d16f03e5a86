//! One sprite of a particle system.

use glam::Vec3;

use super::bounds::Bounds;

/// One camera-facing sprite. The layout is that of the instance buffer: 32 bytes, tightly packed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Particle {
    /// Centre in world space, metres.
    pub position: Vec3,
    /// Half the side of the square sprite, metres. Zero draws nothing.
    pub radius: f32,
    /// Rotation on the screen, radians, counter-clockwise. Rotates the sprite's normals too.
    pub rotation: f32,
    /// Multiplies the sprite's amount, 0..=1; what is beyond is clamped. Zero draws nothing.
    pub amount: f32,
    /// Flipbook frame. Wraps round; a fraction blends with the next frame.
    pub frame: f32,
    /// Share of its life that has passed, 0..=1.
    pub age: f32,
}

/// Largest number of a particle that is drawn: far beyond any scene, and far from where f32 runs out.
pub const LARGEST: f32 = 1.0e9;

impl Default for Particle {
    fn default() -> Self {
        Self { position: Vec3::ZERO, radius: 1.0, rotation: 0.0, amount: 1.0, frame: 0.0, age: 0.0 }
    }
}

impl Particle {
    /// True if every number is finite, in range and no more than [`LARGEST`]; a sprite that is not is skipped, never
    /// drawn.
    pub fn is_valid(&self) -> bool {
        let [x, y, z] = self.position.to_array();
        let numbers = [x, y, z, self.rotation, self.amount, self.frame, self.age];
        // Both are false for NaN.
        numbers.iter().all(|number| number.abs() <= LARGEST) && (0.0..=LARGEST).contains(&self.radius)
    }

    /// True if it is valid and there is something of it to see.
    pub fn is_visible(&self) -> bool {
        self.is_valid() && self.radius > 0.0 && self.amount > 0.0
    }

    /// The amount, as far as it counts.
    pub fn shown_amount(&self) -> f32 {
        self.amount.clamp(0.0, 1.0)
    }
}

/// The box that holds the sprites of every visible particle. `reach`: how far a sprite's corners are from its middle, in
/// radii, see [`Settings::reach`](crate::Settings::reach).
pub fn bounds_of(particles: &[Particle], reach: f32) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for particle in particles.iter().filter(|particle| particle.is_visible()) {
        bounds.include(particle.position, particle.radius * reach);
    }
    bounds
}
