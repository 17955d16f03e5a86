//! Mark of the keyframes of a row, which adds and deletes them.

use std::collections::HashMap;

use eframe::egui::{self, Color32, Rect, Sense, Shape, Stroke, Ui, Vec2};
use haze_preset::Preset;

use crate::document::keyframes::key_at;

/// Keyframes of a setting, from the view of one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeyState {
    /// There are none.
    #[default]
    None,
    /// There are some at other times.
    Elsewhere,
    /// There is one at this time.
    Here,
}

/// Mark of a row: its state, and the time in seconds.
#[derive(Clone, Copy, Debug)]
pub struct KeyMark {
    pub state: KeyState,
    pub time: f32,
}

/// Marks of a preset's settings at a time.
pub struct KeyMarks {
    time: f32,
    states: HashMap<String, KeyState>,
}

impl KeyMarks {
    pub fn new(preset: &Preset, time: f32) -> Self {
        let tracks = preset.animation.iter().filter(|track| !track.keys.is_empty());
        let states = tracks.map(|track| {
            let state = if key_at(track, time).is_some() { KeyState::Here } else { KeyState::Elsewhere };
            (track.setting.clone(), state)
        });
        Self { time, states: states.collect() }
    }

    pub fn of(&self, path: &str) -> KeyMark {
        KeyMark { state: self.states.get(path).copied().unwrap_or_default(), time: self.time }
    }
}

impl KeyMark {
    /// Returns the name of the action of a click, with the time.
    pub fn action(self) -> String {
        let verb = if self.state == KeyState::Here { "Delete" } else { "Add" };
        format!("{verb} Keyframe at {:.2} s", self.time)
    }
}

/// Draws a mark in `rect`, over existing content. Returns true if it was clicked. `name`: that of the row.
pub fn button(ui: &Ui, rect: Rect, id: egui::Id, mark: KeyMark, name: &str) -> bool {
    let response = ui.interact(rect, id, Sense::click());
    let action = mark.action();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{action}: {name}")));
    let visuals = ui.visuals();
    if response.hovered() {
        ui.painter().rect_filled(rect, 2.0, visuals.widgets.hovered.weak_bg_fill);
    }
    let color = if mark.state == KeyState::None { visuals.weak_text_color() } else { color() };
    diamond(ui.painter(), rect.center(), RADIUS, color, mark.state == KeyState::Here);
    response.on_hover_text(action).clicked()
}

/// Half the height of a diamond, points.
pub const RADIUS: f32 = 4.5;

/// Color of keyframes, legible on dark and bright panels.
pub const fn color() -> Color32 {
    Color32::from_rgb(232, 148, 32)
}

pub fn diamond(painter: &egui::Painter, center: egui::Pos2, radius: f32, color: Color32, is_filled: bool) {
    let corner = |x: f32, y: f32| center + radius * Vec2::new(x, y);
    let corners = vec![corner(0.0, -1.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.0)];
    let fill = if is_filled { color } else { Color32::TRANSPARENT };
    painter.add(Shape::convex_polygon(corners, fill, Stroke::new(1.3, color)));
}
