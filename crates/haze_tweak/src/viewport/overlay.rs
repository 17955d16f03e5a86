//! Overlays on the image that show how it is made.

use eframe::egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};
use glam::{UVec2, Vec3};
use haze::{Bounds, Particle};

use super::outlined_painter::OutlinedPainter;
use super::screen_projection::ScreenProjection;
use crate::session::smoke_geometry::SmokeGeometry;
use crate::session::view_options::{Overlay, ViewOptions};
use crate::viewport_renderer::TargetTexels;

/// Largest number of particles that are drawn, over all systems.
const MAX_PARTICLES: usize = 4096;
/// Least distance between lines of the grid, points.
const MIN_GRID_SPACING: f32 = 4.0;

/// Colors of systems, reused cyclically.
const SYSTEM_COLORS: [Color32; 4] = [
    Color32::from_rgb(255, 196, 84),
    Color32::from_rgb(110, 214, 255),
    Color32::from_rgb(186, 255, 120),
    Color32::from_rgb(255, 140, 214),
];

/// Draws the visible overlays. `texels` are those of each system in the last image.
pub fn draw(
    outlined: &OutlinedPainter<'_>,
    projection: &ScreenProjection,
    view: &ViewOptions,
    smoke: &SmokeGeometry,
    texels: &[Option<TargetTexels>],
) {
    let systems = smoke.systems.len().max(1);
    for (index, (particles, bounds)) in smoke.systems.iter().zip(&smoke.bounds).enumerate() {
        let color = SYSTEM_COLORS[index % SYSTEM_COLORS.len()];
        if view.overlays.has(Overlay::Particles) {
            points(outlined.0, projection, particles, MAX_PARTICLES / systems);
        }
        if view.overlays.has(Overlay::Bounds) && !bounds.is_empty() {
            for [from, to] in edges(bounds) {
                if let Some(ends) = projection.segment(from, to) {
                    outlined.line(&ends, 1.0, color);
                }
            }
        }
        let Some(texels) = texels.get(index).copied().flatten() else { continue };
        if view.overlays.has(Overlay::LitPlane) {
            plane(outlined, projection, bounds, texels.lit_depth, color);
        }
        if view.overlays.has(Overlay::Grid) {
            grid(outlined.0, projection.rect, &texels, color);
        }
    }
}

/// Returns the twelve edges of a box.
fn edges(bounds: &Bounds) -> impl Iterator<Item = [Vec3; 2]> {
    let min = bounds.min;
    let max = bounds.max;
    let corner = move |index: usize| {
        Vec3::from([0, 1, 2].map(|axis| if index & (1 << axis) == 0 { min[axis] } else { max[axis] }))
    };
    let starts = (0..3).flat_map(|axis| (0..8).map(move |index| (index, 1 << axis)));
    starts.filter(|(index, bit)| index & bit == 0).map(move |(index, bit)| [corner(index), corner(index | bit)])
}

/// Returns the corners of the section of a box with the plane at a depth that faces the camera, in order around their
/// center.
fn section(bounds: &Bounds, projection: &ScreenProjection, depth: f32) -> Vec<Pos2> {
    let cut = |[from, to]: [Vec3; 2]| {
        let a = projection.depth(from) - depth;
        let b = projection.depth(to) - depth;
        (a * b < 0.0).then(|| from.lerp(to, a / (a - b))).and_then(|at| projection.project(at))
    };
    let mut corners: Vec<_> = edges(bounds).filter_map(cut).collect();
    let middle = corners.iter().fold(Vec2::ZERO, |sum, at| sum + at.to_vec2()) / corners.len().max(1) as f32;
    corners.sort_by(|a, b| (a.to_vec2() - middle).angle().total_cmp(&(b.to_vec2() - middle).angle()));
    corners
}

fn plane(outlined: &OutlinedPainter<'_>, projection: &ScreenProjection, bounds: &Bounds, depth: f32, color: Color32) {
    let mut corners = section(bounds, projection, depth);
    let Some(&first) = corners.first() else { return };
    outlined.0.add(Shape::convex_polygon(corners.clone(), color.gamma_multiply(0.18), Stroke::NONE));
    corners.push(first);
    outlined.line(&corners, 1.0, color);
    let lowest = corners.iter().copied().fold(first, |low, at| if at.y > low.y { at } else { low });
    label(outlined.0, projection.rect, lowest + vec2(4.0, -18.0), &format!("Lit at {depth:.2} m"));
}

/// Draws at most `most` particles.
fn points(painter: &Painter, projection: &ScreenProjection, particles: &[Particle], most: usize) {
    let mut mesh = Mesh::default();
    let step = particles.len().div_ceil(most.max(1)).max(1);
    for particle in particles.iter().step_by(step).filter(|particle| particle.is_visible()) {
        if let Some(at) = projection.project(particle.position).filter(|at| projection.rect.contains(*at)) {
            mesh.add_colored_rect(Rect::from_center_size(at, Vec2::splat(5.0)), Color32::from_black_alpha(160));
            mesh.add_colored_rect(Rect::from_center_size(at, Vec2::splat(3.0)), age(particle.age));
        }
    }
    painter.add(mesh);
}

/// Returns a warm color for a young particle and a cold one for an old one.
fn age(age: f32) -> Color32 {
    Color32::from_rgb(255, 214, 92).lerp_to_gamma(Color32::from_rgb(92, 130, 255), age.clamp(0.0, 1.0))
}

/// Draws the texels of a target. If they are too small, only every n-th line is drawn.
fn grid(painter: &Painter, rect: Rect, texels: &TargetTexels, color: Color32) {
    let pixel = rect.width() / texels.image.x.max(1) as f32;
    let texel = pixel * texels.scale as f32;
    let every = (MIN_GRID_SPACING / texel).ceil().max(1.0) as u32;
    let position = |x: i32, y: i32| pos2(rect.left() + x as f32 * texel, rect.top() + y as f32 * texel);
    let start = texels.origin;
    let end = texels.origin + texels.size.as_ivec2();
    let shown = Rect::from_two_pos(position(start.x, start.y), position(end.x, end.y));
    let line = Stroke::new(1.0, color.gamma_multiply(0.3));
    for column in (0..=texels.size.x).step_by(every as usize) {
        painter.vline(position(start.x + column as i32, 0).x, shown.y_range(), line);
    }
    for row in (0..=texels.size.y).step_by(every as usize) {
        painter.hline(shown.x_range(), position(0, start.y + row as i32).y, line);
    }
    painter.rect_stroke(shown, 0.0, Stroke::new(1.0, color), eframe::egui::StrokeKind::Middle);
    let UVec2 { x, y } = texels.size;
    let resolution = match texels.scale {
        1 => "full res".into(),
        2 => "half res".into(),
        4 => "quarter res".into(),
        scale => format!("1/{scale} res"),
    };
    let lines = if every > 1 { format!(", every {every} lines") } else { String::new() };
    let text = format!("Smoke buffer {x}×{y} ({resolution}){lines}");
    label(painter, rect, shown.left_bottom() + vec2(4.0, -18.0), &text);
}

/// Draws text on a dark background, kept inside the image.
fn label(painter: &Painter, rect: Rect, at: Pos2, text: &str) {
    let text = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), Color32::WHITE);
    let room = rect.shrink(4.0);
    let most = (room.max - text.size()).max(room.min);
    let plate = Align2::LEFT_TOP.anchor_size(at.clamp(room.min, most), text.size());
    painter.rect_filled(plate.expand(2.0), 2.0, Color32::from_black_alpha(170));
    painter.galley(plate.min, text, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_preset::Camera;

    #[test]
    fn a_box_has_twelve_edges_and_its_section_lies_on_the_plane() {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.5, -1.0), max: Vec3::new(1.0, 2.5, 1.0) };
        let all: Vec<_> = edges(&bounds).collect();
        assert_eq!(all.len(), 12);
        assert!(all.iter().all(|[from, to]| (from.distance(*to) - 2.0).abs() < 1e-6));
        let projection = ScreenProjection::new(&Camera::default(), Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0)));
        let middle = projection.depth(bounds.center());
        let corners = section(&bounds, &projection, middle);
        assert!(corners.len() >= 4, "{corners:?}");
        let inside = projection.project(bounds.center()).unwrap();
        assert!(Rect::from_points(&corners).contains(inside));
        assert!(section(&bounds, &projection, middle + 9.0).is_empty());
    }
}
