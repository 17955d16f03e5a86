//! Smoke and scene between a point of the smoke and the light that falls on it. WGSL: `shaders/lib/diffuse.wgsl`.

use glam::{Vec2, Vec3};
use haze_core::formula::shadow::LIGHT_BLOCKS;

/// Smoke and scene between a point of the smoke and the light that falls on it.
#[derive(Clone, Copy, Debug)]
pub struct Shade {
    /// Optical depths of other smoke towards the lights with shadow.
    pub optical_depths: [Vec3; LIGHT_BLOCKS],
    /// Fraction of each of these lights that comes past the scene.
    pub visible: [Vec3; LIGHT_BLOCKS],
    /// Openness to sky and ground.
    pub openness: Vec2,
}

impl Shade {
    /// Nothing.
    pub const NONE: Self =
        Self { optical_depths: [Vec3::ZERO; LIGHT_BLOCKS], visible: [Vec3::ONE; LIGHT_BLOCKS], openness: Vec2::ONE };

    /// Other smoke in front of sprites. `optical_depths`: towards the lights of the first block.
    pub fn of_sprites(optical_depths: Vec3) -> Self {
        let mut shade = Self::NONE;
        shade.optical_depths[0] = optical_depths;
        shade
    }
}
