//! Questions in a bar above the image, which do not block editing.

use eframe::egui::{self, Ui};

use crate::files::persistence::Persistence;
use crate::session::Session;
use crate::session::messages::truncate_middle;

/// Draws the bar while there is a question.
pub fn panel(ui: &mut Ui, session: &mut Session, persistence: Option<&mut Persistence>) {
    if let Some(persistence) = persistence {
        recovery(ui, session, persistence);
    }
    if !session.is_changed_on_disk {
        return;
    }
    egui::Panel::top("notice").show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            let path = truncate_middle(&session.document.path().display().to_string(), 80);
            ui.label(format!("Another program changed {path}. You have unsaved changes."));
            if ui.button("Reload file").on_hover_text("Undo restores your changes").clicked() {
                session.revert();
            }
            if ui.button("Keep my changes").on_hover_text("The next save overwrites the file").clicked() {
                session.document.keep_mine();
                session.is_changed_on_disk = false;
            }
        });
    });
}

fn recovery(ui: &mut Ui, session: &mut Session, persistence: &mut Persistence) {
    let Some(one) = persistence.crashed_work.last() else { return };
    let source = truncate_middle(&one.source.display().to_string(), 60);
    let name = truncate_middle(&one.preset.name, 30);
    let text = format!("Haze closed unexpectedly. Unsaved changes to {source} ({name}) can be recovered.");
    egui::Panel::top("recovery").show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(text);
            // It must not replace other unsaved work.
            let is_free = !session.document.is_dirty();
            let recover = ui.add_enabled(is_free, egui::Button::new("Recover"));
            if recover.on_disabled_hover_text("Save your changes first").clicked() {
                persistence.answer(true, session);
            } else if ui.button("Discard").clicked() {
                persistence.answer(false, session);
            }
        });
    });
}
