//! Row of keyframes: diamonds that are dragged in time, with a menu for each and for the row.

use eframe::egui::{self, Rect, Response, Sense, Stroke, Ui, pos2};
use haze_preset::{Ease, Track};

use super::time_axis::TimeAxis;
use crate::document::display_names::display_name;
use crate::document::keyframes::{self, move_key, remove_key, track_mut};
use crate::document::preset_diff::setting_title;
use crate::panels::rows::key_mark::{RADIUS, color, diamond};
use crate::session::Session;

/// Height of the row of a track, points.
pub const ROW: f32 = 20.0;
/// Most marks of repeated keyframes.
const MAX_REPEATED: usize = 200;

/// Change of a track that is made after its row is drawn.
enum Change {
    Move(usize, f32),
    Delete(usize),
    DeleteAll,
    Ease(usize, Ease),
    Copy(usize),
    Add(f32),
    Paste(f32),
    /// Go to the time of a keyframe.
    Seek(f32),
}

/// Draws the keyframes of a track.
pub fn lane(ui: &mut Ui, session: &mut Session, setting: &str, axis: &TimeAxis) {
    let Some(track) = keyframes::track(&session.document.preset, setting).cloned() else { return };
    let title = setting_title(&session.document.preset, setting);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(axis.width, ROW), Sense::click_and_drag());
    let name = format!("Keyframes of {title}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let now = axis.x(axis.now);
    painter.vline(now, rect.y_range(), Stroke::new(1.0, ui.visuals().selection.stroke.color));
    repeated(ui, rect, &track, axis);
    let mut change = row_menu(ui, session, &response, &track, axis);
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        change = Some(Change::Seek((axis.time(at.x) * 100.0).round() / 100.0));
    }
    let here = keyframes::key_at(&track, axis.now);
    for (index, key) in track.keys.iter().enumerate() {
        let center = pos2(axis.x(key.time), rect.center().y);
        let mark_rect = Rect::from_center_size(center, egui::vec2(2.0 * RADIUS + 3.0, ROW));
        let mark = ui.interact(mark_rect, ui.scope_id().with((setting, index)), Sense::click_and_drag());
        let text = format!("Keyframe {} of {title} at {:.2} s", index + 1, key.time);
        mark.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &text));
        let is_here = here == Some(index);
        let radius = if mark.hovered() || mark.dragged() { RADIUS + 1.5 } else { RADIUS };
        diamond(&painter, center, radius, color(), is_here || mark.dragged());
        if let Some(at) = mark.interact_pointer_pos().filter(|_| mark.dragged()) {
            change = Some(Change::Move(index, axis.time(at.x)));
        } else if mark.clicked() {
            change = Some(Change::Seek(key.time));
        }
        change = key_menu(session, &mark, key.ease, index).or(change);
        let ease = display_name(key.ease.name());
        mark.on_hover_text(format!("{:.2} s, {}\n\nDrag to move. Right-click for ease, copy, delete.", key.time, ease));
    }
    if let Some(change) = change {
        apply(session, setting, change);
    }
}

/// Draws the end of the period, and the keyframes of later periods.
fn repeated(ui: &Ui, rect: Rect, track: &Track, axis: &TimeAxis) {
    if track.period <= 0.0 {
        return;
    }
    let painter = ui.painter_at(rect);
    let faint = color().gamma_multiply(0.4);
    painter.vline(axis.x(track.period), rect.y_range(), Stroke::new(1.0, faint));
    let times =
        (1..MAX_REPEATED).flat_map(|turn| track.keys.iter().map(move |key| key.time + turn as f32 * track.period));
    for time in times.take_while(|time| *time <= axis.end() + track.period).take(MAX_REPEATED) {
        diamond(&painter, pos2(axis.x(time), rect.center().y), RADIUS - 1.5, faint, false);
    }
}

/// Draws the menu of a row while it is open.
fn row_menu(ui: &Ui, session: &mut Session, response: &Response, track: &Track, axis: &TimeAxis) -> Option<Change> {
    let id = response.id.with("time");
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.secondary_clicked()) {
        ui.data_mut(|data| data.insert_temp(id, (axis.time(at.x) * 100.0).round() / 100.0));
    }
    let time: f32 = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut change = None;
    response.context_menu(|ui| {
        let entry = |ui: &mut Ui, is_on, name: String| {
            let is_clicked = ui.add_enabled(is_on, egui::Button::new(name)).clicked();
            if is_clicked {
                ui.close();
            }
            is_clicked
        };
        if entry(ui, true, format!("Add Keyframe at {time:.2} s")) {
            change = Some(Change::Add(time));
        }
        if entry(ui, fits(session, track), format!("Paste Keyframes at {time:.2} s")) {
            change = Some(Change::Paste(time));
        }
        ui.separator();
        if entry(ui, !track.keys.is_empty(), "Copy All Keyframes".into()) {
            session.view.tracks.copied.clone_from(&track.keys);
        }
        if entry(ui, true, "Delete Track".into()) {
            change = Some(Change::DeleteAll);
        }
    });
    change
}

/// Returns true if the copied keyframes have values of this track's type.
fn fits(session: &Session, track: &Track) -> bool {
    let copied = session.view.tracks.copied.first().map(|key| std::mem::discriminant(&key.value));
    copied.is_some() && track.keys.first().is_none_or(|key| Some(std::mem::discriminant(&key.value)) == copied)
}

/// Draws the menu of a keyframe while it is open.
fn key_menu(session: &Session, mark: &Response, ease: Ease, index: usize) -> Option<Change> {
    let mut change = None;
    mark.context_menu(|ui| {
        ui.weak("To the next keyframe");
        for &other in Ease::ALL {
            let entry = ui.selectable_label(other == ease, display_name(other.name()));
            let tooltip = session.tooltips.choice("animation.keys.ease", other.name()).unwrap_or_default();
            if entry.on_hover_text(tooltip).clicked() {
                change = Some(Change::Ease(index, other));
                ui.close();
            }
        }
        ui.separator();
        if ui.button("Copy Keyframe").clicked() {
            change = Some(Change::Copy(index));
            ui.close();
        }
        if ui.button("Delete Keyframe").clicked() {
            change = Some(Change::Delete(index));
            ui.close();
        }
    });
    change
}

fn apply(session: &mut Session, setting: &str, change: Change) {
    let preset = &mut session.document.preset;
    match change {
        Change::Move(index, time) => {
            if let Some(track) = track_mut(preset, setting) {
                move_key(track, index, time);
            }
        }
        Change::Delete(index) => remove_key(preset, setting, index),
        Change::DeleteAll => session.remove_track(setting),
        Change::Ease(index, ease) => {
            if let Some(key) = track_mut(preset, setting).and_then(|track| track.keys.get_mut(index)) {
                key.ease = ease;
            }
        }
        Change::Copy(index) => {
            let key = keyframes::track(preset, setting).and_then(|track| track.keys.get(index));
            session.view.tracks.copied = key.cloned().into_iter().collect();
        }
        Change::Add(time) => keyframes::add_key(preset, setting, time),
        Change::Paste(time) => session.paste_keys(setting, time),
        Change::Seek(time) => {
            session.playback.time = f64::from(time);
            session.playback.is_playing = false;
        }
    }
}
