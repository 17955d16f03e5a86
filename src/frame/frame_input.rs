//! Input of one frame.

use haze_core::glam::{Mat4, UVec2, Vec3};
use haze_core::settings::{BlendOrder, DebugView, Settings};

use haze_core::frame::{Bounds, EmitterSnapshot, Light, Particle, View};

use super::material::Material;
use super::shadow_map::ShadowMap;

/// Input of [`Renderer::prepare`](crate::Renderer::prepare) for one frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    /// The camera.
    pub view: View,
    /// Depth of the opaque scene, already rendered in this encoder or an earlier one.
    pub scene_depth: SceneDepth<'a>,
    /// Size of the host's targets, pixels, if the views of the scene depth show another mip level than the first: wgpu
    /// does not tell the level of a view. `None` for the size of the depth texture.
    pub target_size: Option<UVec2>,
    /// At most [`MAX_LIGHTS`](crate::MAX_LIGHTS) lights.
    pub lights: &'a [Light],
    /// Shadow maps of lights, at most one per light. They shade the smoke of systems with
    /// [`shadow.by_depth`](crate::settings::Shadow::by_depth), for the lights that cast shadow.
    pub shadow_maps: &'a [ShadowMap<'a>],
    /// Prepares [`Renderer::render_scene_shadow`](crate::Renderer::render_scene_shadow): the light that reaches every surface
    /// of the scene, such as that of the sky, as a white matte surface shows it, in the units of the lights. `None`
    /// prepares nothing.
    pub scene_ambient: Option<Vec3>,
    /// Particle systems, in any order. They are drawn by
    /// [`sort_priority`](crate::Settings::sort_priority), then far to near.
    pub systems: &'a [ParticleSystem<'a, 'a>],
    /// Multiplies all light that the smoke sends to the viewer, for hosts whose target holds exposed light. 1 leaves it
    /// in the units of the lights. From 0 on.
    pub exposure: f32,
    /// Seconds from any start. The noise of volumetric sprites rises with time.
    pub time: f64,
    /// Up direction of the world, along which the noise rises; need not be unit length.
    pub up: Vec3,
    /// Debug views that may be shown of this frame; [`DebugView::Final`] for a normal image. All views share one
    /// accumulation, except [`DebugView::Overdraw`], which needs a pass of its own.
    pub debug_views: &'a [DebugView],
}

impl<'a> FrameInput<'a> {
    /// Frame without lights and systems; y is up.
    pub const fn new(view: View, scene_depth: SceneDepth<'a>) -> Self {
        let debug_views = &[DebugView::Final];
        Self {
            view,
            scene_depth,
            target_size: None,
            lights: &[],
            shadow_maps: &[],
            scene_ambient: None,
            systems: &[],
            exposure: 1.0,
            time: 0.0,
            up: Vec3::Y,
            debug_views,
        }
    }
}

/// Depth of the opaque scene at full resolution, with `TEXTURE_BINDING` usage, as large as the host's color target.
/// Single-sampled, but for [`SceneDepth::Multisampled`]. `docs/depth.md` has a table of which depth is read and which is
/// tested.
#[derive(Clone, Copy, Debug)]
pub enum SceneDepth<'a> {
    /// Depth buffer written with the view's projection: a 2D view of its depth aspect.
    Buffer(&'a wgpu::TextureView),
    /// Multisampled depth buffer: a 2D view of its depth aspect. haze resolves it to the farthest sample of each pixel,
    /// in a pass of its own (`depth_resolve`), and reads the result. Not on OpenGL.
    Multisampled(&'a wgpu::TextureView),
    /// `R32Float` target with linear view depth in metres. Values from 1e6 up mean that there is no surface.
    Linear(&'a wgpu::TextureView),
    /// Both, of the same scene. The buffer is read, with two exceptions: systems of the technique
    /// [`SoftLinear`](crate::settings::Technique::SoftLinear), and backends (OpenGL) that cannot read a buffer that is
    /// attached to the pass.
    BufferAndLinear {
        /// As in [`SceneDepth::Buffer`].
        buffer: &'a wgpu::TextureView,
        /// As in [`SceneDepth::Linear`].
        linear: &'a wgpu::TextureView,
    },
}

impl<'a> SceneDepth<'a> {
    /// The texture that is read.
    pub(crate) fn texture(&self) -> &'a wgpu::Texture {
        let (Self::Buffer(view)
        | Self::Multisampled(view)
        | Self::Linear(view)
        | Self::BufferAndLinear { buffer: view, .. }) = self;
        view.texture()
    }

    /// The single-sampled depth buffer, if there is one.
    pub fn buffer(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Buffer(view) | Self::BufferAndLinear { buffer: view, .. } => Some(view),
            Self::Linear(_) | Self::Multisampled(_) => None,
        }
    }

    /// The linear target, if there is one.
    pub fn linear(&self) -> Option<&'a wgpu::TextureView> {
        match self {
            Self::Linear(view) | Self::BufferAndLinear { linear: view, .. } => Some(view),
            Self::Buffer(_) | Self::Multisampled(_) => None,
        }
    }
}

/// One particle system: sprites that are accumulated together and lit as one body. `'p`: of the particles, which a host may
/// make anew in every frame; `'a`: of settings and material.
#[derive(Clone, Copy, Debug)]
pub struct ParticleSystem<'p, 'a> {
    /// Identifies the system from frame to frame, whatever its position in the list. Must be unique within a frame.
    pub key: u64,
    /// The sprites, in any order.
    pub particles: Particles<'p>,
    /// Places the particles in the world: rotation, translation and a uniform scale, which also multiplies their radii.
    /// An emitter that moves as a whole, or a simulation in local space, needs no work on the CPU.
    pub world_from_particles: Mat4,
    /// Box in the particles' space that contains every sprite with its corners:
    /// [`SpriteExtent::radius`](crate::SpriteExtent::radius) around each particle. It decides which pixels are lit, which lights
    /// reach the smoke, and whether the system is visible.
    /// Sprites outside the box may be cut off; a box that is too large costs time. `None` measures a slice with
    /// [`particle_bounds`](crate::particle_bounds).
    pub bounds: Option<Bounds>,
    /// View depth, metres, of the plane on which light is evaluated, and by which systems are drawn far to near. It
    /// should move without jumps. The mean depth of the sprites, weighted by amount and area, is best; `None` uses it.
    /// For a buffer, `None` lights by the mean depth if compute shaders can read the buffer, and draws far to near by the
    /// middle of the part of `bounds` in front of the viewer, which jumps when `bounds` does.
    pub depth: Option<f32>,
    /// Settings of the system.
    pub settings: &'a Settings,
    /// Ramps and sprite images.
    pub material: &'a Material,
}

impl<'p, 'a> ParticleSystem<'p, 'a> {
    /// System with a measured box. `key`: any number that the frame's other systems do not have.
    pub const fn new(key: u64, particles: Particles<'p>, settings: &'a Settings, material: &'a Material) -> Self {
        Self { key, particles, world_from_particles: Mat4::IDENTITY, bounds: None, depth: None, settings, material }
    }
}

/// Particles on the GPU, in the layout of [`Particle`]. With `STORAGE` usage and an `offset` that is a multiple of 16, the
/// GPU measures them, and the smoke is lit as that of a slice; without, as if it filled `ParticleSystem::bounds`.
#[derive(Clone, Copy, Debug)]
pub struct ParticleBuffer<'a> {
    /// Contains `count` particles from `offset` on. `VERTEX` usage.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes before the first particle: a multiple of 4, or of 16 if compute shaders read the buffer because of `path` or
    /// `is_sorted`.
    pub offset: u64,
    /// Number of particles to draw; the largest number with `alive`.
    pub count: u32,
    /// Number of particles to draw if only the GPU knows it, such as the survivors of a simulation. `None`: `count`.
    pub alive: Option<AliveCount<'a>>,
    /// True if the particles are ordered back to front. If they are not and their order matters, the GPU sorts them, at
    /// equal depth by index. That needs compute shaders and `STORAGE` usage.
    pub is_sorted: bool,
}

impl<'a> ParticleBuffer<'a> {
    /// Unsorted particles from the start of a buffer.
    pub const fn new(buffer: &'a wgpu::Buffer, count: u32) -> Self {
        Self { buffer, offset: 0, count, alive: None, is_sorted: false }
    }
}

/// A number of particles in a GPU buffer: a `u32`, such as the instance count of an indirect draw. The first particles of
/// the buffer are drawn, up to `count`. [`Renderer::prepare`](crate::Renderer::prepare) records a copy of it.
#[derive(Clone, Copy, Debug)]
pub struct AliveCount<'a> {
    /// `COPY_SRC` usage.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes before the number, a multiple of 4.
    pub offset: u64,
}

/// Source of the sprites.
#[derive(Clone, Copy, Debug)]
pub enum Particles<'a> {
    /// Particles in memory. [`Renderer::prepare`](crate::Renderer::prepare) sorts and uploads them. A sprite with a
    /// number that is not finite or out of range is skipped.
    Slice(&'a [Particle]),
    /// Particles on the GPU. Requires `ParticleSystem::bounds`.
    Buffer(ParticleBuffer<'a>),
    /// Particles of an emitter at one time. The path `tiled` evaluates them on the GPU, with differences from
    /// [`EmitterSnapshot::evaluate`] by the device's rounding of sines, roots and powers, which swirls amplify: a tenth of
    /// a millimetre or so. Other paths evaluate them on the CPU, along their paths in the frame before. If `ParticleSystem::bounds` is `None`, the box is
    /// [`EmitterSnapshot::bounds`]. The mean depth is taken from a sample of about a thousand.
    Emitter(&'a EmitterSnapshot),
}

impl Particles<'_> {
    /// Number of particles, including invisible ones and all that a buffer has room for.
    pub fn count(&self) -> u32 {
        match *self {
            Self::Slice(particles) => particles.len() as u32,
            Self::Buffer(particles) => particles.count,
            Self::Emitter(emission) => emission.count(),
        }
    }

    /// True for a buffer that is not sorted although its order matters.
    pub fn needs_sorting(&self, settings: &Settings) -> bool {
        matches!(self, Self::Buffer(ParticleBuffer { is_sorted: false, .. })) && settings.order() == BlendOrder::Sorted
    }
}
