use std::path::Path;
use std::time::Duration;

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::template::Template;
use haze_preset::{CompressionEffort, Preset, write_png};

use crate::session::{CopiedImage, CopyRequest};
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window};

const SIZE: Vec2 = Vec2::new(1000.0, 640.0);

/// Inspects a pixel in the middle of the image, and returns its position.
fn inspect(harness: &mut Harness<'_, Window>) -> Pos2 {
    harness.key_press(Key::I);
    let position = harness.get_by_label("viewport").rect().center();
    harness.hover_at(position);
    for _ in 0..300 {
        screenshot(harness);
        if harness.query_all_by_label_contains("Coverage").next().is_some() {
            return position;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!("nothing came");
}

/// Drags with Ctrl held.
fn paint(harness: &mut Harness<'_, Window>, from: Pos2, way: Vec2) {
    let modifiers = Modifiers::COMMAND;
    let press = |pos, pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers };
    harness.event(Event::ModifiersChanged(modifiers));
    harness.event(press(from, true));
    for step in 1..=4 {
        harness.hover_at(from + way * (step as f32 / 4.0));
        harness.step();
    }
    harness.event(press(from + way, false));
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(3);
}

#[test]
fn a_drag_on_smoke_changes_its_brightness_in_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut preset = Preset::load("column").unwrap();
    preset.systems[0].material.diffuse_ramp = "mine.png".into();
    std::fs::write(path("own.json"), serde_json::to_string(&preset).unwrap()).unwrap();
    let recipe = Template::find("neutral").unwrap().recipe();
    std::fs::write(path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let on_disk = |path: &Path| RampRecipe::load(path).unwrap();

    let mut harness = window(path("own.json").to_str().unwrap(), SIZE, Theme::Dark);
    let camera = harness.state().session.document.preset.camera;
    let position = harness.get_by_label("viewport").rect().center();
    let around = Rect::from_center_size(position, Vec2::splat(16.0));
    let brightness = |harness: &mut Harness<'_, Window>| brightness(&screenshot(harness), around);
    let before = brightness(&mut harness);
    let painted = |harness: &mut Harness<'_, Window>, way: f32| {
        let position = inspect(harness);
        paint(harness, position, Vec2::new(0.0, way));
        // The values of the pixel would lie over it.
        harness.key_press(Key::I);
        harness.run_steps(2);
        brightness(harness)
    };
    let lighter = painted(&mut harness, -160.0);
    assert!(lighter > before + 8.0, "{before} {lighter}");
    assert_ne!(on_disk(&path("mine.ramp.json")), recipe);
    // The camera has not moved, and the step has a name.
    let document = &harness.state().session.document;
    assert_eq!(document.preset.camera, camera);
    assert_eq!(document.history().undo_name(), Some("Paint on smoke: mine.png"));
    let same = painted(&mut harness, 160.0);
    assert!((same - before).abs() < 4.0, "{before} {same}");
    for _ in 0..2 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
    }
    assert_eq!(on_disk(&path("mine.ramp.json")), recipe);
    assert!((brightness(&mut harness) - before).abs() < 0.5);
}

#[test]
fn a_built_in_ramp_is_copied_first() {
    let mut harness = window("column", SIZE, Theme::Dark);
    let position = inspect(&mut harness);
    paint(&mut harness, position, Vec2::new(0.0, 30.0));
    let request = harness.state().session.copy_request.clone();
    let is_ramp = |request: &CopyRequest| matches!(request.image, CopiedImage::Ramp("diffuse_ramp" | "backlight_ramp"));
    assert!(request.as_ref().is_some_and(is_ramp), "{request:?}");
}
