//! Question before a built-in ramp or sprite is copied beside the preset.

use eframe::egui::{self, Ui};

use crate::session::messages::truncate_middle;
use crate::session::{CopiedImage, Session};

/// Draws the question while it is open.
pub fn panel(ui: &Ui, session: &mut Session) {
    let Some(request) = &session.copy_request else { return };
    let kind = match request.image {
        CopiedImage::Ramp(_) => "ramp",
        CopiedImage::Sprite => "sprite",
    };
    let file = truncate_middle(&session.document.file_name(), 60);
    let (effect, confirm) = if session.document.is_built_in() {
        let first = format!("{file} is a built-in preset, so it is saved as a file first: you choose where.");
        (format!("{first} The copy of the {kind} is written beside it."), "Save Preset and Copy…")
    } else {
        (
            format!("The copy of the {kind} and its recipe are written beside {file}, and used by this preset."),
            "Make Copy",
        )
    };
    let mut answer = None;
    let response = egui::Modal::new(egui::Id::unique("copy")).show(ui.ctx(), |ui| {
        ui.set_max_width(420.0);
        ui.heading(format!("Make an editable copy of {}?", request.name));
        ui.label(effect);
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (text, is_confirmed) in [(confirm, true), ("Cancel", false)] {
                if ui.button(text).clicked() {
                    answer = Some(is_confirmed);
                }
            }
        });
    });
    match answer.or(response.should_close().then_some(false)) {
        Some(true) => session.confirm_copy(),
        Some(false) => session.copy_request = None,
        None => {}
    }
}
