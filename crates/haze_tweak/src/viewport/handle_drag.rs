//! Drag of a handle.

use eframe::egui::{Modifiers, Pos2, Vec2};
use glam::Vec3;
use haze::{Light, LightKind};

use super::light_handle::{Cone, Handle, UNITS};
use super::light_marker::light_position;
use super::screen_projection::ScreenProjection;
use haze_author::light_angles::{Angles, from_angles, to_angles};

/// Steps of snapping with Ctrl, in metres and in degrees.
const SNAP_METRES: f32 = 0.1;
const SNAP_DEGREES: f32 = 5.0;
/// Factor on the pointer's movement while Shift is held.
const SLOW_FACTOR: f32 = 0.1;

/// Drag of a handle.
pub struct HandleDrag {
    pub index: usize,
    pub handle: Handle,
    /// Light before the drag.
    pub before: Light,
    /// Light after the last frame of the drag. If the preset has another value, the light was changed by other means.
    pub left: Light,
    /// Start and end of the movement that counts, which Shift makes slower than the pointer's.
    start: Pos2,
    at: Pos2,
    pointer: Pos2,
    /// For a direction: its handle is on the near side of the sphere. Crossing the rim switches sides.
    is_before: bool,
    is_outside: bool,
}

impl HandleDrag {
    pub fn new(index: usize, handle: Handle, light: Light, projection: &ScreenProjection, pointer: Pos2) -> Self {
        let (center, _) = sphere(&light, projection);
        let aimed = if light.kind == LightKind::Directional { -light.direction } else { light.direction };
        Self {
            index,
            handle,
            before: light,
            left: light,
            start: pointer,
            at: pointer,
            pointer,
            is_before: aimed.dot(center - projection.eye) < 0.0,
            is_outside: false,
        }
    }

    /// Returns the light for a position of the pointer.
    pub fn drag(&mut self, projection: &ScreenProjection, pointer: Pos2, held: Modifiers) -> Light {
        self.at += (pointer - self.pointer) * if held.shift { SLOW_FACTOR } else { 1.0 };
        self.pointer = pointer;
        let snap = |value: f32, step: f32| if held.command { (value / step).round() * step } else { value };
        let mut light = self.before;
        match self.handle {
            Handle::Axis(axis) => {
                let metres = |at| projection.ray(at).along_axis(light.position, UNITS[axis]);
                if let (Some(from), Some(to)) = (metres(self.start), metres(self.at)) {
                    light.position[axis] = snap(light.position[axis] + to - from, SNAP_METRES);
                }
            }
            Handle::Plane(axis) => {
                if let Some(by) = self.moved(projection, UNITS[axis]) {
                    for other in [(axis + 1) % 3, (axis + 2) % 3] {
                        light.position[other] = snap(light.position[other] + by[other], SNAP_METRES);
                    }
                }
            }
            Handle::Center => {
                if let Some(by) = self.moved(projection, projection.ahead) {
                    light.position = Vec3::from((light.position + by).to_array().map(|axis| snap(axis, SNAP_METRES)));
                }
            }
            Handle::Radius => {
                let metres = |at| projection.unproject_to_facing_plane(at, light.position).distance(light.position);
                light.radius = snap(light.radius + metres(self.at) - metres(self.start), SNAP_METRES).clamp(0.0, 1.0e4);
            }
            Handle::InnerAngle => {
                light.inner_angle = snap(light.inner_angle + self.turned(projection), SNAP_DEGREES).clamp(0.0, 89.0);
                light.outer_angle = light.outer_angle.max(light.inner_angle);
            }
            Handle::OuterAngle => {
                light.outer_angle = snap(light.outer_angle + self.turned(projection), SNAP_DEGREES).clamp(0.0, 89.9);
                light.inner_angle = light.inner_angle.min(light.outer_angle);
            }
            Handle::Aim => {
                let Angles { azimuth, elevation } = to_angles(self.aim(projection));
                light.direction = match held.command {
                    true => from_angles(Angles {
                        azimuth: snap(azimuth, SNAP_DEGREES),
                        elevation: snap(elevation, SNAP_DEGREES),
                    }),
                    false => self.aim(projection),
                };
            }
        }
        let is_good = light.position.is_finite() && light.position.abs().max_element() <= 1.0e5;
        self.left = if is_good { light } else { self.left };
        self.left
    }

    /// Returns the movement in the plane through the light, metres.
    fn moved(&self, projection: &ScreenProjection, normal: Vec3) -> Option<Vec3> {
        let met = |at| projection.ray(at).on_plane(self.before.position, normal);
        Some(met(self.at)? - met(self.start)?)
    }

    /// Returns the change of the angle from the cone's axis, degrees.
    fn turned(&self, projection: &ScreenProjection) -> f32 {
        let cone = Cone::new(&self.before, projection);
        let from_to = cone.angle(projection, self.start).zip(cone.angle(projection, self.at));
        from_to.map_or(0.0, |(from, to)| to - from)
    }

    /// Returns the direction of the light for the present position of its handle.
    fn aim(&mut self, projection: &ScreenProjection) -> Vec3 {
        let (center, radius) = sphere(&self.before, projection);
        let is_sun = self.before.kind == LightKind::Directional;
        let way = self.before.direction.normalize_or(Vec3::NEG_Y);
        let handle = if is_sun { light_position(&self.before, projection) } else { center + way * radius };
        let offset = projection.project(handle).map_or(Vec2::ZERO, |handle| handle - self.start);
        let ray = projection.ray(self.at + offset);
        let is_outside = ray.passes(center, radius);
        if self.is_outside && !is_outside {
            self.is_before = !self.is_before;
        }
        self.is_outside = is_outside;
        let way = (ray.on_sphere(center, radius, self.is_before) - center).normalize_or(way);
        if is_sun { -way } else { way }
    }
}

/// Returns center and radius of the sphere on which the direction's handle moves.
fn sphere(light: &Light, projection: &ScreenProjection) -> (Vec3, f32) {
    match light.kind {
        LightKind::Directional => projection.sun_sphere,
        _ => (light.position, Cone::new(light, projection).length),
    }
}
