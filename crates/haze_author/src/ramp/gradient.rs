//! Gradients: stops, and the curves between them.

use glam::Vec3;

use super::colour::{Blend, HexColour, oklab_from_linear};
use haze::error::FieldError;
use haze::settings::{FieldVisitor, Fields, choice};

choice! {
    /// How a gradient goes on from one stop to the next, or from one row to the next.
    Curve {
        /// Smooth through its neighbours, never beyond them: no crease that light would show as a band.
        #[default]
        Monotone = "monotone",
        /// Straight.
        Linear = "linear",
        /// Flat at both ends.
        Ease = "ease",
        /// The stop's own colour up to the next one: a hard edge there.
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
    /// Place on the second axis, 0 to 1. Rows are sorted by it; of those at one place the first is the end of what is below.
    #[serde(default)]
    pub at: f32,
    /// How the colours go on to the next row.
    #[serde(default, skip_serializing_if = "Curve::is_default")]
    pub curve: Curve,
    /// The gradient's colours, from 0 to 1, at least one.
    pub stops: Vec<RampStop>,
}

/// One colour of a gradient.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RampStop {
    /// Place on the first axis, 0 to 1. Stops are sorted by it, those at one place in the order of the list: the first is what
    /// the gradient comes to from below, the last what it goes on from.
    pub at: f32,
    /// sRGB, `#rrggbb`.
    pub colour: HexColour,
    /// How the gradient goes on to the next stop.
    #[serde(default, skip_serializing_if = "Curve::is_default")]
    pub curve: Curve,
}

impl RampStop {
    /// A stop that goes on by the usual curve.
    pub fn new(at: f32, colour: HexColour) -> Self {
        Self { at, colour, curve: Curve::default() }
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
        visitor.srgb("colour", &mut self.colour.0);
        visitor.choice("curve", &mut self.curve);
    }
}

/// Refuses a list without an entry.
pub fn not_empty<T>(field: impl Into<String>, list: &[T]) -> Result<(), FieldError> {
    if list.is_empty() { Err(FieldError::new(field, "[]", "at least one entry")) } else { Ok(()) }
}

/// Rows made ready to be asked for many texels: sorted, their colours as numbers of the space they are blended in.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    blend: Blend,
    rows: Vec<(Point, Vec<Point>)>,
}

/// A value on a curve.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    at: f32,
    value: Vec3,
    curve: Curve,
}

impl Rows {
    /// For places from 0 to 1.
    pub fn new(blend: Blend, rows: &[RampRow]) -> Self {
        let mut rows: Vec<_> =
            rows.iter().map(|row| (Point::new(row.at, row.curve), points(blend, &row.stops))).collect();
        rows.sort_by(|(a, _), (b, _)| a.at.total_cmp(&b.at));
        Self { blend, rows }
    }

    /// Linear RGB, not below 0.
    pub fn sample(&self, u: f32, v: f32) -> Vec3 {
        // The curve between two rows looks at one row more on either side.
        let next = self.rows.partition_point(|(row, _)| row.at <= v);
        let near = &self.rows[next.saturating_sub(2)..self.rows.len().min(next + 2)];
        // Hues of two rows may part anywhere, and with them the shorter way from one to the other.
        let in_oklab = self.blend.has_hue() && self.rows.len() > 1;
        let mut points = [Point::default(); 4];
        for (point, (row, stops)) in points.iter_mut().zip(near) {
            let value = value_at(stops, u);
            let value = if in_oklab { oklab_from_linear(self.blend.linear(value)) } else { value };
            *point = Point { value, ..*row };
        }
        let blend = if in_oklab { Blend::Oklab } else { self.blend };
        blend.linear(value_at(&points[..near.len()], v))
    }
}

impl Point {
    fn new(at: f32, curve: Curve) -> Self {
        // -0 and 0 are one place.
        Self { at: at + 0.0, value: Vec3::ZERO, curve }
    }
}

fn points(blend: Blend, stops: &[RampStop]) -> Vec<Point> {
    let point = |stop: &RampStop| Point { value: blend.of(stop.colour), ..Point::new(stop.at, stop.curve) };
    let mut points: Vec<_> = stops.iter().map(point).collect();
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    if blend.has_hue() {
        unwind(&mut points, blend == Blend::HsvFar);
    }
    points
}

/// Turns hues so that each is reached from the one before, the short or the long way. Greys take the hue of the colour before,
/// or of the first that has one; black its saturation too.
fn unwind(points: &mut [Point], far: bool) {
    let has_hue = |point: &&Point| point.value.y > 0.0 && point.value.z > 0.0;
    let mut last = points.iter().find(has_hue).map_or(Vec3::ZERO, |point| point.value);
    for Point { value, .. } in points {
        if value.z <= 0.0 {
            (value.x, value.y) = (last.x, last.y);
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

/// The value at a place; constant outside.
fn value_at(points: &[Point], x: f32) -> Vec3 {
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
            let (t2, t3) = (t * t, t * t * t);
            from.value * (2.0 * t3 - 3.0 * t2 + 1.0)
                + to.value * (3.0 * t2 - 2.0 * t3)
                + tangent(points, next - 1) * (h * (t3 - 2.0 * t2 + t))
                + tangent(points, next) * (h * (t3 - t2))
        }
    }
}

/// Slope at a point of a cubic that never overshoots its points. (Fritsch and Carlson, "Monotone piecewise cubic
/// interpolation", 1980, with the harmonic mean of the slopes)
fn tangent(points: &[Point], at: usize) -> Vec3 {
    let secant = |from: usize, to: usize| {
        let (from, to) = (points.get(from)?, points.get(to)?);
        let is_edge = from.curve == Curve::Constant || to.at <= from.at;
        // Steeper than this no picture can show, and products of slopes stay far from overflow.
        (!is_edge).then(|| (to.value - from.value) / (to.at - from.at).max(1.0e-6))
    };
    match (secant(at.wrapping_sub(1), at), secant(at, at + 1)) {
        (Some(before), Some(after)) => {
            let harmonic = |a: f32, b: f32| if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
            Vec3::new(harmonic(before.x, after.x), harmonic(before.y, after.y), harmonic(before.z, after.z))
        }
        // Flat ends, of the ramp and at edges: it is held constant beyond them.
        _ => Vec3::ZERO,
    }
}
