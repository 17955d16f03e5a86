//! Bar at the top of the window.

use eframe::egui::{self, Ui};

use super::Window;
use crate::panels;
use crate::panels::comparison_bar::width;
use crate::session::action::Action;
use crate::session::first_run_hints::WindowPart;
use crate::session::messages::truncate_middle;

impl Window {
    /// Draws the bar at the top: file menu, title, undo, comparison, and tools.
    pub(super) fn title_bar(&mut self, ui: &mut Ui) {
        panels::narrow::row(ui, "title", |ui| {
            if let Some(action) = panels::file_menu::menu(ui, &mut self.session) {
                self.act(action, ui.ctx());
            }
            // A quarter of the row, at about 7 points a character.
            let letters = (0.25 * ui.available_width() / 7.0).clamp(12.0, 40.0) as usize;
            ui.strong(truncate_middle(&self.session.document.title(), letters))
                .on_hover_text(self.session.document.path().to_string_lossy());
            if self.session.document.is_dirty() {
                ui.label("•").on_hover_text("Unsaved changes");
            }
            ui.separator();
            let undo = self.session.document.history().undo_name().map(str::to_owned);
            let redo = self.session.document.history().redo_name().map(str::to_owned);
            let button = ui.add_enabled(undo.is_some(), egui::Button::new("Undo"));
            if button.on_hover_text(undo.unwrap_or_default()).clicked() {
                self.session.undo();
            }
            let button = ui.add_enabled(redo.is_some(), egui::Button::new("Redo"));
            if button.on_hover_text(redo.unwrap_or_default()).clicked() {
                self.session.redo();
            }
            ui.separator();
            let others = ["Inspect", "Theme", "Find", "?"];
            let others: f32 = others.map(|name| width(ui, name) + ui.spacing().item_spacing.x).iter().sum();
            panels::comparison_bar::panel(ui, &mut self.session, ui.available_width() - others);
            let inspect = ui.selectable_label(self.session.inspect.is_on, "Inspect");
            if inspect.on_hover_text("Shows values of the pixel under the pointer (I). Click to pin it.").clicked() {
                self.session.inspect.toggle();
            }
            let is_narrow = panels::narrow::is_narrow(ui.ctx());
            let layout = if is_narrow { egui::Layout::left_to_right } else { egui::Layout::right_to_left };
            ui.with_layout(layout(egui::Align::Center), |ui| {
                let keys = ui.button("?").on_hover_text("Keyboard and mouse");
                self.session.hints.record_rect(WindowPart::Keys, keys.rect);
                if keys.clicked() {
                    self.act(Action::Help, ui.ctx());
                }
                let find = ui.button("Find").on_hover_text("Finds a setting by its name or description");
                self.session.hints.record_rect(WindowPart::Find, find.rect);
                if find.clicked() {
                    self.act(Action::Find, ui.ctx());
                }
                theme(ui);
            });
        });
    }
}

/// Theme menu. It is not egui's own button, because the fonts lack its symbols.
fn theme(ui: &mut Ui) {
    let mut preference = ui.ctx().options(|options| options.theme_preference);
    ui.menu_button("Theme", |ui| {
        use egui::ThemePreference::{Dark, Light, System};
        for (theme, name) in [(System, "System"), (Dark, "Dark"), (Light, "Light")] {
            if ui.radio_value(&mut preference, theme, name).clicked() {
                ui.close();
            }
        }
    });
    ui.ctx().set_theme(preference);
}
