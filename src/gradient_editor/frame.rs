//! What the parts of the editor share: its state, and the stops in one frame.

use eframe::egui::{self, Color32, Ui};
use glam::Vec3;

use super::eyedropper::Eyedropper;
use super::text;
use crate::assets::ramp::bake::{Blend, HexColour, RampRow, RampStop};

/// What an editor remembers from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Index of the stop that keys and fields are for.
    pub selected: usize,
    /// What is dragged: the selected one.
    pub dragged: Option<Drag>,
    pub snap: Snap,
    pub eyedropper: Option<Eyedropper>,
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

/// A drag on its way.
#[derive(Clone, Debug)]
pub struct Drag {
    /// From the pointer to the stop, in shares of the strip.
    pub offset: f32,
    /// What it is put back to by Escape: the stops, and which was selected.
    pub before: (Vec<RampStop>, usize),
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
    /// The selected one is to have it.
    pub wants_keyboard: bool,
}

impl Frame<'_> {
    /// Makes a change, and notes what it was.
    pub fn edit<T>(&mut self, what: &'static str, change: impl FnOnce(&mut Vec<RampStop>, usize) -> T) -> T {
        self.done.get_or_insert(what);
        change(self.stops, self.editor.selected)
    }

    /// The same where the selected stop is another then.
    pub fn edit_and_select(&mut self, what: &'static str, change: impl FnOnce(&mut Vec<RampStop>, usize) -> usize) {
        self.editor.selected = self.edit(what, change);
    }

    /// Gives the selected stop another colour.
    pub fn recolour(&mut self, colour: HexColour) {
        self.edit("colour of a stop", |all, index| {
            if let Some(stop) = all.get_mut(index) {
                stop.colour = colour;
            }
        });
    }

    /// Takes other stops for all of them.
    pub fn replace(&mut self, what: &'static str, stops: Vec<RampStop>) {
        self.edit_and_select(what, |all, _| {
            *all = stops;
            0
        });
    }

    /// Puts everything back to what it was before the drag, which is no step then.
    pub fn give_up(&mut self) {
        if let Some(Drag { before, .. }) = self.editor.dragged.take() {
            (*self.stops, self.editor.selected) = before;
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
