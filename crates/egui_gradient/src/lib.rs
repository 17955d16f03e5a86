//! An editor of gradients for egui: the stops of one row of a ramp's recipe, on a strip that shows what they make.
//!
//! A click on the strip adds a stop with the colour that is there; stops are dragged, nudged with the arrow keys (Shift: ten times
//! as far) and removed with Delete; Ctrl snaps to equal parts, tenths unless others are asked for, Shift to another
//! stop, Alt leaves a copy, or makes a drag ten times as fine where it is pressed on the way; Escape ends a drag as if it had not
//! begun. Handles of stops that are near each other stand apart, each can be grabbed.
//!
//! Several stops are selected as in lists: Shift and a click or the up and down keys for a range, Ctrl and a click for one more,
//! Ctrl and those keys with Space, Ctrl+A, or a band drawn below the strip. They are moved, coloured, removed, distributed, turned
//! round and mirrored together. Tab goes from stop to stop. Numbers may be typed as `+0.1` or `*2`.
//!
//! An eyedropper takes a colour from anywhere in the window, or a gradient along a stroke, with a magnifier and what would become
//! of the gradient beside it: the host must serve egui's requests for screenshots, as eframe does. `examples/gradient_editor.rs`
//! has one in a window.
//!
//! Undo is the host's: [`Edited::committed`] says when a step is done, however long its drag was.

mod controls;
mod eyedropper;
mod fan;
mod frame;
mod handles;
mod number;
mod paint;
mod sampled;
mod selection;
mod stops;
mod strip;
#[cfg(test)]
mod tests;
mod text;

use egui::{self, Ui};

pub use frame::Surroundings;
pub use paint::histogram;

use frame::{Frame, State};
use haze_author::ramp::bake::RampRow;

/// What became of a gradient in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edited {
    /// It is another than it was.
    pub is_changed: bool,
    /// What is being done, or was when the step is done: a name for undo.
    pub step: Option<&'static str>,
    /// The step is done, and what it was: a drag when it is let go, a number when it is typed. Not before that is a step for
    /// undo.
    pub committed: Option<&'static str>,
    /// What was typed or pasted in vain: what is wrong, and what would be right.
    pub refused: Option<String>,
    /// The place that is pointed at, 0 to 1.
    pub pointed_at: Option<f32>,
}

/// An editor of one gradient, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct GradientEditor {
    state: State,
}

impl GradientEditor {
    /// Shows the editor of a row and changes its stops; the row's own place is left alone. It takes the width that there is.
    pub fn show(&mut self, ui: &mut Ui, row: &mut RampRow, surroundings: &Surroundings<'_>) -> Edited {
        if !row.stops.is_sorted_by(|a, b| a.at <= b.at) {
            stops::sort(&mut row.stops);
        }
        let before = row.clone();
        self.state.selection.keep_to(row.stops.len());
        self.state.cursor = self.state.cursor.filter(|cursor| *cursor < row.stops.len());
        let mut edited = Edited::default();
        let (mut done, mut is_held) = (None, false);
        ui.push_id("gradient", |ui| {
            let at = before.at;
            let mut frame = Frame {
                editor: &mut self.state,
                stops: &mut row.stops,
                done: None,
                refused: None,
                wants_keyboard: false,
            };
            edited.pointed_at = strip::show(ui, &mut frame, surroundings);
            frame.clipboard(ui, at);
            // Before it can begin: the click that it begins with takes no colour.
            controls::take(ui, &mut frame, surroundings.blend);
            controls::show(ui, &mut frame, at);
            is_held = is_held_by(ui, frame.editor.has_keyboard);
            (edited.refused, done) = (frame.refused, frame.done);
        });
        edited.is_changed = *row != before;
        if edited.is_changed {
            self.state.pending = self.state.pending.or(done);
        }
        edited.step = self.state.pending;
        if !is_held {
            edited.committed = self.state.pending.take();
        }
        edited
    }

    /// A step is being made: what is changed is not committed yet.
    pub fn is_editing(&self) -> bool {
        self.state.pending.is_some()
    }

    /// What is pasted is for it: it was asked for, or one of its stops has the keyboard.
    pub fn takes_paste(&self) -> bool {
        self.state.has_keyboard || self.state.awaits_paste
    }
}

/// A pointer, a field or a key is not let go yet.
fn is_held_by(ui: &Ui, has_keyboard: bool) -> bool {
    let keys = [egui::Key::ArrowLeft, egui::Key::ArrowRight];
    let is_down = |input: &egui::InputState| {
        input.pointer.any_down() || has_keyboard && keys.iter().any(|key| input.key_down(*key))
    };
    ui.input(is_down) || ui.ctx().text_edit_focused()
}
