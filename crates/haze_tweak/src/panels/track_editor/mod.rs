//! Keyframes over time: one row for each track, and the curve of the selected one.

mod curve_plot;
mod lane;
mod ruler;
mod time_axis;
mod track_options;

use eframe::egui::{self, Ui};
use haze_preset::system_list::system_of;

use super::rows::key_mark;
use crate::document::preset_diff::setting_title;
use crate::session::Session;
use lane::ROW;
use time_axis::TimeAxis;

/// Height of the curve and of the options of the selected track.
const CURVE: f32 = 104.0;
/// Gap between rows.
const GAP: f32 = 2.0;
/// Margins of the panel.
const MARGINS: f32 = 8.0;
/// Width of the names.
const NAMES: f32 = 236.0;

/// Returns the height that shows all tracks.
pub fn filled_height(session: &Session) -> f32 {
    let curve = if session.view.tracks.selected.is_some() { CURVE + GAP } else { 0.0 };
    session.document.preset.animation.len() as f32 * (ROW + GAP) + curve + ruler::HEIGHT + GAP + MARGINS
}

/// Draws the tracks.
pub fn panel(ui: &mut Ui, session: &mut Session) {
    ui.spacing_mut().item_spacing.y = GAP;
    let settings: Vec<_> = session.document.preset.animation.iter().map(|track| track.setting.clone()).collect();
    let selected = session.view.tracks.selected.clone().filter(|selected| settings.contains(selected));
    session.view.tracks.selected = selected;
    // Beside the scroll bar.
    let width = ui.available_width() - ui.spacing().scroll.bar_width - 4.0;
    let axis = TimeAxis::new(ui.cursor().left() + NAMES, (width - NAMES).max(40.0), session);
    ruler::ruler(ui, session, &axis);
    let area = egui::ScrollArea::vertical().id_salt("tracks").auto_shrink(false).min_scrolled_height(0.0);
    area.show(ui, |ui| {
        for setting in &settings {
            ui.horizontal(|ui| {
                name(ui, session, setting);
                lane::lane(ui, session, setting, &axis);
            });
            if session.view.tracks.selected.as_ref() == Some(setting) {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 0.0;
                    track_options::options(ui, session, setting, egui::vec2(NAMES, CURVE));
                    curve_plot::curve(ui, session, setting, &axis, CURVE);
                });
            }
        }
    });
}

/// Draws the name of a track, and the mark that adds and deletes keyframes.
fn name(ui: &mut Ui, session: &mut Session, setting: &str) {
    ui.spacing_mut().item_spacing.x = 0.0;
    let preset = &session.document.preset;
    let time = session.playback.key_time();
    let title = setting_title(preset, setting);
    let state = key_mark::KeyMarks::new(preset, time).of(setting).state;
    let is_selected = session.view.tracks.selected.as_deref() == Some(setting);
    let systems = &session.document.preset.systems;
    let is_hidden = system_of(setting).is_some_and(|index| !session.view.systems.is_shown(systems, index));
    let text = if is_hidden { egui::RichText::new(&title).weak().strikethrough() } else { egui::RichText::new(&title) };
    let button = egui::Button::selectable(is_selected, text).truncate().right_text("");
    let button =
        ui.add_sized([NAMES - ROW - 4.0, ROW], button).on_hover_text(format!("{title}\n\nIn files: {setting}"));
    let button = button.accessible_name(&title);
    if button.clicked() {
        session.view.tracks.selected = (!is_selected).then(|| setting.to_owned());
    }
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ROW, ROW), egui::Sense::hover());
    let mark = key_mark::KeyMark { state, time };
    if key_mark::button(ui, rect, ui.scope_id().with(("key", setting)), mark, &title) {
        session.toggle_key(setting);
    }
    ui.add_space(4.0);
}

#[cfg(test)]
mod tests;
