//! A system in sight, and the geometry that its passes share.

use glam::{IVec2, Mat4, Vec2, Vec3, Vec4Swizzles};

use super::frame::{Frame, System};
use crate::assets::material::{MaterialAssets, MaterialInfo};
use crate::assets::picture::Picture;
use crate::formula::depth::view_depth_from_ndc_depth;
use crate::formula::uniforms::{LightUniform, SystemUniform, ViewUniform};
use crate::formula::view::{ndc_from_pixel, pixel_from_ndc, view_position};
use crate::frame::{Particle, bounds_of};
use crate::in_view::{
    SortScratch, SystemInView, SystemInWorld, ViewGeometry, in_order, lights_in_view, system_in_view,
};
use crate::settings::Settings;

/// A system in sight, with what its passes read.
pub struct Draw<'a> {
    pub view: ViewUniform,
    pub world_from_view: Mat4,
    pub system: SystemUniform,
    pub in_view: SystemInView,
    pub lights: Vec<LightUniform>,
    /// In the order in which they are drawn.
    pub particles: Vec<Particle>,
    pub scene_depth: &'a Picture<f32>,
    pub settings: &'a Settings,
    pub material: &'a MaterialAssets,
}

impl<'a> Draw<'a> {
    /// `None` when the system is out of sight.
    pub fn new(view: &ViewGeometry, frame: &Frame<'a>, system: &System<'a>, material: &MaterialInfo) -> Option<Self> {
        let settings = system.settings;
        let bounds = system.bounds.unwrap_or_else(|| bounds_of(system.particles, settings.reach()));
        let mut lights = Vec::new();
        lights_in_view(view, frame.lights, &bounds, &mut lights);
        let in_world = SystemInWorld {
            bounds: &bounds,
            depth: system.depth,
            particles: system.particles,
            settings,
            material,
            lights: &lights,
            up: frame.up.normalize_or(Vec3::Y),
            time: frame.time,
        };
        let in_view = system_in_view(view, frame.view.size, &in_world)?;
        let mut particles = Vec::new();
        in_order(view, system.particles, settings.order(), &mut SortScratch::default(), &mut particles);
        Some(Self {
            view: view.uniform(false),
            world_from_view: view.view_from_world.inverse(),
            system: in_view.uniform,
            in_view,
            lights,
            particles,
            scene_depth: frame.scene_depth,
            settings,
            material: system.material,
        })
    }

    pub fn scene_view_depth(&self, pixel: IVec2) -> f32 {
        view_depth_from_ndc_depth(self.scene_depth.load(pixel), self.view.depth_coefficients)
    }

    /// The view-space point at a view depth on the ray through a pixel.
    pub fn view_position(&self, pixel: Vec2, view_depth: f32) -> Vec3 {
        let ray = ndc_from_pixel(pixel, self.view.size) * self.view.ray_scale + self.view.ray_offset;
        view_position(ray, view_depth, self.view.orthographic)
    }

    pub fn pixel_from_view(&self, position: Vec3) -> Vec2 {
        let clip = self.view.clip_from_view * position.extend(1.0);
        pixel_from_ndc(clip.xy() / clip.w, self.view.size)
    }

    pub fn pixels_per_metre(&self, view_depth: f32) -> f32 {
        let along = if self.view.orthographic > 0.5 { 1.0 } else { 1.0 / view_depth };
        0.5 * self.view.size.y / self.view.ray_scale.y * along
    }
}
