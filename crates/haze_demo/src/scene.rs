//! Scene data: boxes or a mesh, sky, lights and occluders.

use glam::{Mat4, Vec3, Vec4};
use haze_core::formula::depth::{DepthConvention, depth_coefficients};
use haze_core::formula::saturate;
use haze_core::formula::uniforms::LightUniform;
use haze_core::frame::{Light, View};
use haze_preset::Environment;

use super::boxes::{MAX_BOXES, SceneBox};
use super::camera_rays::CameraRays;
use super::layout;
use super::occluders::Occluders;
use haze_author::backdrop::{Backdrop, SkyLight};

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
    /// Factor on the panorama; 0: there is none.
    pub sky_strength: f32,
    pub ground: Vec3,
    /// Metres per unit of a mesh.
    pub mesh_scale: f32,
    pub ray_forward: Vec3,
    /// Height of a pixel at view depth 1.
    pub pixel_size: f32,
    pub ray_right: Vec3,
    /// Rotation of the panorama.
    pub sky_cosine: f32,
    pub ray_up: Vec3,
    pub sky_sine: f32,
    pub depth_coefficients: Vec4,
    pub apart: [u32; 4],
    /// Ambient light by the normal.
    pub ambient: [Vec4; 9],
}

/// A scene prepared for drawing on the GPU or the CPU.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    /// Boxes of the demo scene; none beside a mesh.
    pub boxes: Vec<SceneBox>,
    /// Scene and sky from files.
    pub backdrop: Backdrop,
    /// Ambient light on surfaces, in the space of the panorama.
    pub ambient: SkyLight,
    pub environment: Environment,
    /// Lights in world space.
    pub lights: Vec<LightUniform>,
    pub occluders: Occluders,
}

impl Scene {
    pub fn new(environment: &Environment, lights: &[Light], backdrop: &Backdrop) -> Self {
        let mut boxes = if backdrop.mesh().is_some() { Vec::new() } else { layout::boxes(environment) };
        boxes.truncate(MAX_BOXES);
        let lights: Vec<_> = lights.iter().map(|light| light.uniform(&Mat4::IDENTITY)).collect();
        let ambient = match &backdrop.sky {
            Some(sky) if environment.sky_light => sky.light.scaled(environment.sky_exposure.exp2()),
            _ => SkyLight::of_hemispheres(environment.horizon.lerp(environment.zenith, 0.5), environment.ground),
        };
        Self {
            environment: environment.clone(),
            occluders: Occluders::new(&boxes, &lights),
            boxes,
            lights,
            backdrop: backdrop.clone(),
            ambient,
        }
    }

    /// Factor on the panorama; 0 without one.
    fn sky_strength(&self) -> f32 {
        if self.backdrop.sky.is_some() { self.environment.sky_exposure.exp2() } else { 0.0 }
    }

    /// Turns a direction of the world into one of the panorama. `to_sky` in scene.wgsl.
    fn to_sky(&self, v: Vec3) -> Vec3 {
        let (sine, cosine) = self.environment.sky_rotation.to_radians().sin_cos();
        Vec3::new(v.x * cosine + v.z * sine, v.y, v.z * cosine - v.x * sine)
    }

    /// Returns the radiance of the sky in a direction.
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        if let Some(sky) = &self.backdrop.sky {
            return sky.sample(self.to_sky(direction)) * self.sky_strength();
        }
        let up = saturate(direction.y);
        self.environment.horizon.lerp(self.environment.zenith, 1.0 - (1.0 - up).powi(3))
    }

    /// Returns the ambient light that a white matte surface shows.
    pub fn ambient_light(&self, normal: Vec3) -> Vec3 {
        self.ambient.on(self.to_sky(normal))
    }

    /// `apart`: indices of the lights whose light is kept apart.
    pub fn uniform(&self, view: &View, apart: &[usize]) -> SceneUniform {
        let rays = CameraRays::new(view);
        let (sine, cosine) = self.environment.sky_rotation.to_radians().sin_cos();
        let index = |slot: usize| apart.get(slot).map_or(u32::MAX, |&index| index as u32);
        SceneUniform {
            clip_from_world: view.clip_from_view * view.view_from_world,
            eye: rays.eye,
            box_count: self.boxes.len() as u32,
            zenith: self.environment.zenith,
            light_count: self.lights.len() as u32,
            horizon: self.environment.horizon,
            sky_strength: self.sky_strength(),
            ground: self.environment.ground,
            mesh_scale: self.environment.scene_scale,
            ray_forward: rays.forward,
            pixel_size: rays.up.length() * 2.0 / view.size.y.max(1) as f32,
            ray_right: rays.right,
            sky_cosine: cosine,
            ray_up: rays.up,
            sky_sine: sine,
            depth_coefficients: coefficients(view),
            apart: [index(0), index(1), index(2), u32::MAX],
            ambient: self.ambient.coefficients.map(|color| color.extend(0.0)),
        }
    }
}

/// Coefficients of a view's depth buffer. Those of a projection that has none make every pixel sky.
pub(crate) fn coefficients(view: &View) -> Vec4 {
    DepthConvention::from_clip_from_view(&view.clip_from_view).map_or(Vec4::X, |depth| depth_coefficients(&depth))
}
