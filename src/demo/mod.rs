//! The demo scene that smoke is shown in: boxes with procedural materials, lit by the preset's lights, drawn on the GPU and
//! on the CPU alike.

mod cpu;
mod gpu;
mod layout;
mod shading;
pub mod shot;
pub mod stage;

use glam::{Mat4, Vec3};

use crate::Light;
use crate::gpu_types::LightUniform;
use crate::preset::{Environment, SceneName};

/// Most boxes of one scene: the length of the uniform array in scene.wgsl.
pub(crate) const MAX_BOXES: usize = 96;

/// One box, turned about the vertical. `Box` in scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct SceneBox {
    pub centre: Vec3,
    /// Cosine of the turn.
    pub cos: f32,
    pub half_size: Vec3,
    /// Sine of the turn.
    pub sin: f32,
    /// Linear; radiance for [`Surface::Glow`].
    pub colour: Vec3,
    /// A [`Surface`].
    pub surface: u32,
}

impl SceneBox {
    /// A vector in the box's own frame.
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos + v.z * self.sin, v.y, v.z * self.cos - v.x * self.sin)
    }

    /// A vector of the box's own frame in the world.
    pub fn to_world(self, v: Vec3) -> Vec3 {
        Vec3::new(v.x * self.cos - v.z * self.sin, v.y, v.z * self.cos + v.x * self.sin)
    }
}

/// The procedural material of a box. The numbers are those of scene.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    Plain = 0,
    Slabs = 1,
    Brick = 2,
    Wood = 3,
    Plaster = 4,
    /// Shines, casts no shadow.
    Glow = 5,
}

/// What the scene's shader reads. `Scene` in scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct SceneUniform {
    pub clip_from_world: Mat4,
    pub world_from_clip: Mat4,
    pub eye: Vec3,
    pub box_count: u32,
    pub zenith: Vec3,
    pub light_count: u32,
    pub horizon: Vec3,
    pub padding0: f32,
    pub ground: Vec3,
    pub padding1: f32,
}

/// A scene, ready to be drawn by either renderer.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub boxes: Vec<SceneBox>,
    pub environment: Environment,
    /// World space.
    pub lights: Vec<LightUniform>,
}

impl Scene {
    pub fn new(name: SceneName, environment: &Environment, lights: &[Light]) -> Self {
        let mut boxes = layout::boxes(name);
        boxes.truncate(MAX_BOXES);
        Self {
            boxes,
            environment: *environment,
            lights: lights.iter().map(|light| light.uniform(&Mat4::IDENTITY)).collect(),
        }
    }

    pub fn uniform(&self, clip_from_world: Mat4, eye: Vec3) -> SceneUniform {
        SceneUniform {
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            eye,
            box_count: self.boxes.len() as u32,
            zenith: self.environment.zenith,
            light_count: self.lights.len() as u32,
            horizon: self.environment.horizon,
            padding0: 0.0,
            ground: self.environment.ground,
            padding1: 0.0,
        }
    }
}
