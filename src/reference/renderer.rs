//! The whole frame on the CPU, pass by pass as in `src/renderer.rs`, in f32.

use glam::{IVec2, Mat4, Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::bounds::Bounds;
use crate::error::FieldError;
use crate::frame::{validate_lights, validate_settings};
use crate::gpu_types::{LightUniform, SystemUniform, ViewUniform};
use crate::light::Light;
use crate::material::MaterialAssets;
use crate::particle::{Particle, bounds_of};
use crate::pass::sort::{SortScratch, back_to_front};
use crate::reference::depth::view_depth_from_ndc_depth;
use crate::reference::pass::transfer::Smoke;
use crate::reference::picture::Picture;
use crate::reference::view::{ndc_from_pixel, pixel_from_ndc, view_position};
use crate::settings::{Settings, ShadeTree};
use crate::system::{MaterialInfo, SystemInView, lights_in_view, system_in_view};
use crate::view::{View, ViewGeometry};

/// One frame, as [`crate::Frame`], in memory.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// What a depth buffer written with the view's projection would hold, 0..1.
    pub scene_depth: &'a Picture<f32>,
    /// At most [`MAX_LIGHTS`](crate::light::MAX_LIGHTS).
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
    /// Everything a slider moves.
    pub settings: &'a Settings,
    /// Ramps and sprite picture.
    pub material: &'a MaterialAssets,
}

/// Blends the frame's smoke over `picture`, linear HDR.
///
/// # Errors
/// The view, light or setting that cannot be used; `picture` is untouched then.
pub fn render(frame: &Frame<'_>, picture: &mut Picture<Vec4>) -> Result<(), FieldError> {
    let view = ViewGeometry::new(&frame.view)?;
    validate_lights(frame.lights)?;
    if !frame.time.is_finite() {
        return Err(FieldError::new("time", frame.time, "a finite number of seconds"));
    }
    for (name, size) in [("scene_depth", frame.scene_depth.size), ("picture", picture.size)] {
        if size != frame.view.size {
            let value = format!("{}x{}", size.x, size.y);
            return Err(FieldError::new(name, value, format!("{}x{}", frame.view.size.x, frame.view.size.y)));
        }
    }
    let mut draws = Vec::new();
    for (index, system) in frame.systems.iter().enumerate() {
        validate_settings(index, system.settings, frame.view.size)?;
        let info = system.material.info();
        info.validate(index, system.settings)?;
        draws.extend(Draw::new(&view, frame, system, &info));
    }
    draws.sort_by(|a, b| b.distance.total_cmp(&a.distance));

    for draw in &draws {
        if draw.settings.is_forward() {
            if matches!(frame.shade_tree, ShadeTree::Final | ShadeTree::Combined) {
                draw.forward(picture);
            }
            continue;
        }
        let reduced_depth = draw.depth_downsample();
        let accumulation = draw.accumulate(&reduced_depth, frame.shade_tree == ShadeTree::Overdraw);
        let smoke = Smoke { draw, baked: draw.diffuse_bake(), reduced_depth, accumulation };
        if frame.shade_tree != ShadeTree::SpecularScatter {
            smoke.transfer(frame.shade_tree, picture);
        }
        if matches!(frame.shade_tree, ShadeTree::Final | ShadeTree::SpecularScatter) {
            smoke.specular_scatter(picture);
        }
    }
    Ok(())
}

/// A system in sight, with what its passes read.
pub(super) struct Draw<'a> {
    /// View depth of the box's middle.
    pub distance: f32,
    pub view: ViewUniform,
    pub world_from_view: Mat4,
    pub system: SystemUniform,
    pub in_view: SystemInView,
    pub lights: Vec<LightUniform>,
    /// Farthest first.
    pub particles: Vec<Particle>,
    pub scene_depth: &'a Picture<f32>,
    pub settings: &'a Settings,
    pub material: &'a MaterialAssets,
}

impl<'a> Draw<'a> {
    fn new(view: &ViewGeometry, frame: &Frame<'a>, system: &System<'a>, info: &MaterialInfo) -> Option<Self> {
        let bounds = system.bounds.unwrap_or_else(|| bounds_of(system.particles, system.settings.reach()));
        let mut lights = Vec::new();
        lights_in_view(view, frame.lights, &bounds, &mut lights);
        let in_view = system_in_view(view, &bounds, system.settings, info, &lights, frame.time)?;
        let mut particles = Vec::new();
        back_to_front(view, system.particles, &mut SortScratch::default(), &mut particles);
        Some(Self {
            distance: -view.view_position(bounds.centre()).z,
            view: view.uniform(false),
            world_from_view: view.view.view_from_world.inverse(),
            system: in_view.uniform,
            in_view,
            lights,
            particles,
            scene_depth: frame.scene_depth,
            settings: system.settings,
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
