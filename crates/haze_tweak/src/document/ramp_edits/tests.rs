//! Edits of stops in the window: shown at once, written with each step, superseded by changes from outside.

mod ramp_image_files;

use std::path::{Path, PathBuf};
use std::time::Duration;

use eframe::egui::{Event, Key, Modifiers, Rect, Role, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze_author::ramp::lint::lint_ramp;
use haze_author::ramp::template::Template;
use haze_author::ramp::{Blend, Curve, HexColor, RampRecipe, RampRow, RampStop};
use haze_core::assets::image::read_color_png;
use haze_core::assets::ramp::Ramp;
use haze_core::settings::DebugView;
use haze_preset::{AssetFolders, CompressionEffort, Preset, write_png};

use super::{RampEdits, RampOrigin};
use crate::document::Document;
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window};

/// Folder with a preset whose diffuse ramp is `mine.png`, made from a recipe beside it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let mut preset = Preset::load("column").unwrap();
        preset.systems[0].material.diffuse_ramp = "mine.png".into();
        // In shadow, or beside other light, that of the ramp hardly shows on the far side.
        preset.systems[0].settings.shadow.strength = 0.0;
        preset.systems[0].settings.ambient.intensity = 0.0;
        preset.systems[0].settings.diffuse.intensity = 3.0;
        std::fs::write(folder.preset(), serde_json::to_string(&preset).unwrap()).unwrap();
        let recipe = Template::find("neutral").unwrap().recipe();
        std::fs::write(folder.path("mine.ramp.json"), recipe.to_json()).unwrap();
        write_png(&folder.path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn preset(&self) -> PathBuf {
        self.path("own.json")
    }

    fn recipe(&self) -> RampRecipe {
        RampRecipe::load(&self.path("mine.ramp.json")).unwrap()
    }

    /// Returns true if the image equals the one that the recipe makes.
    fn is_baked(&self) -> bool {
        Ramp::load(&self.path("mine.png")).unwrap() == Ramp::from_image(&self.recipe().bake().unwrap())
    }

    fn open(&self) -> Harness<'static, Window> {
        ramps_of(self.preset().to_str().unwrap())
    }
}

fn ramps_of(preset: &str) -> Harness<'static, Window> {
    let mut harness = window(preset, Vec2::new(1280.0, 800.0), Theme::Dark);
    harness.get_by_label("Ramps").click();
    harness.run_steps(5);
    harness
}

fn click(harness: &mut Harness<'_, Window>, name: &str) {
    harness.get_by_label(name).click_accesskit();
    harness.run_steps(4);
}

fn strip(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("gradient: add a stop").rect()
}

/// Waits for the background reload.
fn wait(harness: &mut Harness<'_, Window>) {
    for _ in 0..40 {
        harness.step();
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn shown(harness: &mut Harness<'_, Window>) -> f64 {
    let part = harness.get_by_label("viewport").rect();
    brightness(&screenshot(harness), part)
}

fn press(harness: &mut Harness<'_, Window>, key: Key, modifiers: Modifiers) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(4);
}

#[test]
fn a_drag_is_shown_at_once_and_written_at_its_end() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = (folder.recipe(), shown(&mut harness));
    let from = harness.get_by_label("stop 3").rect().center();
    let width = strip(&harness).width();
    harness.drag_at(from);
    for part in 1..=4 {
        harness.hover_at(from - Vec2::new(0.2 * width * part as f32, 0.0));
        harness.step();
    }
    let bright = shown(&mut harness);
    assert!(bright > before.1 + 1.0, "{} {bright}", before.1);
    assert_eq!(folder.recipe(), before.0, "nothing is written on the way");
    harness.drop_at(from - Vec2::new(0.8 * width, 0.0));
    harness.run_steps(4);
    let after = folder.recipe();
    assert!(after.rows[0].stops.iter().any(|stop| (stop.at - 0.2).abs() < 0.01), "{after:?}");
    assert!(folder.is_baked());
    // It is one named step, and undo also writes the file.
    let undo_name =
        |harness: &Harness<'_, Window>| harness.state().session.document.history().undo_name().map(str::to_owned);
    assert_eq!(undo_name(&harness).as_deref(), Some("Move a stop: mine.png"));
    wait(&mut harness);
    assert!((shown(&mut harness) - bright).abs() < 0.5, "read again it is the same");
    press(&mut harness, Key::Z, Modifiers::COMMAND);
    assert_eq!((folder.recipe(), undo_name(&harness)), (before.0, None));
    assert!(folder.is_baked());
    assert!((shown(&mut harness) - before.1).abs() < 0.5);
    press(&mut harness, Key::Z, Modifiers::COMMAND.plus(Modifiers::SHIFT));
    assert_eq!(folder.recipe(), after);
    assert!(!harness.state().session.document.is_dirty(), "the preset is as it was");
}

#[test]
fn a_cancelled_drag_is_no_step() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = (folder.recipe(), shown(&mut harness));
    let from = harness.get_by_label("stop 3").rect().center();
    let width = strip(&harness).width();
    harness.state_mut().session.view.debug_view = DebugView::Diffuse;
    harness.drag_at(from);
    for part in 1..=4 {
        harness.hover_at(from - Vec2::new(0.2 * width * part as f32, 0.0));
        harness.step();
    }
    press(&mut harness, Key::Escape, Modifiers::NONE);
    harness.drop_at(from);
    wait(&mut harness);
    // Escape ends the drag only.
    assert_eq!(harness.state().session.view.debug_view, DebugView::Diffuse);
    harness.state_mut().session.view.debug_view = DebugView::Final;
    assert_eq!((folder.recipe(), harness.state().session.document.history().undo_name()), (before.0, None));
    assert!((shown(&mut harness) - before.1).abs() < 0.5);
}

#[test]
fn rows_of_a_two_axis_ramp_can_be_selected() {
    let folder = Folder::new();
    let mut preset = Preset::load("backlit_fog").unwrap();
    preset.systems[0].material.specular_ramp = "mine.png".into();
    std::fs::write(folder.preset(), serde_json::to_string(&preset).unwrap()).unwrap();
    let row = |at: f32| {
        let mut row = Template::find("neutral").unwrap().recipe().rows.remove(0);
        row.at = at;
        row
    };
    let recipe = RampRecipe { width: 32, height: 16, rows: vec![row(0.0), row(1.0)], ..RampRecipe::default() };
    std::fs::write(folder.path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&folder.path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    harness.get_by_label("1.00").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label("Flip").click_accesskit();
    harness.run_steps(4);
    let [first, second] = &folder.recipe().rows[..] else { panic!("two rows") };
    assert_eq!(*first, row(0.0));
    assert_ne!(*second, row(1.0));
    assert!(folder.is_baked());
}

#[test]
fn rows_and_their_multiplier_are_edited_in_the_window() {
    let folder = Folder::new();
    let mut preset = Preset::load("backlit_fog").unwrap();
    preset.systems[0].material.specular_ramp = "mine.png".into();
    std::fs::write(folder.preset(), serde_json::to_string(&preset).unwrap()).unwrap();
    let recipe = Template::find("neutral_glow").unwrap().recipe();
    assert!(recipe.rows.len() == 1 && !recipe.times.is_empty());
    std::fs::write(folder.path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&folder.path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    click(&mut harness, "Add row");
    let [first, second] = &folder.recipe().rows[..] else { panic!("two rows") };
    assert!((first.at, second.at) == (0.0, 0.5) && first.stops == second.stops);
    // The new row is the edited one.
    click(&mut harness, "Flip");
    assert_eq!(folder.recipe().rows[0], recipe.rows[0]);
    assert_ne!(folder.recipe().rows[1].stops, recipe.rows[0].stops);
    click(&mut harness, "Multiplier");
    click(&mut harness, "Flip");
    assert_ne!(folder.recipe().times, recipe.times);
    assert!(folder.is_baked());
    click(&mut harness, "0.50");
    click(&mut harness, "Remove row");
    assert_eq!(folder.recipe().rows, recipe.rows);
    for _ in 0..4 {
        press(&mut harness, Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(folder.recipe(), recipe, "each was a step");
}

#[test]
fn stops_are_pasted_into_a_focused_editor_and_presets_elsewhere() {
    let folder = Folder::new();
    let mut harness = folder.open();
    harness.get_by_label("stop 1").focus();
    harness.run_steps(3);
    let text = r##"{ "stops": [{ "at": 0.5, "color": "#804020" }] }"##;
    harness.event(Event::Paste(text.into()));
    harness.run_steps(4);
    assert_eq!(folder.recipe().rows[0].stops.len(), 1);
    assert!(harness.state().session.messages.latest().is_none_or(|message| !message.is_error));
    let preset = Preset::load("backlit_fog").unwrap();
    harness.get_by_label("Look").click();
    harness.run_steps(3);
    harness.event(Event::Paste(serde_json::to_string(&preset).unwrap()));
    harness.run_steps(4);
    assert_eq!(harness.state().session.document.preset.name, preset.name);
}

#[test]
fn a_stop_takes_a_color_from_the_image() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let pixel = harness.get_by_label("viewport").rect().center();
    let camera = harness.state().session.document.preset.camera;
    let [r, g, b, _] = screenshot(&mut harness).get_pixel(pixel.x as u32, pixel.y as u32).0;
    harness.get_by_label("Pick color").click();
    wait(&mut harness);
    harness.hover_at(pixel);
    harness.step();
    harness.drag_at(pixel);
    harness.step();
    harness.drop_at(pixel);
    wait(&mut harness);
    let taken = folder.recipe().rows[0].stops[0].color.0;
    assert!(taken.iter().zip([r, g, b]).all(|(a, b)| a.abs_diff(b) < 3), "{taken:?} {:?}", [r, g, b]);
    assert_ne!(taken, Template::find("neutral").unwrap().recipe().rows[0].stops[0].color.0);
    assert!(folder.is_baked());
    assert_eq!(harness.state().session.document.history().undo_name(), Some("Color of a stop: mine.png"));
    // The eyedropper takes the click and Escape; the viewport does not react.
    assert_eq!(harness.state().session.document.preset.camera, camera);
    harness.state_mut().session.view.debug_view = DebugView::Normals;
    harness.get_by_label("Pick color").click();
    harness.run_steps(2);
    press(&mut harness, Key::Escape, Modifiers::NONE);
    assert_eq!(harness.state().session.view.debug_view, DebugView::Normals);
    press(&mut harness, Key::Z, Modifiers::COMMAND);
    assert_ne!(folder.recipe().rows[0].stops[0].color.0, taken);
}

/// `HAZE_LOOK=DIR` names the folder to write to.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_the_gradient_editor() {
    let into = PathBuf::from(std::env::var_os("HAZE_LOOK").unwrap());
    let folder = Folder::new();
    let mut harness = folder.open();
    for theme in [Theme::Dark, Theme::Light] {
        harness.ctx.set_theme(theme);
        harness.get_by_label("stop 2").focus();
        wait(&mut harness);
        screenshot(&mut harness).save(into.join(format!("ramps_own_{theme:?}.png"))).unwrap();
    }
}

#[test]
fn one_click_turns_on_a_ramp_that_is_not_used() {
    let mut harness = ramps_of("column");
    assert_eq!(harness.state().session.document.preset.systems[0].settings.diffuse.backlight.name(), "same");
    click(&mut harness, "Turn on backlight ramp: Backlight ramp");
    assert_eq!(harness.state().session.document.preset.systems[0].settings.diffuse.backlight.name(), "ramp");
    assert!(harness.query_by_label("Turn on backlight ramp: Backlight ramp").is_none());
    let undo = harness.state().session.document.history().undo_name().map(str::to_owned);
    assert_eq!(undo.as_deref(), Some("Backlight of smoke"));
}

#[test]
fn a_gradient_is_dragged_from_one_ramp_onto_another() {
    let folder = Folder::new();
    let mut harness = folder.open();
    harness.state_mut().session.document.preset.systems[0].settings.diffuse.backlight =
        haze_core::settings::Backlight::Ramp;
    harness.run_steps(5);
    let name = harness.state().session.document.preset.systems[0].material.backlight_ramp.clone();
    let from = harness.get_by_label(&format!("Drag to copy: {name}")).rect().center();
    let to = strip(&harness).center();
    let before = folder.recipe();
    harness.hover_at(from);
    harness.run_steps(2);
    harness.drag_at(from);
    harness.run_steps(2);
    for fraction in [0.2, 0.6, 1.0] {
        harness.hover_at(from + fraction * (to - from));
        harness.run_steps(2);
    }
    harness.drop_at(to);
    harness.run_steps(5);
    let source = haze_preset::builtin::find(haze_preset::builtin::RAMPS, &name).unwrap();
    let source = RampRecipe::parse(Path::new(""), source.recipe).unwrap();
    assert_eq!(folder.recipe().rows[0].stops, source.rows[0].stops);
    assert!(folder.is_baked());
    assert_eq!(harness.state().session.document.history().undo_name(), Some("Copy a gradient: mine.png"));
    harness.state_mut().session.undo();
    harness.run_steps(5);
    assert_eq!(folder.recipe(), before);
}
