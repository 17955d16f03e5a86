//! Smoke and scene between a point of the smoke and the lights. WGSL: `shaders/lib/diffuse.wgsl`.

use glam::Vec3;

/// Smoke and scene between a point of the smoke and the lights with shadow.
#[derive(Clone, Copy, Debug)]
pub struct Shade {
    /// Optical depths of other smoke.
    pub optical_depths: Vec3,
    /// Share of each light that comes past the scene.
    pub visible: Vec3,
}

impl Shade {
    /// Nothing.
    pub const NONE: Self = Self { optical_depths: Vec3::ZERO, visible: Vec3::ONE };
}
