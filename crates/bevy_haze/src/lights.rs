//! Bevy's lights as haze's.
//!
//! Units: Bevy's extracted point and spot lights are in candela, directional lights in lux, ambient light in cd/m². A white
//! matte surface sends 1/π of its illuminance to the camera; a white texel of a haze ramp sends all of the intensity. Divided
//! by π, smoke is as bright as a white surface beside it. The camera's exposure multiplies all of them, as in Bevy's shaders.

use std::f32::consts::PI;

use bevy::camera::visibility::RenderLayers;
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::ecs::prelude::*;
use bevy::light::{AmbientLight, GlobalAmbientLight};
use bevy::math::Vec3;
use bevy::pbr::{ExtractedDirectionalLight, ExtractedPointLight};
use bevy::transform::components::GlobalTransform;
use haze::settings::Ambient;
use haze::{Light, LightKind, MAX_LIGHTS, glam};

use crate::convert;
use crate::environment::HemisphereLight;

/// Largest coordinate of a light that haze accepts, metres.
pub(crate) const MAX_POSITION: f32 = 1.0e5;
/// Largest intensity of a light that haze accepts.
pub(crate) const MAX_INTENSITY: f32 = 1.0e9;
/// Largest radius of a light that haze accepts, metres.
pub(crate) const MAX_RADIUS: f32 = 1.0e4;
/// Largest ambient light that haze accepts.
const MAX_AMBIENT: f32 = 100.0;
/// Largest half angle of a spot light that haze accepts, degrees, and of its core.
const MAX_ANGLES: [f32; 2] = [89.9, 89.0];

/// A light, and the light that it brings to the smoke.
pub(crate) struct SceneLight {
    pub light: Light,
    /// Entity of the light in the render world.
    pub entity: Entity,
    weight: f32,
}

/// Lights of a view that reach any of the `targets`, brightest first, at most as many as haze takes.
pub(crate) fn scene_lights(
    points: &Query<(Entity, &ExtractedPointLight, Option<&RenderLayers>)>,
    suns: &Query<(Entity, &ExtractedDirectionalLight, Option<&RenderLayers>)>,
    view_layers: &RenderLayers,
    exposure: f32,
    targets: &[Vec3],
) -> Vec<SceneLight> {
    let is_shown = |layers: Option<&RenderLayers>| layers.unwrap_or_default().intersects(view_layers);
    let points = points.iter().filter(|(_, _, layers)| is_shown(*layers)).filter_map(|(entity, point, _)| {
        let light = point_light(point, exposure)?;
        let at = point.transform.translation();
        let nearest = targets.iter().map(|target| target.distance_squared(at)).fold(f32::INFINITY, f32::min);
        Some(SceneLight { light, entity, weight: light.intensity / nearest.max(1.0) })
    });
    let suns = suns.iter().filter(|(_, _, layers)| is_shown(*layers)).filter_map(|(entity, sun, _)| {
        let light = directional_light(sun, exposure)?;
        Some(SceneLight { light, entity, weight: light.intensity })
    });
    let mut lights: Vec<_> = suns.chain(points).collect();
    lights.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.entity.cmp(&b.entity)));
    lights.truncate(MAX_LIGHTS);
    lights
}

fn point_light(point: &ExtractedPointLight, exposure: f32) -> Option<Light> {
    let light = light(&point.transform, point.color, point.intensity * exposure)?;
    let degrees = point.spot_light_angles.map(|(inner, outer)| {
        let outer = outer.to_degrees().clamp(0.0, MAX_ANGLES[0]);
        (inner.to_degrees().clamp(0.0, outer.min(MAX_ANGLES[1])), outer)
    });
    let (kind, (inner_angle, outer_angle)) = match degrees {
        Some(angles) => (LightKind::Spot, angles),
        None => (LightKind::Point, (0.0, 0.0)),
    };
    // A range of 0 lights nothing.
    (point.range > 0.0).then_some(Light {
        kind,
        range: point.range.max(0.01),
        radius: if point.radius.is_finite() { point.radius.clamp(0.0, MAX_RADIUS) } else { 0.0 },
        inner_angle,
        outer_angle,
        ..light
    })
}

fn directional_light(sun: &ExtractedDirectionalLight, exposure: f32) -> Option<Light> {
    let light = light(&sun.transform, sun.color, sun.illuminance * exposure)?;
    Some(Light { kind: LightKind::Directional, position: glam::Vec3::ZERO, ..light })
}

/// Light with an `intensity` in exposed candela or lux. `None` for one that is dark, not finite or too far away.
fn light(transform: &GlobalTransform, color: LinearRgba, intensity: f32) -> Option<Light> {
    let color = color.to_vec3().max(Vec3::ZERO);
    let brightest = color.max_element();
    let intensity = intensity * brightest / PI;
    let position = transform.translation();
    let direction = Vec3::from(transform.forward());
    let is_near = position.is_finite() && position.abs().max_element() <= MAX_POSITION;
    if !(intensity > 0.0 && intensity.is_finite() && is_near && direction.is_finite()) {
        return None;
    }
    Some(Light {
        position: convert::vec3(position),
        direction: convert::vec3(direction),
        color: convert::vec3(color / brightest),
        intensity: intensity.min(MAX_INTENSITY),
        ..Light::default()
    })
}

/// Ambient light of a view, that of its camera or the global one, cd/m².
pub(crate) fn ambient_light(own: Option<&AmbientLight>, global: &GlobalAmbientLight) -> Vec3 {
    let (color, brightness): (Color, f32) = match own {
        Some(own) => (own.color, own.brightness),
        None => (global.color, global.brightness),
    };
    let light = color.to_linear().to_vec3() * brightness;
    if light.is_finite() { light.max(Vec3::ZERO) } else { Vec3::ZERO }
}

/// Exposed light of both hemispheres as haze takes it.
pub(crate) fn haze_ambient(light: HemisphereLight) -> Ambient {
    let color = |light: Vec3| {
        let light = if light.is_finite() { light } else { Vec3::ZERO };
        convert::vec3(light.clamp(Vec3::ZERO, Vec3::splat(MAX_AMBIENT)))
    };
    let sky_color = color(light.sky);
    let ground_color = color(light.ground);
    let is_dark = sky_color == glam::Vec3::ZERO && ground_color == glam::Vec3::ZERO;
    Ambient { intensity: if is_dark { 0.0 } else { 1.0 }, sky_color, ground_color }
}
