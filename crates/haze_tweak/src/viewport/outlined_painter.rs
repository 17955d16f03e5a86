//! Lines and marks over the image, with a dark outline so that they are legible on bright and dark.

use eframe::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2};

pub const AXES: [Color32; 3] =
    [Color32::from_rgb(238, 76, 76), Color32::from_rgb(122, 204, 66), Color32::from_rgb(82, 146, 250)];
pub const PLAIN: Color32 = Color32::from_rgb(236, 236, 236);
pub const SELECTED: Color32 = Color32::from_rgb(255, 166, 48);
pub const HOVERED: Color32 = Color32::from_rgb(255, 232, 110);
const RIM: Color32 = Color32::from_black_alpha(150);

/// Painter of outlined shapes.
pub struct OutlinedPainter<'a>(pub &'a Painter);

impl OutlinedPainter<'_> {
    pub fn line(&self, points: &[Pos2], width: f32, color: Color32) {
        let stroke = |width, color| Shape::line(points.to_vec(), Stroke::new(width, color));
        self.0.add(stroke(width + 2.0, RIM.gamma_multiply(opacity(color))));
        self.0.add(stroke(width, color));
    }

    pub fn dashes(&self, ends: [Pos2; 2], color: Color32) {
        // A line to the far end of the scene is skipped, because it would have a million dashes.
        if ends[0].distance(ends[1]) < 1.0e4 {
            self.0.extend(Shape::dashed_line(&ends, Stroke::new(3.0, RIM.gamma_multiply(opacity(color))), 4.0, 4.0));
            self.0.extend(Shape::dashed_line(&ends, Stroke::new(1.0, color), 4.0, 4.0));
        }
    }

    pub fn arrow_head(&self, tip: Pos2, along: Vec2, color: Color32) {
        let ahead = along.normalized();
        let side = along.normalized().rot90();
        let corners = vec![tip + 6.0 * ahead, tip - 6.0 * ahead + 5.0 * side, tip - 6.0 * ahead - 5.0 * side];
        self.0.add(Shape::convex_polygon(corners, color, Stroke::new(1.0, RIM)));
    }

    pub fn quad(&self, corners: [Pos2; 4], color: Color32) {
        self.0.add(Shape::convex_polygon(corners.to_vec(), color.gamma_multiply(0.45), Stroke::new(1.0, color)));
    }

    pub fn square(&self, center: Pos2, half: f32, color: Color32) {
        let rect = Rect::from_center_size(center, Vec2::splat(2.0 * half));
        self.0.rect_stroke(rect, 1.0, Stroke::new(3.5, RIM), StrokeKind::Middle);
        self.0.rect_stroke(rect, 1.0, Stroke::new(1.5, color), StrokeKind::Middle);
    }

    pub fn knob(&self, center: Pos2, color: Color32) {
        self.0.circle(center, 4.5, color, Stroke::new(1.5, RIM));
    }

    pub fn ring(&self, center: Pos2, radius: f32, width: f32, color: Color32) {
        self.0.circle_stroke(center, radius, Stroke::new(width + 2.0, RIM.gamma_multiply(opacity(color))));
        self.0.circle_stroke(center, radius, Stroke::new(width, color));
    }
}

fn opacity(color: Color32) -> f32 {
    f32::from(color.a()) / 255.0
}
