//! What the CPU renderer is handed: the same as the GPU's, in memory.

use crate::assets::material::MaterialAssets;
use crate::assets::picture::Picture;
use crate::frame::{Bounds, Light, Particle, View};
use crate::settings::{Settings, ShadeTree};

/// One frame, as [`crate::Frame`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// What a depth buffer written with the view's projection would hold, 0..1.
    pub scene_depth: &'a Picture<f32>,
    /// At most [`MAX_LIGHTS`](crate::frame::MAX_LIGHTS).
    pub lights: &'a [Light],
    /// Drawn far to near.
    pub systems: &'a [System<'a>],
    /// Seconds: the noise of volumetric sprites scrolls with it.
    pub time: f32,
    /// Which stage of the shading is shown.
    pub shade_tree: ShadeTree,
}

/// One particle system, as [`crate::System`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// The sprites, in any order.
    pub particles: &'a [Particle],
    /// A box that holds every sprite; `None` measures them.
    pub bounds: Option<Bounds>,
    /// View depth that the system is lit at; `None` measures the sprites.
    pub depth: Option<f32>,
    /// Everything a slider moves.
    pub settings: &'a Settings,
    /// Ramps and sprite picture.
    pub material: &'a MaterialAssets,
}

impl<'a> System<'a> {
    /// A system that is measured.
    pub const fn new(particles: &'a [Particle], settings: &'a Settings, material: &'a MaterialAssets) -> Self {
        Self { particles, bounds: None, depth: None, settings, material }
    }
}
