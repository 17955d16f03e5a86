//! What is derived from a particle system once per frame, on the CPU: where it stands in the view, its uniforms, and the
//! lights that reach it. Both the GPU renderer and the reference start from here.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

use crate::bounds::{Bounds, TargetRect, bounds_in_view, effective_scale, target_rect};
use crate::gpu_types::{LightUniform, SystemUniform, ViewUniform};
use crate::light::{Light, LightKind};
use crate::reference::depth::depth_coefficients;
use crate::reference::diffuse_bake::add_light;
use crate::reference::lighting::sample_light;
use crate::settings::{DepthSource, DiffuseMode, Settings};
use crate::view::{SKY_VIEW_DEPTH, ViewGeometry};

impl ViewGeometry {
    /// `linear_depth`: the scene depth is view depth already.
    pub fn uniform(&self, linear_depth: bool) -> ViewUniform {
        let identity = Vec4::new(0.0, 1.0, 1.0, 0.0);
        ViewUniform {
            view_from_world: self.view.view_from_world,
            clip_from_view: self.view.clip_from_view,
            depth_coefficients: if linear_depth { identity } else { depth_coefficients(&self.depth) },
            ray_scale: self.ray_scale,
            ray_offset: self.ray_offset,
            size: self.view.size.as_vec2(),
            near: self.depth.near,
            far: self.depth.far.min(SKY_VIEW_DEPTH),
            orthographic: if self.depth.orthographic { 1.0 } else { 0.0 },
            padding: [0.0; 3],
        }
    }
}

/// What a system needs to know of its sprite picture and ramp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaterialInfo {
    pub sprite_size: f32,
    pub frame_count: f32,
    pub detail: Option<DetailInfo>,
    /// Zonal harmonics of the diffuse ramp.
    pub zonal: [Vec3; 3],
}

/// What it needs to know of its detail map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DetailInfo {
    pub frame_count: u32,
    /// Mip levels that it is smaller than the sprite.
    pub lod: f32,
}

/// A system that is in sight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SystemInView {
    pub rect: TargetRect,
    pub uniform: SystemUniform,
    /// The transfer draws the back faces of the box: it reaches to or behind the near plane, or shows through the scene.
    pub back_faces: bool,
}

/// Places a system in the view; `None` when it is out of sight. `lights` are those that reach it.
pub(crate) fn system_in_view(
    view: &ViewGeometry,
    bounds: &Bounds,
    settings: &Settings,
    material: &MaterialInfo,
    lights: &[LightUniform],
    time: f32,
) -> Option<SystemInView> {
    let in_view = bounds_in_view(bounds, view)?;
    let accumulate = &settings.accumulate;
    let picture = view.view.size;
    let scale = effective_scale(accumulate.scale, accumulate.max_side, picture);
    let rect = match accumulate.depth_source {
        DepthSource::Reduced => target_rect(&in_view, scale, picture),
        // Attachments of one pass are of one size.
        DepthSource::Host => TargetRect { origin: IVec2::ZERO, size: picture },
    };

    let mut uniform = SystemUniform {
        bounds_min: bounds.min,
        bounds_near: in_view.near,
        bounds_max: bounds.max,
        bounds_far: in_view.far,
        bounds_centre: view.view_position(bounds.centre()),
        // The plane through the middle of what is in front of the near plane: through the box's own middle unless the
        // camera is inside.
        plane_depth: 0.5 * (in_view.near.max(view.depth.near) + in_view.far),
        opacity: accumulate.opacity,
        scatter_colour: settings.soft_scatter.scatter_colour,
        scatter_amount: settings.soft_scatter.scatter_amount,
        ambient_colour: settings.soft_scatter.ambient_colour,
        scatter_smooth: settings.soft_scatter.scatter_smooth,
        target_from_ndc: target_from_ndc(&rect, scale, picture),
        target_origin: rect.origin.as_vec2(),
        target_size: rect.size.as_vec2(),
        scale: scale as f32,
        depth_limit: (in_view.far + settings.soft_fade.reach()).min(SKY_VIEW_DEPTH),
        sprite_size: material.sprite_size,
        frame_count: material.frame_count,
        boost: settings.boost,
        fade_scale: settings.soft_fade.fade_scale,
        contrast_power: settings.soft_fade.contrast_power,
        epsilon: settings.soft_fade.epsilon,
        near_fade_start: settings.soft_fade.near_fade_start,
        near_fade_end: settings.soft_fade.near_fade_end,
        diffuse_intensity: settings.diffuse.intensity,
        soft_scatter_intensity: settings.soft_scatter.intensity,
        specular_scatter_size: settings.specular_scatter.size,
        specular_scatter_intensity: settings.specular_scatter.intensity,
        light_count: lights.len() as u32,
        size: settings.sprite.size,
        motion: settings.sprite.motion,
        age_colour: settings.sprite.age_colour,
        detail_lod: material.detail.map_or(0.0, |detail| detail.lod),
        billboard_radius: settings.spherical_billboard.radius,
        billboard_density: settings.spherical_billboard.density,
        density: settings.density.density,
        noise_size: settings.volumetric.noise_size,
        volume_opacity: settings.volumetric.opacity,
        march_steps: settings.volumetric.march_steps,
        noise_octaves: settings.volumetric.noise_octaves,
        noise_scroll: noise_scroll(settings, time),
        fade_through: settings.fade_through(),
        padding: [0.0; 3],
        spherical_harmonics: [Vec4::ZERO; 9],
    };
    if settings.diffuse.mode == DiffuseMode::SphericalHarmonics {
        for light in lights {
            let sample = sample_light(light, uniform.bounds_centre);
            let colour = light.colour * sample.attenuation;
            add_light(&mut uniform.spherical_harmonics, &material.zonal, sample.direction, colour);
        }
    }
    // The front of the box may be hidden by what sprites show through.
    let back_faces = in_view.near <= view.depth.near || uniform.fade_through > 0.0;
    Some(SystemInView { rect, uniform, back_faces })
}

/// Metres that the noise has risen, within one tile of it, so that f32 stays fine after hours.
fn noise_scroll(settings: &Settings, time: f32) -> f32 {
    if settings.sprite.freeze_animation {
        return 0.0;
    }
    let volumetric = &settings.volumetric;
    let risen = f64::from(volumetric.scroll_speed) * f64::from(time);
    risen.rem_euclid(f64::from(volumetric.noise_size)) as f32
}

/// Scale (xy) and offset (zw) from the picture's NDC to the target's.
///
/// A pixel p is at texel p / scale − origin of the target, so in x, with p = (ndc/2 + 1/2)·W and target NDC = 2·t/w − 1:
/// scale = W / (s·w), offset = (W/s − 2·origin) / w − 1. In y, which points up in NDC and down in texels, the offset's
/// sign is the other way round.
fn target_from_ndc(rect: &TargetRect, scale: u32, picture: UVec2) -> Vec4 {
    let texels = picture.as_vec2() / scale as f32;
    let size = rect.size.as_vec2();
    let offset = (texels - 2.0 * rect.origin.as_vec2()) / size - Vec2::ONE;
    Vec4::new(texels.x / size.x, texels.y / size.y, offset.x, -offset.y)
}

/// Brings the lights that reach the box into view space.
pub(crate) fn lights_in_view(view: &ViewGeometry, lights: &[Light], bounds: &Bounds, out: &mut Vec<LightUniform>) {
    out.clear();
    let reaches = |light: &&Light| {
        let nearest = light.position.clamp(bounds.min, bounds.max);
        let lit = light.intensity > 0.0 && light.colour != Vec3::ZERO;
        lit && (light.kind == LightKind::Directional || nearest.distance(light.position) < light.range)
    };
    out.extend(lights.iter().filter(reaches).map(|light| light.uniform(&view.view.view_from_world)));
}
