//! Loop and flicker of the selected track.

use eframe::egui::{self, Ui};
use haze_preset::Flicker;

use crate::document::keyframes::{track, track_mut};
use crate::session::Session;

/// Draws the options.
pub fn options(ui: &mut Ui, session: &mut Session, setting: &str, size: egui::Vec2) {
    let Some(mut edited) = track(&session.document.preset, setting).cloned() else { return };
    let can_flicker = session.document.preset.can_flicker(setting);
    let tooltip = |field: &str| session.tooltips.field(field).unwrap_or_default().to_owned();
    ui.allocate_ui_with_layout(size, egui::Layout::top_down(egui::Align::Min), |ui| {
        ui.set_min_size(size);
        ui.spacing_mut().item_spacing = egui::vec2(8.0, 4.0);
        ui.horizontal(|ui| {
            let last = edited.keys.last().map_or(0.0, |key| key.time);
            let can_loop = edited.keys.len() > 1 && edited.keys.first().is_some_and(|key| key.time >= 0.0);
            let mut is_looping = edited.period > 0.0;
            let toggle = ui.add_enabled(can_loop || is_looping, egui::Checkbox::new(&mut is_looping, "Loop"));
            let toggle = toggle.on_hover_text(tooltip("animation.period"));
            toggle.clone().on_disabled_hover_text("A loop needs two keyframes, none before 0 s");
            if toggle.changed() {
                edited.period = if is_looping { (last + 1.0).ceil() } else { 0.0 };
            }
            if edited.period > 0.0 {
                let seconds = egui::DragValue::new(&mut edited.period).range(last.max(0.1)..=1.0e5).speed(0.02);
                ui.add(seconds.max_decimals(2).suffix(" s")).on_hover_text(tooltip("animation.period"));
            }
        });
        ui.add_enabled_ui(can_flicker, |ui| {
            ui.spacing_mut().slider_width = 70.0;
            let Flicker { amount, rate, seed } = &mut edited.flicker;
            let slider = ui.add(egui::Slider::new(amount, 0.0..=1.0).max_decimals(2).text("Flicker"));
            slider
                .on_hover_text(tooltip("animation.flicker.amount"))
                .on_disabled_hover_text("Only numbers and colors flicker");
            ui.add_enabled_ui(*amount > 0.0, |ui| {
                let rates = egui::Slider::new(rate, 0.01..=60.0).logarithmic(true).max_decimals(1);
                ui.add(rates.text("Rate").suffix(" /s")).on_hover_text(tooltip("animation.flicker.rate"));
                ui.horizontal(|ui| {
                    ui.add(egui::DragValue::new(seed)).on_hover_text(tooltip("animation.flicker.seed"));
                    ui.label("Seed");
                });
            });
        });
    });
    if edited.keys.is_empty() && edited.flicker.amount <= 0.0 {
        // Without keyframes, the flicker is all that the track has.
        edited.flicker.amount = 0.01;
    }
    if let Some(track) = track_mut(&mut session.document.preset, setting) {
        *track = edited;
    }
}
