//! One particle system in a view: the texels of its target, and its uniforms.

use std::cmp::Ordering;

use glam::{DVec3, Mat4, UVec2, Vec2, Vec3, Vec4};

use super::optical_depth::optical_depths;
use super::particle_space::ParticleSpace;
use super::projected_bounds::{TargetRect, project_bounds, target_rect};
use super::resolved_settings::ResolvedSettings;
use super::smoke_extent::SmokeExtent;
use super::smoke_shadow::SmokeShadow;
use super::sprite_projector::{SpriteProjector, SpriteTrim, TexelGrid};
use super::view_geometry::ViewGeometry;
use crate::assets::material_assets::MaterialInfo;
use crate::formula::depth::SKY_VIEW_DEPTH;
use crate::formula::diffuse_bake::add_light;
use crate::formula::lighting::{backlight_weight, direction_to_viewer, sample_light};
use crate::formula::uniforms::{LightUniform, SystemUniform, ViewUniform};
use crate::formula::view::pixels_per_metre;
use crate::frame::{Bounds, Particle};
use crate::settings::{Backlight, BlendOrder, DepthSource, DiffuseMode, Settings};

/// Properties of a system before it is placed in a view.
#[derive(Clone, Copy, Debug)]
pub struct SystemInput<'a> {
    /// Box that contains every sprite, world space.
    pub bounds: &'a Bounds,
    /// View depth that the host chose for lighting, metres.
    pub depth: Option<f32>,
    /// Placement of the particles.
    pub space: &'a ParticleSpace,
    /// Extent of the particles, if they are known and one of them is in front of the viewer.
    pub extent: Option<SmokeExtent>,
    /// Empty if the particles are on the GPU.
    pub particles: &'a [Particle],
    /// Number of particles that each element represents.
    pub particles_per_sample: u32,
    /// Settings in the view.
    pub settings: &'a ResolvedSettings,
    /// Properties of the images.
    pub material: &'a MaterialInfo,
    /// Lights that reach the system, view space.
    pub lights: &'a [LightUniform],
    /// Unit length.
    pub up: Vec3,
    /// Multiplies light; `lights` are exposed already.
    pub exposure: f32,
    /// Seconds.
    pub time: f64,
    /// Shadow of the frame's smoke; `None` if no system receives it.
    pub shadow: Option<&'a SmokeShadow>,
}

/// A visible system.
#[derive(Clone, Copy, Debug)]
pub struct SystemSetup {
    /// Part of the view that the target covers.
    pub rect: TargetRect,
    /// First pixel of the bounding box on the screen, and its size, pixels.
    pub first_pixel: UVec2,
    /// See `first_pixel`.
    pub pixels: UVec2,
    /// Uniforms of the system.
    pub uniform: SystemUniform,
    /// True if the transfer draws the back faces of the box: it reaches to or behind the near plane, or its sprites
    /// show through the scene.
    pub back_faces: bool,
    /// When the system is drawn.
    pub draw_order: DrawOrder,
    /// View depth of the smoke's center in the host's view space, metres.
    pub lit_depth: f32,
}

/// When a system is drawn, among those of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct DrawOrder {
    /// [`Settings::sort_priority`].
    pub sort_priority: u32,
    /// View depth of the smoke's center, metres.
    pub distance: f32,
}

impl DrawOrder {
    /// By priority, then far to near.
    pub fn compare(&self, other: &Self) -> Ordering {
        let nearer_last = other.distance.total_cmp(&self.distance);
        self.sort_priority.cmp(&other.sort_priority).then(nearer_last)
    }
}

impl SystemSetup {
    /// Returns the texel grid of the system's target.
    pub fn grid(&self) -> TexelGrid {
        TexelGrid { origin: self.rect.origin.as_vec2(), scale: self.rect.scale as f32, size: self.rect.size }
    }

    /// Returns the projection of its sprites.
    pub fn projector<'a>(
        &'a self,
        view: &'a ViewUniform,
        settings: &Settings,
        trim: &'a SpriteTrim,
    ) -> SpriteProjector<'a> {
        SpriteProjector { view, system: &self.uniform, technique: settings.technique, trim }
    }

    /// Returns the same setup with a target of another scale; the system's scene depth is the reduced one.
    pub fn with_scale(self, view: &ViewGeometry, scale: u32) -> Self {
        let rect = target_rect(self.first_pixel, self.pixels, scale, view.size);
        Self { rect, uniform: target_uniform(&rect, view.size, self.uniform), ..self }
    }
}

/// Places a system in the view; `None` if it is out of sight. `targets`: size of the host's targets, pixels; the view
/// may be a part of the targets.
pub fn system_setup(view: &ViewGeometry, targets: UVec2, system: &SystemInput<'_>) -> Option<SystemSetup> {
    let SystemInput { bounds, depth, space, extent, particles, particles_per_sample, .. } = *system;
    let SystemInput { settings, material, lights, up, exposure, time, shadow, .. } = *system;
    let projected = project_bounds(bounds, view)?;
    let extent = SmokeExtent::new(view, extent, bounds, &projected, depth);
    // A sample does not include the farthest particle.
    let farthest = if particles_per_sample == 1 { extent.farthest } else { projected.far };
    let accumulate = &settings.accumulate;
    let [near_fade_start, near_fade_end] =
        settings.soft_fade.near_fade_depths(settings.technique.is_flat(), view.depth.near);
    let scale = settings.scale;
    let pixels = projected.max - projected.min;
    let rect = match accumulate.depth_source {
        DepthSource::Reduced => target_rect(projected.min, pixels, scale, view.size),
        // All attachments of a pass must have one size.
        DepthSource::Host => TargetRect { origin: -view.origin.as_ivec2(), size: targets, scale },
    };

    let uniform = SystemUniform {
        bounds_min: bounds.min,
        bounds_near: projected.near,
        bounds_max: bounds.max,
        smoke_near: extent.near,
        center: extent.center,
        smoke_far: extent.far,
        scatter_color: settings.soft_scatter.scatter_color * exposure,
        scatter_amount: settings.soft_scatter.scatter_amount,
        ambient_color: settings.soft_scatter.ambient_color * exposure,
        scatter_smooth: settings.soft_scatter.scatter_smooth,
        depth_limit: (projected.far + settings.soft_fade.max_distance()).min(SKY_VIEW_DEPTH),
        smoke_depth_limit: (farthest.min(projected.far) + settings.soft_fade.max_distance()).min(SKY_VIEW_DEPTH),
        six_way_color: settings.diffuse.six_way_color,
        six_way_anisotropy: settings.diffuse.six_way_anisotropy,
        sprite_size: material.sprite_size,
        frame_count: material.frame_count,
        boost: settings.boost,
        fade_scale: settings.soft_fade.fade_scale,
        contrast_power: settings.soft_fade.contrast_power,
        epsilon: settings.soft_fade.epsilon,
        near_fade_start,
        near_fade_end,
        diffuse_intensity: settings.diffuse.intensity,
        soft_scatter_intensity: settings.soft_scatter.intensity,
        specular_scatter_size: settings.specular_scatter.size_in_pixels(view.size.y),
        specular_scatter_intensity: settings.specular_scatter.intensity,
        specular_scatter_falloff: settings.specular_scatter.falloff,
        light_count: lights.len() as u32,
        motion: settings.sprite.motion,
        age_color: settings.sprite.age_color,
        tint: settings.sprite.tint,
        stretch: if settings.is_stretched() { settings.sprite.stretch } else { 0.0 },
        stretch_limit: settings.sprite.stretch_limit,
        stretch_axis: settings.sprite.stretch_axis,
        grain_bump: settings.grain.bump,
        grain_tiles: settings.grain.tiles,
        grain_fineness: settings.grain.tiles * material.noise_size
            / (2.0 * pixels_per_metre(view.size.y as f32, view.ray_scale.y, 1.0, 0.0)),
        detail_lod: material.detail.map_or(0.0, |detail| detail.lod),
        billboard_radius: settings.spherical_billboard.radius,
        billboard_density: settings.spherical_billboard.density,
        density: settings.exponential.density,
        noise_size: settings.volumetric.noise_size,
        volume_opacity: settings.volumetric.opacity,
        noise_offset: noise_offset(view, settings, up, time),
        show_through_distance: settings.show_through_distance(),
        depth_weight: accumulate.depth_weight,
        optical_depth_knots: match settings.order() {
            BlendOrder::Sorted => [Vec4::ZERO; 4],
            BlendOrder::Weighted => optical_depths(view, space, particles, particles_per_sample, settings, &extent),
        },
        spherical_harmonics: spherical_harmonics(view, settings, material, lights, extent.center),
        shadow_strength: if shadow.is_some() && settings.receives_shadow() { settings.shadow.strength } else { 0.0 },
        up: view.view_from_world.transform_vector3(up).normalize_or(Vec3::Y),
        sky_color: settings.ambient.sky_color * (settings.ambient.intensity * exposure),
        ground_color: settings.ambient.ground_color * (settings.ambient.intensity * exposure),
        fire_intensity: settings.fire.intensity * exposure,
        fire_core: settings.fire.core,
        fire_crust: settings.fire_crust(),
        visibility_block: shadow.map_or(0.0, |shadow| shadow.visibility_block() as f32),
        openness_block: shadow.map_or(0.0, |shadow| shadow.openness_block() as f32),
        ..target_uniform(&rect, view.size, caster_uniform(system))
    };
    // If sprites show through the scene, the scene may hide the front of the box.
    let back_faces = projected.near <= view.depth.near || uniform.show_through_distance > 0.0;
    let distance = -uniform.center.z;
    Some(SystemSetup {
        rect,
        first_pixel: projected.min,
        pixels,
        uniform,
        back_faces,
        draw_order: DrawOrder { sort_priority: settings.sort_priority, distance },
        lit_depth: distance - view.depth_offset,
    })
}

/// Uniforms with the placement of the target.
fn target_uniform(rect: &TargetRect, image: UVec2, uniform: SystemUniform) -> SystemUniform {
    SystemUniform {
        target_from_ndc: target_from_ndc(rect, image),
        target_origin: rect.origin.as_vec2(),
        target_size: rect.size.as_vec2(),
        scale: rect.scale,
        ..uniform
    }
}

/// Uniforms of a system that only casts shadow: what density_splat reads.
pub fn caster_uniform(system: &SystemInput<'_>) -> SystemUniform {
    let SystemInput { space, settings, material, shadow, .. } = *system;
    let has_grain = settings.grain_octaves() > 0;
    SystemUniform {
        view_from_particles: space.view_from_particles,
        opacity: settings.accumulate.opacity,
        size: settings.sprite.size,
        alive_count: u32::MAX,
        mean_alpha: material.density.mean_alpha,
        peak_alpha: material.density.peak_alpha,
        eroded_fraction: material.density.eroded_fraction,
        density_reach: material.density.reach,
        grid_from_view: shadow.map_or(Mat4::IDENTITY, |shadow| shadow.grid_from_view),
        grid_size: shadow.map_or(Vec3::ONE, |shadow| shadow.grid.size.as_vec3()),
        cells_per_metre: shadow.map_or(1.0, |shadow| shadow.grid.cells_per_metre()),
        shadow_density: settings.shadow.density,
        grain_erosion: if has_grain { settings.grain.erosion } else { 0.0 },
        grain_dissolve: if has_grain { settings.grain.dissolve } else { 0.0 },
        ..SystemUniform::default()
    }
}

/// Projects the diffuse ramp's response to all lights, as seen at `center`, to spherical harmonics; zeros in other
/// diffuse modes.
fn spherical_harmonics(
    view: &ViewGeometry,
    settings: &Settings,
    material: &MaterialInfo,
    lights: &[LightUniform],
    center: Vec3,
) -> [Vec4; 9] {
    let mut sum = [Vec4::ZERO; 9];
    if settings.diffuse.mode != DiffuseMode::SphericalHarmonics {
        return sum;
    }
    let orthographic = if view.depth.orthographic { 1.0 } else { 0.0 };
    let to_viewer = direction_to_viewer(center, orthographic);
    for light in lights {
        let sample = sample_light(light, center);
        let color = light.color * sample.attenuation;
        let backlight = match settings.diffuse.backlight {
            Backlight::Same => 0.0,
            Backlight::Ramp => backlight_weight(sample.direction, to_viewer),
        };
        let zonal = std::array::from_fn(|l| material.zonal[l].lerp(material.backlight_zonal[l], backlight));
        add_light(&mut sum, &zonal, sample.direction, color);
    }
    sum
}

/// Returns the position of the eye in the noise, which rises with time. The position is wrapped to one tile, so that
/// f32 is precise enough after hours and far from the world's origin.
fn noise_offset(view: &ViewGeometry, settings: &Settings, up: Vec3, time: f64) -> Vec3 {
    let volumetric = &settings.volumetric;
    let seconds = if settings.debug.freeze_animation { 0.0 } else { time };
    let eye = view.view_from_world.as_dmat4().inverse().w_axis.truncate();
    let position = eye - up.as_dvec3() * (f64::from(volumetric.scroll_speed) * seconds);
    let size = f64::from(volumetric.noise_size);
    DVec3::from(position.to_array().map(|axis| axis.rem_euclid(size))).as_vec3()
}

/// Returns scale (xy) and offset (zw) from the view's NDC to the target's.
///
/// A pixel p is at texel p / scale − origin of the target. In x, with p = (ndc/2 + 1/2)·W and target NDC = 2·t/w − 1:
/// scale = W / (s·w), offset = (W/s − 2·origin) / w − 1. In y, which points up in NDC and down in texels, the offset
/// has the opposite sign.
fn target_from_ndc(rect: &TargetRect, image: UVec2) -> Vec4 {
    let texels = image.as_vec2() / rect.scale as f32;
    let size = rect.size.as_vec2();
    let offset = (texels - 2.0 * rect.origin.as_vec2()) / size - Vec2::ONE;
    Vec4::new(texels.x / size.x, texels.y / size.y, offset.x, -offset.y)
}
