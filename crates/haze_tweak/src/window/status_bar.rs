//! Line at the bottom of the window.

use eframe::egui::{self, Ui};

use super::Window;

/// Tooltip where the CPU draws.
const SOFTWARE_TOOLTIP: &str =
    "There is no GPU, so the CPU draws the image, at low resolution while something moves. A smaller window is faster.";

impl Window {
    /// Draws the line at the bottom: adapter and latest message.
    pub(super) fn status_bar(&mut self, ui: &mut Ui) {
        let mut is_read = false;
        let line = |ui: &mut Ui| {
            if self.renderer.is_software() {
                ui.colored_label(ui.visuals().warn_fg_color, &self.adapter).on_hover_text(SOFTWARE_TOOLTIP);
            } else {
                ui.weak(&self.adapter);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                if let Some(message) = self.session.messages.latest() {
                    let text = egui::RichText::new(&message.text);
                    let text = if message.is_error { text.color(ui.visuals().error_fg_color) } else { text };
                    let label = ui.add(egui::Label::new(text).truncate().sense(egui::Sense::click()));
                    is_read = label.on_hover_text("Click to dismiss").clicked();
                }
            });
        };
        ui.horizontal(|ui| ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), line));
        if is_read {
            self.session.messages.dismiss_latest();
        }
    }
}
