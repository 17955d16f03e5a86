//! List of keys and gestures.

use eframe::egui::{self, RichText, Ui, Vec2};

use crate::session::Session;
use crate::session::action::{ACTIONS, GESTURES};

/// Margins between the list and the edges of the window, points.
const ROOM: Vec2 = Vec2::new(100.0, 130.0);

/// Draws the list over the window while it is open.
pub fn panel(ui: &Ui, session: &mut Session) {
    if !session.view.help {
        return;
    }
    let response = egui::Modal::new(egui::Id::unique("help")).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            ui.heading("Keyboard and Mouse");
            if ui.button("Show hints again").on_hover_text("Shows the hints of the first start").clicked() {
                session.hints.begin();
                session.view.help = false;
            }
        });
        ui.add_space(6.0);
        let room = ui.ctx().content_rect().size() - ROOM;
        egui::ScrollArea::vertical().max_height(room.y).min_scrolled_height(room.y).show(ui, |ui| {
            let gap = 24.0;
            // In a small window, long lines wrap.
            let columns = [0.4, 0.6].map(|fraction| fraction * (room.x - gap));
            egui::Grid::new("keys").num_columns(2).spacing([gap, 4.0]).striped(true).show(ui, |ui| {
                let keys = ACTIONS.iter().map(|entry| (ui.ctx().format_shortcut(&entry.keys), entry.name));
                let keys: Vec<_> = keys.collect();
                let gestures = GESTURES.iter().map(|(gesture, what)| ((*gesture).to_owned(), *what));
                for (how, what) in keys.into_iter().chain(gestures) {
                    for (text, width) in [RichText::new(how).strong(), RichText::new(what)].into_iter().zip(columns) {
                        ui.scope(|ui| {
                            ui.set_max_width(width);
                            ui.add(egui::Label::new(text).wrap());
                        });
                    }
                    ui.end_row();
                }
            });
        });
    });
    if response.should_close() {
        session.view.help = false;
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Rect, Theme, Vec2};
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::window::testing::window;

    #[test]
    fn the_list_keeps_its_margins_in_windows_of_any_size() {
        for size in [Vec2::new(640.0, 400.0), Vec2::new(1280.0, 800.0)] {
            let mut harness = window("column", size, Theme::Dark);
            harness.key_press(Key::F1);
            harness.run_steps(4);
            let list = egui::AreaState::load(&harness.ctx, egui::Id::unique("help")).unwrap().rect();
            assert!(Rect::from_min_size(Default::default(), size).shrink(12.0).contains_rect(list), "{size}: {list}");
            assert!(harness.query_by_label(ACTIONS[0].name).is_some());
        }
    }
}
