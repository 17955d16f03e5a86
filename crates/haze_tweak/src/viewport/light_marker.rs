//! Marks of lights in the image: position, drawing, picking.

use eframe::egui::{Color32, Pos2, Stroke, Vec2};
use glam::Vec3;
use haze::{Light, LightKind};

use super::outlined_painter::{OutlinedPainter, PLAIN, SELECTED};
use super::screen_projection::ScreenProjection;

/// Largest distance from a mark at which the pointer picks it, points.
const PICK: f32 = 10.0;

/// Returns the position where a light is shown. A sun has no position, so it is shown on the sphere around the camera's
/// target.
pub fn light_position(light: &Light, projection: &ScreenProjection) -> Vec3 {
    if light.kind != LightKind::Directional {
        return light.position;
    }
    projection.sun_sphere.0 - light.direction.normalize_or(Vec3::NEG_Y) * projection.sun_sphere.1
}

/// Returns the light whose mark is nearest to a position in the window.
pub fn pick(lights: &[Light], projection: &ScreenProjection, at: Pos2) -> Option<usize> {
    let distance = |light: &Light| projection.project(light_position(light, projection)).map(|mark| mark.distance(at));
    let near = (0..).zip(lights).filter_map(|(index, light)| Some((index, distance(light)?)));
    near.filter(|(_, distance)| *distance <= PICK).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// Draws a light's mark by its kind, in its color.
pub fn draw(
    outlined: &OutlinedPainter<'_>,
    light: &Light,
    projection: &ScreenProjection,
    is_selected: bool,
    is_shown: bool,
) {
    let Some(at) = projection.project(light_position(light, projection)) else { return };
    let opacity = if is_shown { 1.0 } else { 0.4 };
    let line = if is_selected { SELECTED } else { PLAIN }.gamma_multiply(opacity);
    let rays = |count: u32, from: f32, to: f32| {
        for ray in 0..count {
            let way = Vec2::angled(std::f32::consts::TAU * ray as f32 / count as f32);
            outlined.line(&[at + way * from, at + way * to], 1.5, line);
        }
    };
    match light.kind {
        LightKind::Point => outlined.ring(at, 8.0, 1.0, line),
        LightKind::Directional => rays(8, 7.5, 11.0),
        LightKind::Spot => {
            let tip = projection.project(
                light.position
                    + light.direction.normalize_or(Vec3::NEG_Y) * projection.metres_per_point(light.position),
            );
            let ahead = tip.map_or(Vec2::DOWN, |tip| tip - at).normalized();
            let ahead = if ahead == Vec2::ZERO { Vec2::DOWN } else { ahead };
            let side = ahead.rot90();
            outlined.line(&[at + 4.0 * ahead + 4.0 * side, at + 12.0 * ahead + 8.0 * side], 1.5, line);
            outlined.line(&[at + 4.0 * ahead - 4.0 * side, at + 12.0 * ahead - 8.0 * side], 1.5, line);
            outlined.line(&[at + 12.0 * ahead + 8.0 * side, at + 12.0 * ahead - 8.0 * side], 1.5, line);
        }
    }
    let fill = full_brightness(light.color).gamma_multiply(opacity);
    outlined.0.circle(at, 4.5, fill, Stroke::new(1.5, Color32::from_black_alpha(170).gamma_multiply(opacity)));
}

/// Returns a linear color, scaled to full brightness.
pub fn full_brightness(color: Vec3) -> Color32 {
    let [r, g, b] = (color / color.max_element().max(1.0e-6)).to_array();
    egui_color([r, g, b])
}

fn egui_color(linear: [f32; 3]) -> Color32 {
    let [r, g, b] = linear;
    eframe::egui::Rgba::from_rgb(r, g, b).into()
}
