//! Gradient editor for egui. Edits the stops of one row of a ramp recipe on a strip that shows the gradient.
//!
//! A click on the strip adds a stop with the color at that position. Stops are dragged, nudged with the arrow keys
//! (Shift: ten times as far) and removed with Delete. During a drag, Ctrl snaps to equal parts (ten by default), Shift
//! snaps to another stop, and Alt slows the drag to a tenth. A drag that begins with Alt moves a copy. Escape cancels a
//! drag. Handles of stops that are close together are spread out, so that each can be grabbed.
//!
//! Several stops are selected as in lists: Shift with a click or the up and down keys selects a range; Ctrl with a
//! click, or Ctrl with the up and down keys and Space, toggles one stop; Ctrl+A selects all; a drag below the strip
//! selects the stops in its range. Selected stops are moved, colored, removed, distributed, flipped and mirrored
//! together. Tab moves from stop to stop. Number fields accept changes such as `+0.1` or `*2`.
//!
//! An eyedropper picks a color from anywhere in the window, or a gradient along a stroke, with a magnifier and a
//! preview of the gradient. The host must serve egui's screenshot requests, as eframe does.
//! `examples/gradient_editor.rs` shows an editor in a window.
//!
//! The host implements undo: [`GradientResponse::committed`] names each completed step. A whole drag is one step.

mod clipboard;
mod controls;
mod edit_context;
mod eyedropper;
mod gradient_strip;
mod handle_layout;
mod handles;
mod number;
mod paint;
mod screenshot_sampling;
mod selection;
mod simplify;
mod stop_operations;
#[cfg(test)]
mod tests;

use egui::{self, Ui};

pub use clipboard::color as parse_color;
pub use controls::sentence_case;
pub use edit_context::DisplayOptions;
pub use eyedropper::ColorEyedropper;
pub use paint::histogram;

use edit_context::{EditContext, EditorState};
use haze_author::ramp::RampRow;

/// Changes to a gradient in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradientResponse {
    /// True if the gradient changed in this frame.
    pub is_changed: bool,
    /// Name of the undo step in progress, or of the step completed in this frame.
    pub step: Option<&'static str>,
    /// Name of the undo step completed in this frame: a drag when it is released, a number when it is entered. The host
    /// should record an undo step only then.
    pub committed: Option<&'static str>,
    /// Error message for rejected typed or pasted text.
    pub refused: Option<String>,
    /// Position under the pointer, 0 to 1.
    pub pointed_at: Option<f32>,
}

/// Editor of one gradient. Keep it across frames.
#[derive(Clone, Debug, Default)]
pub struct GradientEditor {
    state: EditorState,
}

impl GradientEditor {
    /// Shows the editor of a row, at the available width, and edits its stops. The row's own position and curve stay
    /// unchanged.
    pub fn show(&mut self, ui: &mut Ui, row: &mut RampRow, options: &DisplayOptions<'_>) -> GradientResponse {
        if !row.stops.is_sorted_by(|a, b| a.at <= b.at) {
            stop_operations::sort(&mut row.stops);
        }
        let before = row.clone();
        self.state.selection.clamp_to(row.stops.len());
        self.state.cursor = self.state.cursor.filter(|cursor| *cursor < row.stops.len());
        let mut edited = GradientResponse::default();
        let mut done = None;
        let mut is_held = false;
        ui.push_id("gradient", |ui| {
            let at = before.at;
            let mut context = EditContext {
                editor: &mut self.state,
                stops: &mut row.stops,
                done: None,
                refused: None,
                requests_focus: false,
            };
            edited.pointed_at = gradient_strip::show(ui, &mut context, options);
            context.clipboard(ui, at);
            // Before the controls, so that the click that activates the eyedropper picks no color.
            controls::update_eyedropper(ui, &mut context, options.blend);
            controls::show(ui, &mut context, at, options.blend);
            is_held = is_interacting(ui, context.editor.has_keyboard);
            edited.refused = context.refused;
            done = context.done;
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

    /// True if an undo step is in progress and not yet committed.
    pub fn is_editing(&self) -> bool {
        self.state.pending.is_some()
    }

    /// True if the editor handles paste events: a paste was requested, or one of its stops has keyboard focus.
    pub fn takes_paste(&self) -> bool {
        self.state.has_keyboard || self.state.awaits_paste
    }
}

/// True while a pointer button or arrow key is down, or a text field is being edited.
fn is_interacting(ui: &Ui, has_keyboard: bool) -> bool {
    let keys = [egui::Key::ArrowLeft, egui::Key::ArrowRight];
    let is_down = |input: &egui::InputState| {
        input.pointer.any_down() || has_keyboard && keys.iter().any(|key| input.key_down(*key))
    };
    ui.input(is_down) || ui.ctx().text_edit_focused()
}
