//! The list of keys and gestures.

use eframe::egui::{self, Ui};

use crate::app::tweak::action::{ACTIONS, GESTURES};
use crate::app::tweak::session::Session;

/// Draws the list over the window while it is open.
pub fn panel(ui: &Ui, session: &mut Session) {
    if !session.show.help {
        return;
    }
    let response = egui::Modal::new(egui::Id::unique("help")).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keys and gestures");
            if ui.button("Show the hints again").on_hover_text("Those of the first start").clicked() {
                session.hints.begin();
                session.show.help = false;
            }
        });
        ui.add_space(6.0);
        let height = ui.ctx().content_rect().height() - 120.0;
        egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            egui::Grid::new("keys").num_columns(2).spacing([24.0, 4.0]).striped(true).show(ui, |ui| {
                for entry in ACTIONS {
                    ui.strong(ui.ctx().format_shortcut(&entry.keys));
                    ui.label(entry.name);
                    ui.end_row();
                }
                for (gesture, what) in GESTURES {
                    ui.strong(*gesture);
                    ui.label(*what);
                    ui.end_row();
                }
            });
        });
    });
    if response.should_close() {
        session.show.help = false;
    }
}
