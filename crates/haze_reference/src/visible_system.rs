//! Visible system, with the geometry that its passes share.

use std::sync::Arc;

use glam::{IVec2, Mat4, UVec2, Vec2, Vec3, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::assets::material_assets::{MaterialAssets, MaterialInfo};
use haze_core::error::FieldError;
use haze_core::formula::depth::view_depth_from_ndc_depth;
use haze_core::formula::uniforms::{LightUniform, SystemUniform, ViewUniform};
use haze_core::formula::view::{ndc_from_pixel, pixel_from_ndc, view_position};
use haze_core::frame::validate_input::{
    validate_bounds_and_depth, validate_frame_numbers, validate_lights, validate_settings, validate_shadow_projections,
    validate_world_from_particles,
};
use haze_core::frame::{Bounds, Particle, View};
use haze_core::settings::{BlendOrder, DebugView};
use haze_core::view_setup::{
    ParticleMeasures, ParticleSpace, ResolvedSettings, ScaleChoice, SmokeShadow, SpriteTrim, Support, SystemBoxes,
    SystemInput, SystemSetup, ViewGeometry, caster_uniform, light_uniforms, system_setup,
};

use super::input::{FrameInput, ParticleSystem};
use super::optical_depths::OpticalDepths;

/// Visible system, with the input of its passes.
pub struct VisibleSystem<'a> {
    /// Camera.
    pub view: ViewUniform,
    /// Inverse of the view matrix.
    pub world_from_view: Mat4,
    /// Uniforms of the system.
    pub system: SystemUniform,
    /// Placement of the system in the view.
    pub setup: SystemSetup,
    /// Box that contains every sprite, world space.
    pub bounds: Bounds,
    /// Lights that reach the system, view space.
    pub lights: Vec<LightUniform>,
    /// In drawing order.
    pub particles: Vec<Particle>,
    /// Trimming of the sprites.
    pub trim: SpriteTrim,
    /// Depth buffer of the scene, 0..1.
    pub scene_depth: &'a Image<f32>,
    /// Settings of the system.
    pub settings: ResolvedSettings,
    /// Images of the system.
    pub material: &'a MaterialAssets,
    /// Optical depths of the frame's smoke, once they are computed.
    pub optical_depths: Option<Arc<OpticalDepths>>,
}

impl<'a> VisibleSystem<'a> {
    /// Returns the uniforms of its shadow alone if the system is not visible.
    fn new(
        view: &ViewGeometry,
        frame: &FrameInput<'a>,
        system: &ParticleSystem<'a>,
        measured: MeasuredSystem,
        shadow: Option<&SmokeShadow>,
    ) -> Result<Self, Box<SystemUniform>> {
        let MeasuredSystem { material, space, settings, mut measures, boxes } = measured;
        let bounds = boxes.all;
        let material = &material;
        let mut lights = Vec::new();
        let on_system = shadow.map(|shadow| (shadow, settings.shadow_blocks()));
        light_uniforms(view, frame.lights, frame.exposure, &bounds, on_system, &mut lights);
        let in_world = SystemInput {
            particles_per_sample: 1,
            bounds: &bounds,
            depth: system.depth,
            space: &space,
            extent: measures.extent(),
            particles: system.particles,
            settings: &settings,
            material,
            lights: &lights,
            up: frame.up.normalize_or(Vec3::Y),
            exposure: frame.exposure,
            time: frame.time,
            shadow,
        };
        let setup = system_setup(view, frame.view.size, &in_world);
        let mut setup = setup.ok_or_else(|| Box::new(caster_uniform(&in_world)))?;
        let trim = SpriteTrim::new(&settings, material);
        let mut settings = settings;
        ScaleChoice::apply(view, &mut settings, &mut setup, &trim, material, Some((system.particles, 1)), None);
        if settings.order() == BlendOrder::Sorted {
            measures.order.sort();
        }
        let particles = measures.order.indices().map(|index| system.particles[index]).collect();
        Ok(Self {
            view: view.uniform(false),
            world_from_view: view.view_from_world.inverse(),
            system: setup.uniform,
            setup,
            bounds,
            lights,
            particles,
            trim,
            scene_depth: frame.scene_depth,
            settings,
            material: system.material,
            optical_depths: None,
        })
    }

    /// True if this debug view shows the light of the target's texels, or its amount.
    pub fn lights_per_texel(&self, debug_view: DebugView) -> bool {
        (debug_view.shows_lit_smoke() || debug_view.shows_glow()) && self.settings.lights_per_texel()
    }

    /// View depth of the scene at a pixel, metres.
    pub fn scene_view_depth(&self, pixel: IVec2) -> f32 {
        view_depth_from_ndc_depth(self.scene_depth.load(pixel), self.view.depth_coefficients)
    }

    /// View-space point at a view depth on the ray through a pixel.
    pub fn view_position(&self, pixel: Vec2, view_depth: f32) -> Vec3 {
        let ray = ndc_from_pixel(pixel, self.view.size) * self.view.ray_scale + self.view.ray_offset;
        view_position(ray, view_depth, self.view.orthographic)
    }

    /// Pixel of a point in view space.
    pub fn pixel_from_view(&self, position: Vec3) -> Vec2 {
        let clip = self.view.clip_from_view * position.extend(1.0);
        pixel_from_ndc(clip.xy() / clip.w, self.view.size)
    }
}

/// A system with its box, before it is placed in the view.
struct MeasuredSystem {
    material: MaterialInfo,
    space: ParticleSpace,
    settings: ResolvedSettings,
    measures: ParticleMeasures,
    boxes: SystemBoxes,
}

impl MeasuredSystem {
    fn new(view: &ViewGeometry, system: &ParticleSystem<'_>, material: MaterialInfo) -> Self {
        let space = ParticleSpace::new(view, &system.world_from_particles);
        let MaterialInfo { frame_count, ramp_steps, .. } = &material;
        let settings =
            ResolvedSettings::new(system.settings, space.scale, view.size, *frame_count, ramp_steps, Support::ALL);
        let mut measures = ParticleMeasures::default();
        measures.measure(&space, view.depth.near, system.particles, &settings);
        let boxes = measures.boxes(system.bounds.map(|bounds| space.world_bounds(&bounds)));
        Self { material, space, settings, measures, boxes }
    }
}

/// Placed systems of a frame.
pub struct PlacedSystems<'a> {
    /// Visible systems with their indices in the frame, in the order in which they are drawn.
    pub visible: Vec<(usize, VisibleSystem<'a>)>,
    /// Uniforms and particles of systems out of sight, which cast shadow.
    pub hidden: Vec<(SystemUniform, &'a [Particle])>,
    /// Shadow of the smoke of all systems, if any receives it.
    pub shadow: Option<SmokeShadow>,
}

/// Places the systems of a frame, for an image of this size.
pub fn place_systems<'a>(frame: &FrameInput<'a>, image: UVec2) -> Result<PlacedSystems<'a>, FieldError> {
    // The image is the view, whatever its origin in a host's targets.
    let view = ViewGeometry::new(&View { origin: UVec2::ZERO, ..frame.view })?;
    validate_lights(frame.lights)?;
    validate_shadow_projections(frame.lights.len(), frame.shadow_maps.iter().map(|map| map.projection))?;
    validate_frame_numbers(frame.exposure, frame.time, frame.up, frame.scene_ambient)?;
    for (name, size) in [("scene_depth", frame.scene_depth.size), ("image", image)] {
        if size != frame.view.size {
            let value = format!("{}x{}", size.x, size.y);
            return Err(FieldError::new(name, value, format!("{}x{}", frame.view.size.x, frame.view.size.y)));
        }
    }
    let mut measured = Vec::new();
    for (index, system) in frame.systems.iter().enumerate() {
        validate_settings(index, system.settings, frame.view.size)?;
        validate_world_from_particles(index, &system.world_from_particles)?;
        validate_bounds_and_depth(index, system.bounds.as_ref(), system.depth)?;
        let info = system.material.info();
        info.validate(index, system.settings)?;
        measured.push(MeasuredSystem::new(&view, system, info));
    }
    let boxes = measured.iter().map(|measured| (measured.boxes.casting, measured.settings));
    let is_mapped = |light| frame.shadow_maps.iter().any(|map| map.projection.light == light);
    let shadow = SmokeShadow::new(&view, frame.up.normalize_or(Vec3::Y), u32::MAX, frame.lights, is_mapped, boxes);
    let mut visible = Vec::new();
    let mut hidden = Vec::new();
    for (index, (system, measured)) in frame.systems.iter().zip(measured).enumerate() {
        match VisibleSystem::new(&view, frame, system, measured, shadow.as_ref()) {
            Ok(system) => visible.push((index, system)),
            Err(uniform) => hidden.push((*uniform, system.particles)),
        }
    }
    visible.sort_by(|(_, a), (_, b)| a.setup.draw_order.compare(&b.setup.draw_order));
    Ok(PlacedSystems { visible, hidden, shadow })
}
