//! Highlights the smoke that samples a place on a ramp.

use eframe::egui::{self, Color32, Rect, Ui, Vec2};

use crate::tweak::session::inspection::Inspection;

/// Paints the highlight over the image in the viewport.
pub fn paint(ui: &Ui, viewport: Rect, inspect: &Inspection, system: usize) {
    let Some((survey, ramp_place)) = inspect.survey.as_ref().zip(inspect.ramp_place) else { return };
    let size = Vec2::new(survey.size.x as f32, survey.size.y as f32);
    let cell = Vec2::splat(survey.step as f32) * viewport.size() / size;
    let mut mesh = egui::Mesh::default();
    for pixel in survey.at(system, ramp_place) {
        let middle =
            viewport.min + (Vec2::new(pixel.x as f32, pixel.y as f32) + Vec2::splat(0.5)) * viewport.size() / size;
        mesh.add_colored_rect(Rect::from_center_size(middle, cell), Color32::from_rgba_unmultiplied(255, 220, 60, 120));
    }
    ui.painter().with_clip_rect(viewport).add(mesh);
}
