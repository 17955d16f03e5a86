//! Highlights the smoke that samples a place on a ramp.

use eframe::egui::{self, Color32, Id, Rect, Ui, Vec2};

use crate::tweak::session::inspection::Inspection;
use crate::tweak::session::ramp_survey::RampPlace;

/// Opacity of the highlight, and of the flash that it begins with, 0 to 255.
const OPACITY: f32 = 120.0;
const FLASH: f32 = 230.0;
const FLASH_SECONDS: f64 = 0.5;

/// Paints the highlight over the image in the viewport. It flashes when it moves to another place of a ramp.
pub fn paint(ui: &Ui, viewport: Rect, inspect: &Inspection, system: usize) {
    let seconds = seconds_at_place(ui, inspect.ramp_place);
    let Some((survey, ramp_place)) = inspect.survey.as_ref().zip(inspect.ramp_place) else { return };
    let flash = (1.0 - seconds / FLASH_SECONDS).max(0.0) as f32;
    if flash > 0.0 {
        ui.ctx().request_repaint();
    }
    let color = Color32::from_rgba_unmultiplied(255, 220, 60, egui::lerp(OPACITY..=FLASH, flash) as u8);
    let size = Vec2::new(survey.size.x as f32, survey.size.y as f32);
    let cell = Vec2::splat(survey.step as f32) * viewport.size() / size;
    let mut mesh = egui::Mesh::default();
    for pixel in survey.at(system, ramp_place) {
        let middle =
            viewport.min + (Vec2::new(pixel.x as f32, pixel.y as f32) + Vec2::splat(0.5)) * viewport.size() / size;
        mesh.add_colored_rect(Rect::from_center_size(middle, cell), color);
    }
    ui.painter().with_clip_rect(viewport).add(mesh);
}

/// Time since the pointer came to a place of a ramp, seconds.
fn seconds_at_place(ui: &Ui, place: Option<RampPlace>) -> f64 {
    let now = ui.input(|input| input.time);
    ui.data_mut(|data| {
        let last = data.get_temp_mut_or(Id::unique("ramp highlight"), (place, now));
        if last.0 != place {
            *last = (place, now);
        }
        now - last.1
    })
}
