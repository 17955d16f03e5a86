//! Questions in a bar above the image, which do not block editing.

use eframe::egui::{self, Ui};

use crate::tweak::files::persistence::Persistence;
use crate::tweak::session::Session;
use crate::tweak::session::messages::short;

/// Draws the bar while there is a question.
pub fn panel(ui: &mut Ui, session: &mut Session, keeping: Option<&mut Persistence>) {
    if let Some(keeping) = keeping {
        recovery(ui, session, keeping);
    }
    if !session.is_changed_on_disk {
        return;
    }
    egui::Panel::top("notice").show(ui, |ui| {
        ui.horizontal(|ui| {
            let path = short(&session.document.path().display().to_string(), 80);
            ui.label(format!("{path} was changed by another program, and has unsaved changes here."));
            if ui.button("Load it").on_hover_text("Undo restores your changes").clicked() {
                session.revert();
            }
            if ui.button("Keep mine").on_hover_text("The next save overwrites the file").clicked() {
                session.document.keep_mine();
                session.is_changed_on_disk = false;
            }
        });
    });
}

fn recovery(ui: &mut Ui, session: &mut Session, keeping: &mut Persistence) {
    let Some(one) = keeping.abandoned.last() else { return };
    let (source, name) = (short(&one.source.display().to_string(), 60), short(&one.preset.name, 30));
    let text = format!("The program ended with unsaved work on {source}: {name}.");
    egui::Panel::top("recovery").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(text);
            // It must not replace other unsaved work.
            let is_free = !session.document.is_dirty();
            let recover = ui.add_enabled(is_free, egui::Button::new("Recover"));
            if recover.on_disabled_hover_text("Save the present changes first").clicked() {
                keeping.answer(true, session);
            } else if ui.button("Discard").clicked() {
                keeping.answer(false, session);
            }
        });
    });
}
