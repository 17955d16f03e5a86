//! State of the editor, and the context of one frame, shared by its parts.

use egui::{self, Color32, Ui};
use glam::Vec3;

use super::clipboard;
use super::eyedropper::Eyedropper;
use super::screenshot_sampling::SampleSize;
use super::selection::Selection;
use super::simplify::Simplified;
use haze_author::ramp::{Blend, HexColor, RampRow, RampStop};

/// State of an editor across frames.
#[derive(Clone, Debug, Default)]
pub struct EditorState {
    /// Selected stops, which keys and fields act on.
    pub selection: Selection,
    /// The stop with keyboard focus if it is not the lead. Space adds it to the selection or removes it.
    pub cursor: Option<usize>,
    /// The current drag of the selected stops.
    pub dragged: Option<Drag>,
    /// Start of a rubber-band selection, as a fraction of the strip.
    pub band: Option<f32>,
    pub snap: Snap,
    pub eyedropper: Option<Eyedropper>,
    /// Sample size of the eyedropper.
    pub sample_size: SampleSize,
    /// Last color set by hue, saturation and value, with these values: keeps the hue of grays, which have none.
    pub hsv: Option<(HexColor, Vec3)>,
    /// Name of the undo step in progress, until the pointer or key is released.
    pub pending: Option<&'static str>,
    /// True if a handle has keyboard focus.
    pub has_keyboard: bool,
    /// True if the clipboard's contents were requested.
    pub awaits_paste: bool,
    /// Simpler gradients, with the stops and the blend space that they were made from.
    pub simplified: Option<(Vec<RampStop>, Blend, Vec<Simplified>)>,
    /// Text of the color being typed.
    pub typed: Option<String>,
}

/// Stops with their selection.
pub type Selected = (Vec<RampStop>, Selection);

/// A drag in progress.
#[derive(Clone, Debug)]
pub struct Drag {
    /// Last pointer x, points.
    pub x: f32,
    /// Position of the lead before snapping and clamping.
    pub position: f32,
    /// Stops and selection when the drag began, including any stop that the drag added.
    pub from: Selected,
    /// Stops and selection before the drag, without any added stop. Escape restores them.
    pub before: Selected,
    /// Stops that the drag produced last. If the host's stops differ, after undo or loading another file, the drag
    /// ends.
    pub now: Vec<RampStop>,
    /// True if Alt makes the drag fine. If Alt began the drag with a copy, only after Alt was released once.
    pub alt_slows: bool,
}

/// Snapping of positions to equal parts. Ctrl inverts `is_on`.
#[derive(Clone, Copy, Debug)]
pub struct Snap {
    pub is_on: bool,
    pub parts: u32,
}

impl Default for Snap {
    fn default() -> Self {
        Self { is_on: false, parts: 10 }
    }
}

impl Snap {
    /// Returns the number of parts to snap to with these modifiers, if any.
    pub fn with(self, modifiers: egui::Modifiers) -> Option<u32> {
        (self.is_on != modifiers.command).then_some(self.parts)
    }

    /// Returns the number of parts to snap to with the current modifiers, if any.
    pub fn now(self, ui: &Ui) -> Option<u32> {
        self.with(ui.input(|input| input.modifiers))
    }
}

/// Display options of a gradient besides its stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct DisplayOptions<'a> {
    /// Color space for blending.
    pub blend: Blend,
    /// Histograms of lookups along the gradient, heights 0 to 1, drawn below the strip in the given colors.
    pub histograms: &'a [(Color32, &'a [f32])],
    /// Marked positions on the gradient, 0 to 1.
    pub marks: &'a [(f32, Color32)],
}

/// Context of one frame of an editor.
pub struct EditContext<'a> {
    pub editor: &'a mut EditorState,
    pub stops: &'a mut Vec<RampStop>,
    /// Name of the frame's first edit.
    pub done: Option<&'static str>,
    pub refused: Option<String>,
    /// True to give keyboard focus to the cursor or the lead.
    pub requests_focus: bool,
}

/// Undo names of edits, for one stop and for several.
pub const RECOLOR: [&str; 2] = ["color of a stop", "color of stops"];
pub const REMOVE: [&str; 2] = ["remove a stop", "remove stops"];
pub const MOVE: [&str; 2] = ["move a stop", "move stops"];

impl EditContext<'_> {
    /// Applies an edit and records its name.
    pub fn edit<T>(&mut self, what: &'static str, change: impl FnOnce(&mut Vec<RampStop>, &mut Selection) -> T) -> T {
        self.done.get_or_insert(what);
        self.editor.cursor = None;
        change(self.stops, &mut self.editor.selection)
    }

    /// Applies an edit whose name depends on whether one or several stops are selected.
    pub fn edit_selected<T>(
        &mut self,
        [one, many]: [&'static str; 2],
        change: impl FnOnce(&mut Vec<RampStop>, &mut Selection) -> T,
    ) -> T {
        self.edit(if self.editor.selection.is_many() { many } else { one }, change)
    }

    /// Changes each selected stop.
    pub fn edit_each(&mut self, names: [&'static str; 2], mut change: impl FnMut(&mut RampStop)) {
        self.edit_selected(names, |all, selection| {
            for index in selection.iter() {
                if let Some(stop) = all.get_mut(index) {
                    change(stop);
                }
            }
        });
    }

    /// Sets the color of the selected stops.
    pub fn recolor(&mut self, color: HexColor) {
        self.edit_each(RECOLOR, |stop| stop.color = color);
    }

    /// Replaces all stops.
    pub fn replace(&mut self, what: &'static str, stops: Vec<RampStop>) {
        self.edit(what, |all, selection| {
            *all = stops;
            *selection = Selection::default();
        });
    }

    /// Returns the lead: the stop whose values the fields show.
    pub fn lead(&self) -> Option<&RampStop> {
        self.stops.get(self.editor.selection.lead())
    }

    /// Selects only this stop, or with Shift extends the range to it, or with Ctrl toggles it.
    pub fn select(&mut self, index: usize, modifiers: egui::Modifiers) {
        self.editor.cursor = None;
        let selection = &mut self.editor.selection;
        if modifiers.shift {
            selection.extend_to(index);
        } else if modifiers.command {
            selection.toggle(index);
        } else {
            *selection = Selection::one(index);
        }
    }

    /// Cancels the drag: restores the state before it, without an undo step.
    pub fn cancel_drag(&mut self) {
        if let Some(Drag { before, .. }) = self.editor.dragged.take() {
            (*self.stops, self.editor.selection) = before;
            self.editor.pending = None;
            self.done = None;
        }
    }

    /// Handles copy if a handle has keyboard focus, and paste if a handle has focus or a paste was requested.
    pub fn clipboard(&mut self, ui: &Ui, at: f32) {
        if !self.editor.has_keyboard && !self.editor.awaits_paste {
            return;
        }
        let mut copies = false;
        let mut pasted = None;
        if ui.input(|input| input.pointer.any_pressed()) {
            // No paste arrived, for example because the clipboard has no text.
            self.editor.awaits_paste = false;
        }
        ui.input_mut(|input| {
            input.events.retain(|event| {
                match event {
                    egui::Event::Copy if self.editor.has_keyboard => copies = true,
                    egui::Event::Paste(text) => pasted = Some(text.clone()),
                    _ => return true,
                }
                false
            });
        });
        if copies {
            self.copy(ui, at);
        }
        if let Some(pasted) = pasted {
            self.editor.awaits_paste = false;
            match (clipboard::color(&pasted), clipboard::parse(&pasted)) {
                (Ok(color), _) => self.recolor(color),
                (_, Ok(stops)) => self.replace("paste stops", stops),
                (_, Err(error)) => self.refused = Some(format!("Cannot paste: {error}")),
            }
        }
    }

    pub fn copy(&self, ui: &Ui, at: f32) {
        let row = RampRow { at, stops: self.stops.clone(), ..RampRow::default() };
        ui.ctx().copy_text(clipboard::to_json(&row));
    }
}
