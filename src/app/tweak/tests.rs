//! The whole window: what is done to a control is seen in the picture.

use eframe::egui::{Key, Modifiers, Rect, Role, Theme, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, SnapshotOptions};

use super::testing::{brightness, picture, window};
use super::window::Window;

const SIZE: Vec2 = Vec2::new(1000.0, 640.0);

fn column() -> Harness<'static, Window> {
    window("column", SIZE, Theme::Dark)
}

/// Where the picture is.
fn viewport(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("viewport").rect()
}

/// Brightness of the picture.
fn shown(harness: &mut Harness<'_, Window>) -> f64 {
    let part = viewport(harness);
    brightness(&picture(harness), part)
}

/// Types a number into the row of this name.
fn set(harness: &mut Harness<'_, Window>, name: &str, value: f64) {
    harness
        .get_all_by_label(name)
        .find(|node| node.accesskit_node().role() == Role::Slider)
        .unwrap()
        .set_value_accesskit(value);
    harness.run_steps(3);
}

/// Drivers round smoke a step this way or that.
fn compare(theme: Theme, name: &str) {
    let mut harness = window("column", SIZE, theme);
    harness.snapshot_options(name, &SnapshotOptions::new().threshold(2.0).max_failed_pixels(2000));
}

#[test]
fn the_window_looks_as_it_did_in_the_dark() {
    compare(Theme::Dark, "window_dark");
}

#[test]
fn the_window_looks_as_it_did_in_the_light() {
    compare(Theme::Light, "window_light");
}

#[test]
fn controls_change_the_picture_the_way_they_say() {
    let mut harness = column();
    let before = shown(&mut harness);
    set(&mut harness, "exposure", 2.0);
    let brighter = shown(&mut harness);
    assert!(brighter > before + 15.0, "{before} {brighter}");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert!((shown(&mut harness) - before).abs() < 0.5);
    set(&mut harness, "key light", 60.0);
    assert!(shown(&mut harness) > before + 5.0);
}
