//! What the CPU renderer is handed: the same as the GPU's, in memory.

use glam::Vec3;

use haze::assets::material::MaterialAssets;
use haze::assets::picture::Picture;
use haze::frame::{Bounds, Light, Particle, View};
use haze::settings::{Settings, ShadeTree};

/// One frame, as [`haze::Frame`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// What a depth buffer written with the view's projection would hold, 0..1.
    pub scene_depth: &'a Picture<f32>,
    /// At most [`MAX_LIGHTS`](haze::frame::MAX_LIGHTS).
    pub lights: &'a [Light],
    /// Drawn far to near.
    pub systems: &'a [System<'a>],
    /// Seconds: the noise of volumetric sprites rises with it.
    pub time: f32,
    /// The way up in the world; need not be unit length.
    pub up: Vec3,
    /// Which stage of the shading is shown.
    pub shade_tree: ShadeTree,
}

impl<'a> Frame<'a> {
    /// A frame without lights and smoke; y is up.
    pub const fn new(view: View, scene_depth: &'a Picture<f32>) -> Self {
        Self { view, scene_depth, lights: &[], systems: &[], time: 0.0, up: Vec3::Y, shade_tree: ShadeTree::Final }
    }
}

/// One particle system, as [`haze::System`], in memory.
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
