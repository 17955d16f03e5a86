//! Search box over the window that finds any setting.

use eframe::egui::{self, Key, Ui};

use crate::session::Session;
use crate::session::setting_search::matches;

/// Draws the box while it is open.
pub fn panel(ui: &Ui, session: &mut Session) {
    let search = &mut session.search;
    if search.advance() {
        ui.ctx().request_repaint();
    }
    if !search.is_open {
        return;
    }
    let found = matches(&session.document.preset, &session.tooltips, &session.view.lights, &search.text);
    let mut gone_to = None;
    let response = egui::Modal::new(egui::Id::unique("search")).show(ui.ctx(), |ui| {
        ui.set_width(460.0);
        let step = |key| i32::from(ui.input(|input| input.key_pressed(key)));
        let chosen = search.chosen as i32 + step(Key::ArrowDown) - step(Key::ArrowUp);
        search.chosen = chosen.clamp(0, found.len().saturating_sub(1) as i32) as usize;
        let is_entered = ui.input(|input| input.key_pressed(Key::Enter));
        let edit =
            egui::TextEdit::singleline(&mut search.text).hint_text("Find a setting").desired_width(f32::INFINITY);
        let edit = ui.add(edit);
        edit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Find a setting"));
        edit.request_focus();
        if edit.changed() {
            search.chosen = 0;
        }
        for (index, found) in found.iter().enumerate() {
            let entry = ui.selectable_label(index == search.chosen, &found.name).on_hover_text(&found.tooltip);
            if entry.clicked() || is_entered && index == search.chosen {
                gone_to = Some((found.tab, found.path.clone()));
            }
        }
        if found.is_empty() {
            ui.weak("Nothing found");
        }
    });
    if let Some((tab, path)) = gone_to {
        session.view.tab = tab;
        search.go_to(path);
    } else if response.should_close() {
        search.is_open = false;
    }
}
