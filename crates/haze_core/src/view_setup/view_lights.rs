//! Lights in view space.

use glam::Vec3;

use super::smoke_shadow::SmokeShadow;
use super::view_geometry::ViewGeometry;
use crate::formula::uniforms::LightUniform;
use crate::frame::{Bounds, Light, LightKind};

/// Writes all lights of a frame to `out`, in view space and in its order, as they light the scene.
pub fn scene_light_uniforms(view: &ViewGeometry, lights: &[Light], shadow: &SmokeShadow, out: &mut Vec<LightUniform>) {
    let uniform = |(index, light): (usize, &Light)| {
        let shadow_slot = shadow.slot(index, shadow.light_blocks);
        LightUniform { shadow_slot, ..light.uniform(&view.view_from_world) }
    };
    out.clear();
    out.extend(lights.iter().enumerate().map(uniform));
}

/// Writes the lights that reach the bounding box to `out`, in view space. `exposure` multiplies their colors. `shadow`:
/// that of the frame, and the number of blocks of its lights that shade the system.
pub fn light_uniforms(
    view: &ViewGeometry,
    lights: &[Light],
    exposure: f32,
    bounds: &Bounds,
    shadow: Option<(&SmokeShadow, u32)>,
    out: &mut Vec<LightUniform>,
) {
    out.clear();
    let reaches = |(_, light): &(usize, &Light)| {
        let nearest = light.position.clamp(bounds.min, bounds.max);
        let lit = light.intensity > 0.0 && light.color != Vec3::ZERO;
        lit && (light.kind == LightKind::Directional || nearest.distance(light.position) < light.range)
    };
    out.extend(lights.iter().enumerate().filter(reaches).map(|(index, light)| {
        let uniform = light.uniform(&view.view_from_world);
        let shadow_slot = shadow.map_or(0.0, |(shadow, blocks)| shadow.slot(index, blocks));
        LightUniform { color: uniform.color * exposure, shadow_slot, ..uniform }
    }));
}
