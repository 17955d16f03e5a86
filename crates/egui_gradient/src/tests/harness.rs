//! Test window with an editor, and input by pointer and keys.

use egui::{Color32, Event, Key, Modifiers, PointerButton, Pos2, Rect, Theme, Ui, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

use crate::{DisplayOptions, GradientEditor};
use haze_author::ramp::{HexColor, RampRow, RampStop};

/// An editor, and the results that its host has received.
#[derive(Default)]
pub struct Host {
    pub editor: GradientEditor,
    pub row: RampRow,
    pub steps: Vec<&'static str>,
    pub changes: usize,
    pub refused: Vec<String>,
    pub pointed_at: Option<f32>,
}

pub fn host(stops: &[(f32, u8)]) -> Harness<'static, Host> {
    let stop = |&(at, gray): &(f32, u8)| RampStop::new(at, HexColor([gray; 3]));
    let row = RampRow { at: 0.5, stops: stops.iter().map(stop).collect(), ..RampRow::default() };
    let show = |ui: &mut Ui, host: &mut Host| {
        let bins = [0.0, 1.0, 0.25];
        let histograms: &[(Color32, &[f32])] = &[(Color32::GRAY, &bins)];
        let options = DisplayOptions { histograms, ..DisplayOptions::default() };
        let edited = host.editor.show(ui, &mut host.row, &options);
        host.changes += usize::from(edited.is_changed);
        host.steps.extend(edited.committed);
        host.refused.extend(edited.refused);
        host.pointed_at = edited.pointed_at;
    };
    let mut harness = Harness::builder()
        .with_size(Vec2::new(330.0, 260.0))
        .with_theme(Theme::Dark)
        .with_render_cursor(false)
        .build_ui_state(show, Host { row, ..Host::default() });
    harness.run_steps(3);
    harness
}

pub fn positions(harness: &Harness<'_, Host>) -> Vec<f32> {
    harness.state().row.stops.iter().map(|stop| (stop.at * 1000.0).round() / 1000.0).collect()
}

pub fn grays(harness: &Harness<'_, Host>) -> Vec<u8> {
    harness.state().row.stops.iter().map(|stop| stop.color.0[0]).collect()
}

pub fn steps(harness: &Harness<'_, Host>) -> Vec<&'static str> {
    harness.state().steps.clone()
}

pub fn strip(harness: &Harness<'_, Host>) -> Rect {
    harness.get_by_label("gradient: add a stop").rect()
}

/// Returns the screen position of a position on the strip, 0 to 1.
pub fn on_strip(harness: &Harness<'_, Host>, at: f32) -> Pos2 {
    let strip = strip(harness);
    pos2(strip.left() + at * strip.width(), strip.top() + 8.0)
}

pub fn handle(harness: &Harness<'_, Host>, index: usize) -> Rect {
    harness.get_by_label(&format!("stop {}", index + 1)).rect()
}

pub fn button(harness: &mut Harness<'_, Host>, pos: Pos2, pressed: bool, modifiers: Modifiers) {
    harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers });
    harness.step();
}

pub fn drag(harness: &mut Harness<'_, Host>, from: Pos2, by: f32, modifiers: Modifiers) {
    harness.hover_at(from);
    // Modifiers are held during the whole drag.
    harness.event(Event::ModifiersChanged(modifiers));
    harness.step();
    button(harness, from, true, modifiers);
    for part in 1..=4 {
        harness.hover_at(from + Vec2::new(by * part as f32 / 4.0, 0.0));
        harness.step();
    }
    button(harness, from + Vec2::new(by, 0.0), false, modifiers);
    harness.event(Event::ModifiersChanged(NONE));
    harness.run_steps(2);
}

pub fn click(harness: &mut Harness<'_, Host>, pos: Pos2, modifiers: Modifiers) {
    harness.hover_at(pos);
    harness.event(Event::ModifiersChanged(modifiers));
    harness.step();
    for pressed in [true, false] {
        button(harness, pos, pressed, modifiers);
    }
    harness.event(Event::ModifiersChanged(NONE));
    harness.run_steps(2);
}

pub fn key(harness: &mut Harness<'_, Host>, key: Key, modifiers: Modifiers) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

pub const NONE: Modifiers = Modifiers::NONE;
