//! Scene data: boxes, sky, lights and occluders.

use glam::{Mat4, Vec3, Vec4};

use super::boxes::{MAX_BOXES, SceneBox};
use super::camera_rays::CameraRays;
use super::layout;
use super::occluders::Occluders;
use haze::formula::depth::{DepthConvention, depth_coefficients};
use haze::formula::uniforms::LightUniform;
use haze::frame::{Light, View};
use haze::preset::Environment;

/// Uniforms of the scene's shader. `Scene` in scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct SceneUniform {
    pub clip_from_world: Mat4,
    pub eye: Vec3,
    pub box_count: u32,
    pub zenith: Vec3,
    pub light_count: u32,
    pub horizon: Vec3,
    pub padding0: f32,
    pub ground: Vec3,
    pub padding1: f32,
    pub ray_forward: Vec3,
    pub padding2: f32,
    pub ray_right: Vec3,
    pub padding3: f32,
    pub ray_up: Vec3,
    pub padding4: f32,
    pub depth_coefficients: Vec4,
    pub apart: [u32; 4],
}

/// A scene prepared for drawing on the GPU or the CPU.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub boxes: Vec<SceneBox>,
    pub environment: Environment,
    /// Lights in world space.
    pub lights: Vec<LightUniform>,
    pub occluders: Occluders,
}

impl Scene {
    pub fn new(environment: &Environment, lights: &[Light]) -> Self {
        let mut boxes = layout::boxes(environment);
        boxes.truncate(MAX_BOXES);
        let lights: Vec<_> = lights.iter().map(|light| light.uniform(&Mat4::IDENTITY)).collect();
        Self { environment: *environment, occluders: Occluders::new(&boxes, &lights), boxes, lights }
    }

    /// `apart`: indices of the lights whose light is kept apart.
    pub fn uniform(&self, view: &View, apart: &[usize]) -> SceneUniform {
        let rays = CameraRays::new(view);
        let index = |slot: usize| apart.get(slot).map_or(u32::MAX, |&index| index as u32);
        SceneUniform {
            clip_from_world: view.clip_from_view * view.view_from_world,
            eye: rays.eye,
            box_count: self.boxes.len() as u32,
            zenith: self.environment.zenith,
            light_count: self.lights.len() as u32,
            horizon: self.environment.horizon,
            padding0: 0.0,
            ground: self.environment.ground,
            padding1: 0.0,
            ray_forward: rays.forward,
            padding2: 0.0,
            ray_right: rays.right,
            padding3: 0.0,
            ray_up: rays.up,
            padding4: 0.0,
            depth_coefficients: coefficients(view),
            apart: [index(0), index(1), index(2), u32::MAX],
        }
    }
}

/// Coefficients of a view's depth buffer. Those of a projection that has none make every pixel sky.
pub(crate) fn coefficients(view: &View) -> Vec4 {
    DepthConvention::from_clip_from_view(&view.clip_from_view).map_or(Vec4::X, |depth| depth_coefficients(&depth))
}
