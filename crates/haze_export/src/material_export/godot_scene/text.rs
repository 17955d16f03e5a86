//! Text of Godot's scenes.

use std::fmt::{Display, Write as _};

use glam::{Vec2, Vec3, Vec4};

/// Lines `name = value` of a resource or node.
#[derive(Default)]
pub struct Properties(pub String);

impl Properties {
    pub fn add(&mut self, name: &str, value: impl Display) {
        // Writing to a string does not fail.
        let _ = writeln!(self.0, "{name} = {value}");
    }

    pub fn number(&mut self, name: &str, value: f32) {
        self.add(name, format_args!("{value:?}"));
    }

    pub fn vector(&mut self, name: &str, v: Vec3) {
        self.add(name, format_args!("Vector3({:?}, {:?}, {:?})", v.x, v.y, v.z));
    }

    /// Least and largest of the random values of a particle.
    pub fn range(&mut self, name: &str, min: f32, max: f32) {
        self.number(&format!("{name}_min"), min);
        self.number(&format!("{name}_max"), max);
    }
}

pub fn sub_resource(kind: &str, id: &str, properties: &Properties) -> String {
    format!("\n[sub_resource type=\"{kind}\" id=\"{id}\"]\n{}", properties.0)
}

/// Number of ages at which a curve is computed before points that lie on straight lines are left out.
const AGES: usize = 256;
/// Most that a curve of fewer points is off, as a fraction of its range.
const CURVE_ERROR: f32 = 5.0e-3;

/// Points (age, value) with straight lines between them, as few as show a curve. `value`: of an age, 0 to 1.
fn curve_points(value: impl Fn(f32) -> f32) -> Vec<Vec2> {
    // Closer at the beginning: a square root is steep there.
    let all: Vec<Vec2> = (0..=AGES)
        .map(|index| {
            let age = (index as f32 / AGES as f32).powi(2);
            Vec2::new(age, value(age))
        })
        .collect();
    let range = all.iter().fold(0.0_f32, |range, point| range.max(point.y.abs()));
    // Splits at the point that is furthest from the line, until none is off. (Ramer, Douglas, Peucker)
    let mut is_kept = vec![false; all.len()];
    is_kept[0] = true;
    is_kept[AGES] = true;
    let mut open = vec![(0, AGES)];
    while let Some((first, last)) = open.pop() {
        let off = |index: &usize| {
            let fraction = (all[*index].x - all[first].x) / (all[last].x - all[first].x);
            (all[*index].y - all[first].y - (all[last].y - all[first].y) * fraction).abs()
        };
        let furthest = (first + 1..last).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(index) = furthest.filter(|index| off(index) > CURVE_ERROR * range) {
            is_kept[index] = true;
            open.extend([(first, index), (index, last)]);
        }
    }
    all.into_iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(point, _)| point).collect()
}

/// Curve over the life of a particle.
fn curve(id: &str, value: impl Fn(f32) -> f32) -> String {
    let points = curve_points(value);
    let slope = |from: usize, to: usize| {
        points.get(from).zip(points.get(to)).map_or(0.0, |(from, to)| (to.y - from.y) / (to.x - from.x))
    };
    // Position, slopes on both sides, and 1 for straight lines.
    let data: Vec<_> = (0..points.len())
        .map(|index| {
            let Vec2 { x, y } = points[index];
            let before = index.checked_sub(1).map_or(0.0, |before| slope(before, index));
            format!("Vector2({x:?}, {y:?}), {before:?}, {:?}, 1, 1", slope(index, index + 1))
        })
        .collect();
    let (low, high) =
        points.iter().fold((0.0_f32, 1.0_f32), |(low, high), point| (low.min(point.y), high.max(point.y)));
    let mut properties = Properties::default();
    properties.add("_limits", format_args!("[{low:?}, {high:?}, 0.0, 1.0]"));
    properties.add("_data", format_args!("[{}]", data.join(", ")));
    properties.add("point_count", points.len());
    sub_resource("Curve", id, &properties)
}

/// Texture `<name>_texture` of a curve over the life of a particle.
pub fn curve_texture(name: &str, value: impl Fn(f32) -> f32) -> String {
    let id = format!("{name}_curve");
    let mut texture = Properties::default();
    texture.add("curve", format_args!("SubResource(\"{id}\")"));
    curve(&id, value) + &sub_resource("CurveTexture", &format!("{name}_texture"), &texture)
}

/// Texture `<name>_texture` of a vector over the life of a particle.
pub fn vector_curve_texture(name: &str, value: impl Fn(f32) -> Vec3) -> String {
    let axes = ["x", "y", "z"];
    let mut texture = Properties::default();
    let mut text = String::new();
    for (index, axis) in axes.into_iter().enumerate() {
        let id = format!("{name}_{axis}");
        text += &curve(&id, |age| value(age)[index]);
        texture.add(&format!("curve_{axis}"), format_args!("SubResource(\"{id}\")"));
    }
    text + &sub_resource("CurveXYZTexture", &format!("{name}_texture"), &texture)
}

/// Texture `<name>_texture` of colors, from 0 to 1.
pub fn gradient_texture(name: &str, colors: &[(f32, Vec3)]) -> String {
    let id = format!("{name}_gradient");
    let list = |numbers: Vec<String>| numbers.join(", ");
    let offsets = list(colors.iter().map(|(offset, _)| format!("{offset:?}")).collect());
    let channels = colors.iter().flat_map(|(_, color)| Vec4::from((*color, 1.0)).to_array());
    let channels = list(channels.map(|channel| format!("{channel:?}")).collect());
    let mut gradient = Properties::default();
    gradient.add("offsets", format_args!("PackedFloat32Array({offsets})"));
    gradient.add("colors", format_args!("PackedColorArray({channels})"));
    let mut texture = Properties::default();
    texture.add("gradient", format_args!("SubResource(\"{id}\")"));
    texture.add("use_hdr", true);
    sub_resource("Gradient", &id, &gradient) + &sub_resource("GradientTexture1D", &format!("{name}_texture"), &texture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_few_points_and_are_near_all() {
        let shapes: [fn(f32) -> f32; 4] = [|_| 2.0, |age| 1.0 - age, f32::sqrt, |age| 3.0 * (5.0 * age).sin()];
        for (shape, most) in shapes.into_iter().zip([2, 2, 16, 48]) {
            let points = curve_points(shape);
            assert!(points.len() <= most, "{}", points.len());
            for pair in points.windows(2) {
                for fraction in [0.25, 0.5, 0.75] {
                    let at = pair[0].lerp(pair[1], fraction);
                    assert!((at.y - shape(at.x)).abs() < 0.02, "{at}: {}", shape(at.x));
                }
            }
        }
    }

    #[test]
    fn curves_are_written_as_godot_saves_them() {
        let text = curve("a", |age| 1.0 - 2.0 * age);
        let expected = "\n[sub_resource type=\"Curve\" id=\"a\"]\n_limits = [-1.0, 1.0, 0.0, 1.0]\n\
                        _data = [Vector2(0.0, 1.0), 0.0, -2.0, 1, 1, Vector2(1.0, -1.0), -2.0, 0.0, 1, 1]\npoint_count = 2\n";
        assert_eq!(text, expected);
    }
}
