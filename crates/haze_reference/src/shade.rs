//! Smoke and scene between a point of the smoke and the light that falls on it. WGSL: `shaders/lib/diffuse.wgsl`.

use glam::{Vec2, Vec3};

/// Smoke and scene between a point of the smoke and the light that falls on it.
#[derive(Clone, Copy, Debug)]
pub struct Shade {
    /// Optical depths of other smoke towards the lights with shadow.
    pub optical_depths: Vec3,
    /// Share of each of these lights that comes past the scene.
    pub visible: Vec3,
    /// Openness to sky and ground.
    pub openness: Vec2,
}

impl Shade {
    /// Nothing.
    pub const NONE: Self = Self { optical_depths: Vec3::ZERO, visible: Vec3::ONE, openness: Vec2::ONE };
}
