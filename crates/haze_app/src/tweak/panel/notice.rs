//! Questions that wait for an answer in a bar over the picture, while the work goes on.

use eframe::egui::{self, Ui};

use crate::tweak::keeping::Keeping;
use crate::tweak::messages::short;
use crate::tweak::session::Session;

/// Draws the bar while there is something to ask.
pub fn panel(ui: &mut Ui, session: &mut Session, keeping: Option<&mut Keeping>) {
    if let Some(keeping) = keeping {
        recovery(ui, session, keeping);
    }
    if !session.is_changed_on_disk {
        return;
    }
    egui::Panel::top("notice").show(ui, |ui| {
        ui.horizontal(|ui| {
            let path = short(&session.document.path().display().to_string(), 80);
            ui.label(format!("{path} has changed on disk, and is changed here too."));
            if ui.button("Load it").on_hover_text("What is changed here is one Undo away").clicked() {
                session.revert();
            }
            if ui.button("Keep mine").on_hover_text("Save writes over what is on disk").clicked() {
                session.document.keep_mine();
                session.is_changed_on_disk = false;
            }
        });
    });
}

fn recovery(ui: &mut Ui, session: &mut Session, keeping: &mut Keeping) {
    let Some(one) = keeping.abandoned.last() else { return };
    let (source, name) = (short(&one.source.display().to_string(), 60), short(&one.preset.name, 30));
    let text = format!("Unsaved work on {source} was left when the program ended: {name}.");
    egui::Panel::top("recovery").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(text);
            // Not over other work that is not saved.
            let is_free = !session.document.is_dirty();
            let recover = ui.add_enabled(is_free, egui::Button::new("Recover"));
            if recover.on_disabled_hover_text("Save what is changed here first").clicked() {
                keeping.answer(true, session);
            } else if ui.button("Throw away").clicked() {
                keeping.answer(false, session);
            }
        });
    });
}
