//! One frame.

use glam::Vec3;

use super::bounds::Bounds;
use super::emission::Emission;
use super::light::Light;
use super::material::Material;
use super::particle::Particle;
use super::view::View;
use crate::settings::{Order, Settings, ShadeTree};

/// Everything that [`Renderer::prepare`](crate::Renderer::prepare) needs to know about a frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// The opaque scene's depth, already rendered in this encoder or an earlier one.
    pub scene_depth: SceneDepth<'a>,
    /// At most [`MAX_LIGHTS`](crate::frame::MAX_LIGHTS).
    pub lights: &'a [Light],
    /// Drawn far to near, whatever their order here.
    pub systems: &'a [System<'a>],
    /// Seconds, from any start: the noise of volumetric sprites rises with it.
    pub time: f32,
    /// The way up in the world, along which noise rises; need not be unit length.
    pub up: Vec3,
    /// Which stages of the shading may be shown of this frame; [`ShadeTree::Final`] for a picture. One accumulation serves all
    /// of them but [`ShadeTree::Overdraw`], which takes a pass of its own.
    pub stages: &'a [ShadeTree],
}

impl<'a> Frame<'a> {
    /// A frame without lights and smoke; y is up.
    pub const fn new(view: View, scene_depth: SceneDepth<'a>) -> Self {
        let stages = &[ShadeTree::Final];
        Self { view, scene_depth, lights: &[], systems: &[], time: 0.0, up: Vec3::Y, stages }
    }
}

/// The opaque scene's depth at full resolution, single-sampled, with `TEXTURE_BINDING` usage, as large as the host's colour
/// target. Which of the two is read, and which tested, when, is a table in `docs/depth.md`.
#[derive(Clone, Copy, Debug)]
pub enum SceneDepth<'a> {
    /// A depth buffer written with the view's projection: a 2D view of its depth aspect.
    Buffer(&'a wgpu::TextureView),
    /// An `R32Float` target with linear view depth in metres; no surface: anything from 1e6 up.
    Linear(&'a wgpu::TextureView),
    /// Both of the same scene. The buffer is read, but by systems of the technique
    /// [`SoftLinear`](crate::settings::Technique::SoftLinear), and where the backend (OpenGL) cannot read the buffer that
    /// is attached to the pass.
    Both {
        /// As in [`SceneDepth::Buffer`].
        buffer: &'a wgpu::TextureView,
        /// As in [`SceneDepth::Linear`].
        linear: &'a wgpu::TextureView,
    },
}

impl<'a> SceneDepth<'a> {
    /// The depth buffer, if there is one.
    pub fn buffer(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Buffer(view) | Self::Both { buffer: view, .. } => Some(view),
            Self::Linear(_) => None,
        }
    }

    /// The linear target, if there is one.
    pub fn linear(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Linear(view) | Self::Both { linear: view, .. } => Some(view),
            Self::Buffer(_) => None,
        }
    }
}

/// One particle system: sprites that are accumulated together and lit as one body.
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// A number of its own, by which the renderer knows the system again in the next frame, whatever its place in the list.
    pub key: u64,
    /// The sprites, in any order.
    pub particles: Particles<'a>,
    /// A box in world space that holds every sprite, corners and all: [`Settings::reach`] radii round each. It decides which
    /// pixels are lit, which lights reach the smoke, and whether it is in sight; what is outside may be cut off, and what is
    /// larger than it need be only costs. `None` measures the slice with [`bounds_of`](crate::frame::bounds_of).
    pub bounds: Option<Bounds>,
    /// View depth, metres, of the plane that light is flattened to, and by which systems are drawn far to near. It should move
    /// without jumps: the mean depth of the sprites, by amount and area, is best, and is what `None` takes of a slice. For a
    /// buffer, `None` takes the middle of the part of `bounds` that is in front of the viewer, which jumps when `bounds` does.
    pub depth: Option<f32>,
    /// Everything a slider moves.
    pub settings: &'a Settings,
    /// Ramps and sprite picture.
    pub material: &'a Material,
}

impl<'a> System<'a> {
    /// A system whose box is measured. With more than one in a frame, give each a `key`.
    pub const fn new(particles: Particles<'a>, settings: &'a Settings, material: &'a Material) -> Self {
        Self { key: 0, particles, bounds: None, depth: None, settings, material }
    }
}

/// Where the sprites are.
#[derive(Clone, Copy, Debug)]
pub enum Particles<'a> {
    /// In memory. Sorted and uploaded by [`Renderer::prepare`](crate::Renderer::prepare). A sprite with a number that
    /// is not finite, or out of its range, is skipped.
    Slice(&'a [Particle]),
    /// On the GPU, in the layout of [`Particle`], with `VERTEX` usage. `System::bounds` must be given.
    Buffer {
        /// Holds `count` particles from `offset` on.
        buffer: &'a wgpu::Buffer,
        /// Bytes before the first particle, a multiple of 4; of 16 where compute shaders read them, by `path` or `is_sorted`.
        offset: u64,
        /// How many to draw.
        count: u32,
        /// They lie back to front. Where they do not, and their order matters, the GPU sorts them, at one depth by number: that
        /// takes compute shaders, and `STORAGE` usage.
        is_sorted: bool,
    },
    /// Those of an emitter at a time. The path `tiled` evaluates them on the GPU, where they differ from those of
    /// [`Emission::evaluate`] by what sines, roots and powers of the device are rounded: some micrometres for each metre and second.
    /// Other paths evaluate them on the CPU. The box is [`Emission::bounds`] where `None` is given, and a thousand
    /// of them stand for all where their mean depth counts.
    Emission(&'a Emission),
}

impl Particles<'_> {
    /// How many there are, those aside that cannot be seen.
    pub fn count(&self) -> u32 {
        match *self {
            Self::Slice(particles) => particles.len() as u32,
            Self::Buffer { count, .. } => count,
            Self::Emission(emission) => emission.count(),
        }
    }

    /// True for a buffer whose order matters, and is not right.
    pub fn need_sorting(&self, settings: &Settings) -> bool {
        matches!(self, Self::Buffer { is_sorted: false, .. }) && settings.order() == Order::Sorted
    }
}
