//! What the parts of the editor share: its state, and the stops in one frame.

use egui::{self, Color32, Ui};
use glam::Vec3;

use super::eyedropper::Eyedropper;
use super::sampled::Across;
use super::selection::Selection;
use super::text;
use haze_author::ramp::bake::{Blend, HexColour, RampRow, RampStop};

/// What an editor remembers from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// The stops that keys and fields are for.
    pub selection: Selection,
    /// The stop that has the keyboard where that is not the lead: to be added to the selection, or taken out.
    pub cursor: Option<usize>,
    /// What is dragged: what is selected.
    pub dragged: Option<Drag>,
    /// Where a band began that selects what is under it, in shares of the strip.
    pub band: Option<f32>,
    pub snap: Snap,
    pub eyedropper: Option<Eyedropper>,
    /// How many pixels it takes the mean of.
    pub across: Across,
    /// A colour as hue, saturation and value: greys have no hue of their own, and it is not forgotten.
    pub hsv: Option<(HexColour, Vec3)>,
    /// What is being done, until it is let go.
    pub pending: Option<&'static str>,
    /// A handle has the keyboard.
    pub has_keyboard: bool,
    /// The clipboard was asked for.
    pub awaits_paste: bool,
    /// The colour that is being typed.
    pub typed: Option<String>,
}

/// Stops, and which of them are selected.
pub type Selected = (Vec<RampStop>, Selection);

/// A drag on its way.
#[derive(Clone, Debug)]
pub struct Drag {
    /// Where the pointer was last, across.
    pub x: f32,
    /// Where the lead would be, did it not snap nor end at the gradient's ends.
    pub place: f32,
    /// What is moved, as it was before.
    pub from: Selected,
    /// What Escape puts back: the same, but for what the drag began with by adding it.
    pub before: Selected,
    /// What it has come to. Where the host has something else, by undo or another file, that is the end of it.
    pub now: Vec<RampStop>,
    /// Alt makes it fine: where it began with a copy, once that is let go.
    pub is_alt_free: bool,
}

/// How many equal parts places snap to, and whether they do without Ctrl, which turns it round.
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
    /// The parts to snap to with these keys held, if any.
    pub fn with(self, modifiers: egui::Modifiers) -> Option<u32> {
        (self.is_on != modifiers.command).then_some(self.parts)
    }

    /// The same now.
    pub fn now(self, ui: &Ui) -> Option<u32> {
        self.with(ui.input(|input| input.modifiers))
    }
}

/// What is shown of a gradient beside its stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surroundings<'a> {
    /// The space that its colours are blended in.
    pub blend: Blend,
    /// How often each part of it is looked up, from 0 to 1, drawn below the strip in their colours.
    pub histograms: &'a [(Color32, &'a [f32])],
    /// Places on it that are marked.
    pub marks: &'a [(f32, Color32)],
}

/// What one frame of an editor works on.
pub struct Frame<'a> {
    pub editor: &'a mut State,
    pub stops: &'a mut Vec<RampStop>,
    /// What was done in it first.
    pub done: Option<&'static str>,
    pub refused: Option<String>,
    /// The lead, or the cursor, is to have it.
    pub wants_keyboard: bool,
}

/// What steps are called, of one stop and of several.
pub const RECOLOUR: [&str; 2] = ["colour of a stop", "colour of stops"];
pub const REMOVE: [&str; 2] = ["remove a stop", "remove stops"];
pub const MOVE: [&str; 2] = ["move a stop", "move stops"];

impl Frame<'_> {
    /// Makes a change, and notes what it was.
    pub fn edit<T>(&mut self, what: &'static str, change: impl FnOnce(&mut Vec<RampStop>, &mut Selection) -> T) -> T {
        self.done.get_or_insert(what);
        self.editor.cursor = None;
        change(self.stops, &mut self.editor.selection)
    }

    /// The same, called one thing of one stop and another of several.
    pub fn edit_selected<T>(
        &mut self,
        [one, many]: [&'static str; 2],
        change: impl FnOnce(&mut Vec<RampStop>, &mut Selection) -> T,
    ) -> T {
        self.edit(if self.editor.selection.is_many() { many } else { one }, change)
    }

    /// Changes each stop that is selected.
    pub fn edit_each(&mut self, names: [&'static str; 2], mut change: impl FnMut(&mut RampStop)) {
        self.edit_selected(names, |all, selection| {
            selection.iter().for_each(|index| all.get_mut(index).into_iter().for_each(&mut change));
        });
    }

    /// Gives what is selected another colour.
    pub fn recolour(&mut self, colour: HexColour) {
        self.edit_each(RECOLOUR, |stop| stop.colour = colour);
    }

    /// Takes other stops for all of them.
    pub fn replace(&mut self, what: &'static str, stops: Vec<RampStop>) {
        self.edit(what, |all, selection| (*all, *selection) = (stops, Selection::default()));
    }

    /// The stop that fields show.
    pub fn lead(&self) -> Option<&RampStop> {
        self.stops.get(self.editor.selection.lead())
    }

    /// Selects a stop alone, draws what is selected out to it, or adds it, as lists do.
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

    /// Puts everything back to what it was before the drag, which is no step then.
    pub fn give_up(&mut self) {
        if let Some(Drag { before, .. }) = self.editor.dragged.take() {
            (*self.stops, self.editor.selection) = before;
            (self.editor.pending, self.done) = (None, None);
        }
    }

    /// Copies for the stop that has the keyboard; takes what comes for it, or was asked for.
    pub fn clipboard(&mut self, ui: &Ui, at: f32) {
        if !self.editor.has_keyboard && !self.editor.awaits_paste {
            return;
        }
        let (mut copies, mut pasted) = (false, None);
        if ui.input(|input| input.pointer.any_pressed()) {
            // Nothing came, as where the clipboard has no text.
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
            match (text::colour(&pasted), text::parse(&pasted)) {
                (Ok(colour), _) => self.recolour(colour),
                (_, Ok(stops)) => self.replace("paste stops", stops),
                (_, Err(error)) => self.refused = Some(format!("nothing is pasted: {error}")),
            }
        }
    }

    pub fn copy(&self, ui: &Ui, at: f32) {
        let row = RampRow { at, stops: self.stops.clone(), ..RampRow::default() };
        ui.ctx().copy_text(text::to_text(&row));
    }
}
