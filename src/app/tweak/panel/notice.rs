//! Questions that wait for an answer in a bar over the picture, while the work goes on.

use eframe::egui::{self, Ui};

use crate::app::tweak::session::Session;

/// Draws the bar while there is something to ask.
pub fn panel(ui: &mut Ui, session: &mut Session) {
    if !session.is_changed_on_disk {
        return;
    }
    egui::Panel::top("notice").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(format!("{} has changed on disk, and is changed here too.", session.document.path().display()));
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
