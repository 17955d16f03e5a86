//! Handles of the selected light. The same shapes are drawn and hit-tested.

use eframe::egui::{Pos2, Vec2, vec2};
use glam::Vec3;
use haze::{Light, LightKind};

use super::light_marker::light_position;
use super::screen_projection::ScreenProjection;

/// Property that a handle changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// Position along the axis of this index.
    Axis(usize),
    /// Position in the plane perpendicular to the axis of this index.
    Plane(usize),
    /// Position in the plane that faces the camera.
    Center,
    Radius,
    InnerAngle,
    OuterAngle,
    /// Direction of the light.
    Aim,
}

/// Shape of a handle in the window.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Arrow([Pos2; 2]),
    Quad([Pos2; 4]),
    Square(Pos2),
    Knob(Pos2),
}

/// Lengths in points: start and end of an axis arrow, sides of a plane handle, half the side of the center square.
const AXIS: [f32; 2] = [14.0, 80.0];
const PLANE: [f32; 2] = [24.0, 40.0];
pub const SQUARE: f32 = 9.0;
/// Least distance of the radius handle from the center, points.
const RADIUS: f32 = 26.0;
/// Length of a spot's cone, points.
const CONE: f32 = 150.0;
/// Largest distance from a handle at which the pointer hits it, points.
const GRAB: f32 = 7.0;
/// Least length of an axis, and least width of a plane, as seen from the camera, relative to their full size. Thinner
/// handles are hidden.
const SLIM: f32 = 0.2;

pub const UNITS: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

/// Returns the handles of a light. Later ones are drawn on top and hit first.
pub fn handles(light: &Light, projection: &ScreenProjection) -> Vec<(Handle, Shape)> {
    let mut all = Vec::new();
    let Some(middle) = projection.project(light_position(light, projection)) else { return all };
    if light.kind == LightKind::Directional {
        return vec![(Handle::Aim, Shape::Knob(middle))];
    }
    let at = light.position;
    let metre = projection.metres_per_point(light.position);
    let view = (at - projection.eye).normalize_or(projection.ahead);
    for (axis, unit) in UNITS.into_iter().enumerate() {
        let reach = |length: f32| projection.project(at + unit * (length * metre));
        if let (Some(from), Some(to)) = (reach(AXIS[0]), reach(AXIS[1]))
            && unit.cross(view).length() > SLIM
        {
            all.push((Handle::Axis(axis), Shape::Arrow([from, to])));
        }
    }
    for (axis, unit) in UNITS.into_iter().enumerate() {
        let u = UNITS[(axis + 1) % 3];
        let v = UNITS[(axis + 2) % 3];
        let corner = |a: usize, b: usize| projection.project(at + (u * PLANE[a] + v * PLANE[b]) * metre);
        if let (Some(a), Some(b), Some(c), Some(d)) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1))
            && unit.dot(view).abs() > SLIM
        {
            all.push((Handle::Plane(axis), Shape::Quad([a, b, c, d])));
        }
    }
    if light.kind == LightKind::Spot {
        let cone = Cone::new(light, projection);
        let mut knob =
            |handle, position: Vec3| all.extend(projection.project(position).map(|at| (handle, Shape::Knob(at))));
        knob(Handle::OuterAngle, cone.rim(light.outer_angle, cone.side));
        knob(Handle::InnerAngle, cone.rim(light.inner_angle, -cone.side));
        knob(Handle::Aim, cone.rim(0.0, cone.side));
    }
    let radius = (light.radius / metre).max(RADIUS);
    all.push((Handle::Radius, Shape::Knob(middle + radius * RADIUS_WAY)));
    all.push((Handle::Center, Shape::Square(middle)));
    all
}

/// Direction of the radius handle on its ring, where it rarely overlaps an axis.
const RADIUS_WAY: Vec2 = vec2(-std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2);

/// Returns the handle under the pointer.
pub fn hovered(handles: &[(Handle, Shape)], at: Pos2) -> Option<Handle> {
    handles.iter().rev().find(|(_, shape)| shape.is_under(at)).map(|(handle, _)| *handle)
}

impl Shape {
    fn is_under(&self, at: Pos2) -> bool {
        match *self {
            Self::Arrow([from, to]) => {
                let along = to - from;
                let fraction = ((at - from).dot(along) / along.length_sq().max(1.0e-6)).clamp(0.0, 1.1);
                (from + along * fraction).distance(at) <= GRAB
            }
            Self::Quad(corners) => {
                let turn = |i: usize| {
                    let from = corners[i];
                    let to = corners[(i + 1) % 4];
                    (to - from).rot90().dot(at - from) > 0.0
                };
                (1..4).all(|i| turn(i) == turn(0))
            }
            Self::Square(center) => (at - center).abs().max_elem() <= SQUARE + 1.0,
            Self::Knob(center) => center.distance(at) <= GRAB + 1.0,
        }
    }
}

/// Cone of a spot as it is drawn: of constant size in the window, independent of its range.
pub struct Cone {
    at: Vec3,
    pub way: Vec3,
    /// Unit vector perpendicular to the axis, across the view direction.
    pub side: Vec3,
    /// Length of the cone, metres.
    pub length: f32,
}

impl Cone {
    pub fn new(light: &Light, projection: &ScreenProjection) -> Self {
        let way = light.direction.normalize_or(Vec3::NEG_Y);
        let view = (light.position - projection.eye).normalize_or(projection.ahead);
        let side = way.cross(view).normalize_or(projection.right);
        Self { at: light.position, way, side, length: CONE * projection.metres_per_point(light.position) }
    }

    /// Returns a point on the cone's end, at an angle from its axis towards a side.
    pub fn rim(&self, degrees: f32, side: Vec3) -> Vec3 {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        self.at + (self.way * cosine + side * sine) * self.length
    }

    /// Returns the angle between the axis and the point under a position in the window, degrees.
    pub fn angle(&self, projection: &ScreenProjection, at: Pos2) -> Option<f32> {
        let ray = projection.ray(at);
        let normal = self.way.cross(self.side);
        // Seen along the axis, the plane through the sides is edge-on, so the plane across the end is used.
        let is_edge_on = normal.dot(ray.direction).abs() < 0.3;
        let (point, normal) = if is_edge_on { (self.at + self.way * self.length, self.way) } else { (self.at, normal) };
        let offset = ray.on_plane(point, normal)? - self.at;
        let along = offset.dot(self.way);
        Some((offset - self.way * along).length().atan2(along).to_degrees())
    }
}
