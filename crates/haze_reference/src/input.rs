//! Input of the CPU renderer: the same as that of the GPU renderer, in memory.

use glam::{Mat4, Vec3};

use haze_core::assets::image::Image;
use haze_core::assets::material_assets::MaterialAssets;
use haze_core::frame::{Bounds, Light, Particle, ShadowProjection, View};
use haze_core::settings::{DebugView, Settings};

/// One frame, like `haze::FrameInput`, in memory.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    /// The camera.
    pub view: View,
    /// Values of a depth buffer written with the view's projection, 0..1.
    pub scene_depth: &'a Image<f32>,
    /// At most [`MAX_LIGHTS`](haze_core::frame::MAX_LIGHTS) lights.
    pub lights: &'a [Light],
    /// Shadow maps of lights, at most one per light.
    pub shadow_maps: &'a [ShadowMap<'a>],
    /// As `haze::FrameInput::scene_ambient`, for [`PreparedFrame::shade_scene`](super::PreparedFrame::shade_scene).
    pub scene_ambient: Option<Vec3>,
    /// Particle systems, drawn far to near.
    pub systems: &'a [ParticleSystem<'a>],
    /// Multiplies all light that the smoke sends to the viewer.
    pub exposure: f32,
    /// Seconds. The noise of volumetric sprites rises with time.
    pub time: f64,
    /// Up direction of the world; need not be unit length.
    pub up: Vec3,
    /// Debug view to show.
    pub debug_view: DebugView,
}

impl<'a> FrameInput<'a> {
    /// Frame without lights and systems; y is up.
    pub const fn new(view: View, scene_depth: &'a Image<f32>) -> Self {
        let debug_view = DebugView::Final;
        Self {
            view,
            scene_depth,
            lights: &[],
            shadow_maps: &[],
            scene_ambient: None,
            systems: &[],
            exposure: 1.0,
            time: 0.0,
            up: Vec3::Y,
            debug_view,
        }
    }
}

/// Shadow map of a light, like `haze::ShadowMap`, in memory.
#[derive(Clone, Copy, Debug)]
pub struct ShadowMap<'a> {
    /// Depth of each layer.
    pub layers: &'a [Image<f32>],
    /// Projection of the map.
    pub projection: ShadowProjection<'a>,
}

/// One particle system, like `haze::ParticleSystem`, in memory.
#[derive(Clone, Copy, Debug)]
pub struct ParticleSystem<'a> {
    /// The sprites, in any order.
    pub particles: &'a [Particle],
    /// Places the particles in the world: rotation, translation and a uniform scale.
    pub world_from_particles: Mat4,
    /// Box in the particles' space that contains every sprite; `None` measures it.
    pub bounds: Option<Bounds>,
    /// View depth at which the system is lit; `None` measures it.
    pub depth: Option<f32>,
    /// Settings of the system.
    pub settings: &'a Settings,
    /// Ramps and sprite images.
    pub material: &'a MaterialAssets,
}

impl<'a> ParticleSystem<'a> {
    /// System with measured box and depth.
    pub const fn new(particles: &'a [Particle], settings: &'a Settings, material: &'a MaterialAssets) -> Self {
        Self { particles, world_from_particles: Mat4::IDENTITY, bounds: None, depth: None, settings, material }
    }
}
