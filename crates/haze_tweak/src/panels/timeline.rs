//! Timeline: play, step, scrub, loop.

use eframe::egui::{self, Ui};
use glam::UVec2;
use haze_author::preset::no_effect_reason;
use haze_preset::{MAX_TIME, Preset};

use super::narrow;
use super::rows::icon_button::{self, Icon};
use crate::session::Session;
use crate::session::first_run_hints::WindowPart;

pub fn panel(ui: &mut Ui, session: &mut Session) {
    narrow::row(ui, "timeline", |ui| {
        let playback = &mut session.playback;
        if icon_button::button(ui, Icon::Back, false, "Previous frame (,)").clicked() {
            playback.step(-1.0);
        }
        let (sign, name) =
            if playback.is_playing { (Icon::Pause, "Pause (Space)") } else { (Icon::Play, "Play (Space)") };
        let play = icon_button::button(ui, sign, playback.is_playing, name);
        session.hints.record_rect(WindowPart::Play, play.rect);
        if play.clicked() {
            playback.is_playing = !playback.is_playing;
        }
        if icon_button::button(ui, Icon::Forward, false, "Next frame (.)").clicked() {
            playback.step(1.0);
        }
        if icon_button::button(ui, Icon::Loop, playback.is_looping, "Loop playback (L)").clicked() {
            playback.is_looping = !playback.is_looping;
        }
        // In a narrow window, the rest of the row is scrolled to.
        let keys = if session.document.preset.animation.is_empty() { 0.0 } else { 46.0 };
        let beside = if narrow::is_narrow(ui.ctx()) { 110.0 } else { 500.0 + keys };
        ui.spacing_mut().slider_width = (ui.available_width() - beside).max(60.0);
        let scrub = egui::Slider::new(&mut playback.time, playback.range.clone())
            .clamping(egui::SliderClamping::Never)
            .fixed_decimals(2)
            .suffix(" s");
        ui.add(scrub).on_hover_text("Time since the smoke began");
        let mut start = *playback.range.start();
        let mut end = *playback.range.end();
        let drag = |value| {
            egui::DragValue::new(value).speed(0.05).range(-1000.0..=f64::from(MAX_TIME)).fixed_decimals(1).suffix(" s")
        };
        ui.weak("From").labelled_by(ui.add(drag(&mut start)).on_hover_text("Start of the loop").id);
        ui.weak("To").labelled_by(ui.add(drag(&mut end)).on_hover_text("End of the loop").id);
        if end > start {
            playback.range = start..=end;
        }
        let speed =
            egui::DragValue::new(&mut playback.speed).speed(0.01).range(-8.0..=8.0).fixed_decimals(2).suffix("×");
        ui.add(speed).on_hover_text("Playback speed; a negative speed plays backwards");
        let edit = session.begin_edit();
        freeze(ui, &mut session.document.preset, session.view.size);
        session.end_edit(edit);
        let playback = &session.playback;
        let preset = &mut session.document.preset;
        let is_kept = preset.time.to_bits() == playback.time.to_bits();
        let keep =
            ui.add_enabled(!is_kept, egui::Button::new("Set start")).on_hover_text("Opens the preset at this time");
        if keep.clicked() {
            preset.time = playback.time;
        }
        if !preset.animation.is_empty() && !narrow::is_narrow(ui.ctx()) {
            let tracks = &mut session.view.tracks;
            let button = ui.add(egui::Button::selectable(!tracks.is_closed, "Keys"));
            if button.on_hover_text("Shows the keyframes of the settings that change over time").clicked() {
                tracks.is_closed = !tracks.is_closed;
            }
        }
    });
}

/// Draws the button that stops the sprite animation of every system.
fn freeze(ui: &mut Ui, preset: &mut Preset, size: UVec2) {
    let path = |index| format!("systems[{index}].settings.debug.freeze_animation");
    let idle: Option<Vec<_>> =
        (0..preset.systems.len()).map(|index| no_effect_reason(preset, &path(index), size)).collect();
    let idle = idle.map(|reasons| reasons.first().copied().unwrap_or("this preset has no smoke"));
    let is_frozen = preset.systems.iter().any(|system| system.settings.debug.freeze_animation);
    let button = ui.add_enabled(idle.is_none(), egui::Button::selectable(is_frozen, "Freeze"));
    let button = button.on_hover_text("Freezes the animation of the sprites, not their motion. Saved with the preset.");
    if button.on_disabled_hover_text(idle.unwrap_or_default()).clicked() {
        let systems = preset.systems.iter_mut();
        systems.for_each(|system| system.settings.debug.freeze_animation = !is_frozen);
    }
}
