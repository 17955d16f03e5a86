//! Cameras and lights of a glTF file in haze's terms.

use glam::{Affine3A, Mat3, UVec2, Vec3};
use gltf::khr_lights_punctual::Kind;
use haze_core::frame::{FOV_RANGE, Light, LightKind};
use haze_preset::Camera;

use super::file_limits::MAX_DISTANCE;

/// Luminous efficacy by which Blender and others export watts as lumens, lm/W.
const LUMENS_PER_WATT: f32 = 683.0;

/// Camera in haze's terms; its target lies one metre ahead. `None` if it is not a perspective camera.
pub fn camera_of(camera: &gltf::Camera<'_>, world: &Affine3A) -> Option<Camera> {
    let gltf::camera::Projection::Perspective(perspective) = camera.projection() else { return None };
    let position: Vec3 = world.translation.into();
    let forward = world.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z);
    let near = perspective.znear().clamp(0.001, 100.0);
    Some(Camera {
        position: position.clamp(Vec3::splat(-MAX_DISTANCE), Vec3::splat(MAX_DISTANCE)),
        target: position + forward,
        fov: perspective.yfov().to_degrees().clamp(*FOV_RANGE.start(), *FOV_RANGE.end()),
        near,
        far: perspective.zfar().unwrap_or(Camera::default().far).clamp(near * 1.01, 1.0e5),
        ..Camera::default()
    })
}

/// Light in haze's unit: candela or lux, divided by π, and by the factor by which exporters turn watts into lumens. A white
/// matte surface is then as bright as in Blender at exposure 0.
pub fn light_of(light: &gltf::khr_lights_punctual::Light<'_>, world: &Affine3A) -> Light {
    let (kind, inner, outer) = match light.kind() {
        Kind::Directional => (LightKind::Directional, 0.0, 0.0),
        Kind::Point => (LightKind::Point, 0.0, 0.0),
        Kind::Spot { inner_cone_angle, outer_cone_angle } => (LightKind::Spot, inner_cone_angle, outer_cone_angle),
    };
    let finite = |value: f32| if value.is_finite() { value.max(0.0) } else { 0.0 };
    let intensity = finite(light.intensity() / (LUMENS_PER_WATT * std::f32::consts::PI)).min(1.0e9);
    // The distance at which it has faded to what no image shows.
    let seen = (intensity / 1.0e-3).sqrt().clamp(5.0, 1.0e3);
    let mut found = Light {
        kind,
        position: Vec3::from(world.translation).clamp(Vec3::splat(-MAX_DISTANCE), Vec3::splat(MAX_DISTANCE)),
        direction: world.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Y),
        color: Vec3::from(light.color().map(finite)).min(Vec3::splat(100.0)),
        intensity,
        range: light.range().filter(|range| *range > 0.01).unwrap_or(seen),
        ..Light::default()
    };
    if kind == LightKind::Spot {
        found.outer_angle = finite(outer.to_degrees()).clamp(0.1, 89.9);
        found.inner_angle = finite(inner.to_degrees()).min(found.outer_angle).min(89.0);
    }
    found
}

/// Angle by which the image of a camera is turned against the one that haze shows, radians. Positive if its right side is down.
pub fn roll_of(camera: &Camera, world: &Affine3A) -> f32 {
    let level = Mat3::from_mat4(camera.view(UVec2::ONE).view_from_world).transpose();
    let right = world.transform_vector3(Vec3::X);
    (-right.dot(level.y_axis)).atan2(right.dot(level.x_axis))
}
