//! Gradients: stops and the interpolation between them.

use glam::Vec3;
use haze_core::error::FieldError;
use haze_core::settings::{FieldVisitor, Fields, choice};

use super::blend_space::{Blend, HexColor, oklab_from_linear};

choice! {
    /// Interpolation from one stop to the next, or from one row to the next.
    Curve {
        /// Smooth cubic that never overshoots the stops. Its slope is continuous, so lighting shows no bands.
        #[default]
        Monotone = "monotone",
        /// Linear.
        Linear = "linear",
        /// Smoothstep: flat at both ends.
        Ease = "ease",
        /// The stop's color up to the next stop, with a hard edge there.
        Constant = "constant",
    }
}

impl Curve {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// One gradient.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampRow {
    /// Position on the second axis, 0 to 1. Rows are sorted by it. Of several rows at one position, the first ends the
    /// range below and the last begins the range above.
    #[serde(default)]
    pub at: f32,
    /// Interpolation to the next row.
    #[serde(default, skip_serializing_if = "Curve::is_default")]
    pub curve: Curve,
    /// Stops of the gradient, at least one.
    pub stops: Vec<RampStop>,
}

/// One color of a gradient.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampStop {
    /// Position on the first axis, 0 to 1. Stops are sorted by it; stops at one position keep the order of the list.
    /// The first stop ends the gradient below, the last begins the gradient above.
    pub at: f32,
    /// sRGB, `#rrggbb`.
    pub color: HexColor,
    /// Interpolation to the next stop.
    #[serde(default, skip_serializing_if = "Curve::is_default")]
    pub curve: Curve,
}

impl RampStop {
    /// Creates a stop with the default curve.
    pub fn new(at: f32, color: HexColor) -> Self {
        Self { at, color, curve: Curve::default() }
    }
}

impl Fields for RampRow {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("at", &mut self.at, 0.0..=1.0, "");
        visitor.choice("curve", &mut self.curve);
        for (index, stop) in self.stops.iter_mut().enumerate() {
            visitor.item("stops", index, stop);
        }
    }
}

impl Fields for RampStop {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("at", &mut self.at, 0.0..=1.0, "");
        visitor.srgb("color", &mut self.color.0);
        visitor.choice("curve", &mut self.curve);
    }
}

/// Adds a stop to sorted ones, with the curve of the previous one. Returns its index.
pub fn add_stop(stops: &mut Vec<RampStop>, at: f32, color: HexColor) -> usize {
    let index = stops.partition_point(|stop| stop.at <= at);
    let neighbour = stops.get(index.saturating_sub(1));
    let curve = neighbour.map_or(Curve::default(), |stop| stop.curve);
    stops.insert(index, RampStop { at, color, curve });
    index
}

/// Returns an error for an empty list.
pub fn check_not_empty<T>(field: impl Into<String>, list: &[T]) -> Result<(), FieldError> {
    if list.is_empty() {
        Err(FieldError::from_problem(field, "the list is empty", "at least one entry"))
    } else {
        Ok(())
    }
}

/// Rows prepared for sampling: sorted, with colors converted to the blend space.
#[derive(Clone, Debug)]
pub(super) struct PreparedRows {
    blend: Blend,
    rows: Vec<(ControlPoint, Vec<ControlPoint>)>,
}

/// A control point of a curve.
#[derive(Clone, Copy, Debug, Default)]
struct ControlPoint {
    at: f32,
    value: Vec3,
    curve: Curve,
}

impl PreparedRows {
    /// Sorts and converts rows whose positions are 0 to 1.
    pub fn new(blend: Blend, rows: &[RampRow]) -> Self {
        let mut rows: Vec<_> =
            rows.iter().map(|row| (ControlPoint::new(row.at, row.curve), points(blend, &row.stops))).collect();
        rows.sort_by(|(a, _), (b, _)| a.at.total_cmp(&b.at));
        Self { blend, rows }
    }

    /// Returns linear RGB, at least 0.
    pub fn sample(&self, u: f32, v: f32) -> Vec3 {
        // The curve between two rows needs one more row on either side.
        let next = self.rows.partition_point(|(row, _)| row.at <= v);
        let near = &self.rows[next.saturating_sub(2)..self.rows.len().min(next + 2)];
        // Hues of two rows may diverge along u, so the shorter arc between them could flip; blend rows in Oklab.
        let in_oklab = self.blend.has_hue() && self.rows.len() > 1;
        let mut points = [ControlPoint::default(); 4];
        for (point, (row, stops)) in points.iter_mut().zip(near) {
            let value = value_at(stops, u);
            let value = if in_oklab { oklab_from_linear(self.blend.linear(value)) } else { value };
            *point = ControlPoint { value, ..*row };
        }
        let blend = if in_oklab { Blend::Oklab } else { self.blend };
        blend.linear(value_at(&points[..near.len()], v))
    }
}

impl ControlPoint {
    fn new(at: f32, curve: Curve) -> Self {
        // Turns -0 into 0: `total_cmp` tells them apart.
        Self { at: at + 0.0, value: Vec3::ZERO, curve }
    }
}

fn points(blend: Blend, stops: &[RampStop]) -> Vec<ControlPoint> {
    let point =
        |stop: &RampStop| ControlPoint { value: blend.of(stop.color), ..ControlPoint::new(stop.at, stop.curve) };
    let mut points: Vec<_> = stops.iter().map(point).collect();
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    if blend.has_hue() {
        unwrap_hues(&mut points, blend == Blend::HsvFar);
    }
    points
}

/// Unwraps hues so that each is reached from the previous one along the shorter or longer arc. A gray takes the hue of
/// the previous color, or of the first color with a hue; black takes its saturation too.
fn unwrap_hues(points: &mut [ControlPoint], far: bool) {
    let has_hue = |point: &&ControlPoint| point.value.y > 0.0 && point.value.z > 0.0;
    let mut last = points.iter().find(has_hue).map_or(Vec3::ZERO, |point| point.value);
    for ControlPoint { value, .. } in points {
        if value.z <= 0.0 {
            value.x = last.x;
            value.y = last.y;
        } else if value.y <= 0.0 {
            value.x = last.x;
        } else {
            let near = value.x - last.x - (value.x - last.x).round();
            let step = match () {
                () if far && near > 0.0 => near - 1.0,
                () if far && near < 0.0 => near + 1.0,
                () => near,
            };
            value.x = last.x + step;
        }
        last = *value;
    }
}

/// Returns the value at a position. Constant outside the points.
fn value_at(points: &[ControlPoint], x: f32) -> Vec3 {
    let next = points.partition_point(|point| point.at <= x);
    let (Some(from), Some(to)) = (points.get(next.wrapping_sub(1)), points.get(next)) else {
        let end = if next == 0 { points.first() } else { points.last() };
        return end.map_or(Vec3::ZERO, |end| end.value);
    };
    let h = to.at - from.at;
    let t = (x - from.at) / h;
    match from.curve {
        Curve::Constant => from.value,
        Curve::Linear => from.value * (1.0 - t) + to.value * t,
        Curve::Ease => {
            let eased = t * t * (3.0 - 2.0 * t);
            from.value * (1.0 - eased) + to.value * eased
        }
        Curve::Monotone => {
            let t2 = t * t;
            let t3 = t * t * t;
            from.value * (2.0 * t3 - 3.0 * t2 + 1.0)
                + to.value * (3.0 * t2 - 2.0 * t3)
                + tangent(points, next - 1) * (h * (t3 - 2.0 * t2 + t))
                + tangent(points, next) * (h * (t3 - t2))
        }
    }
}

/// Returns the slope at a point of a monotone cubic: the harmonic mean of the secants. (Fritsch and Carlson, "Monotone
/// piecewise cubic interpolation", 1980)
fn tangent(points: &[ControlPoint], at: usize) -> Vec3 {
    let secant = |from: usize, to: usize| {
        let from = points.get(from)?;
        let to = points.get(to)?;
        let is_edge = from.curve == Curve::Constant || to.at <= from.at;
        // Limits the slope: no image can show a steeper one, and products of slopes must not overflow.
        (!is_edge).then(|| (to.value - from.value) / (to.at - from.at).max(1.0e-6))
    };
    match (secant(at.wrapping_sub(1), at), secant(at, at + 1)) {
        (Some(before), Some(after)) => {
            let harmonic = |a: f32, b: f32| if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
            Vec3::new(harmonic(before.x, after.x), harmonic(before.y, after.y), harmonic(before.z, after.z))
        }
        // Slope 0 at the ends of the ramp and at edges, since the value is constant beyond them.
        _ => Vec3::ZERO,
    }
}
