//! Highlights the smoke that samples a position on a ramp: it flashes when the pointer comes there, then stays lit.

use eframe::egui::{self, Color32, Id, Rect, Ui, Vec2};

use crate::session::inspection::Inspection;
use crate::session::ramp_survey::RampPosition;

/// Duration of the flash, seconds.
const FLASH: f64 = 0.6;

/// Paints the highlight over the image in the viewport.
pub fn paint(ui: &Ui, viewport: Rect, inspect: &Inspection, system: usize) {
    let Some(elapsed) = seconds_at(ui, inspect.ramp_position) else { return };
    let Some((survey, ramp_position)) = inspect.survey.as_ref().zip(inspect.ramp_position) else { return };
    if elapsed < FLASH {
        ui.ctx().request_repaint();
    }
    let size = Vec2::new(survey.size.x as f32, survey.size.y as f32);
    let cell = Vec2::splat(survey.step as f32) * viewport.size() / size;
    let color = Color32::from_rgba_unmultiplied(255, 220, 60, opacity(elapsed));
    let mut mesh = egui::Mesh::default();
    for pixel in survey.at(system, ramp_position) {
        let middle =
            viewport.min + (Vec2::new(pixel.x as f32, pixel.y as f32) + Vec2::splat(0.5)) * viewport.size() / size;
        mesh.add_colored_rect(Rect::from_center_size(middle, cell), color);
    }
    ui.painter().with_clip_rect(viewport).add(mesh);
}

/// Returns the seconds since the pointer came to a position; `None` without one.
fn seconds_at(ui: &Ui, position: Option<RampPosition>) -> Option<f64> {
    let id = Id::unique("highlighted ramp place");
    let now = ui.input(|input| input.time);
    ui.data_mut(|data| {
        let Some(position) = position else {
            data.remove::<(RampPosition, f64)>(id);
            return None;
        };
        let before = data.get_temp::<(RampPosition, f64)>(id).filter(|(before, _)| before.is_near(position));
        let start = before.unwrap_or((position, now));
        data.insert_temp(id, start);
        Some(now - start.1)
    })
}

/// Opacity of the highlight after some seconds at a position.
fn opacity(elapsed: f64) -> u8 {
    egui::lerp(240.0..=110.0, (elapsed / FLASH).clamp(0.0, 1.0)) as u8
}
