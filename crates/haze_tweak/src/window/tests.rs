//! Tests of the whole window: actions on controls are checked in the image.

mod idle_cost;
mod start_view;
mod task_script;

use eframe::egui::{Key, Modifiers, Pos2, Rect, Role, Theme, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, SnapshotOptions};
use haze_core::settings::DebugView;

use super::Window;
use super::testing::{brightness, screenshot, window};

const SIZE: Vec2 = Vec2::new(1000.0, 640.0);

fn column() -> Harness<'static, Window> {
    window("column", SIZE, Theme::Dark)
}

/// Returns the rectangle of the viewport.
fn viewport(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("viewport").rect()
}

/// Returns the brightness of the viewport.
fn shown(harness: &mut Harness<'_, Window>) -> f64 {
    let part = viewport(harness);
    brightness(&screenshot(harness), part)
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

/// Compares the window with its snapshot. The threshold allows for different rounding by drivers.
fn compare(theme: Theme, name: &str) {
    let mut harness = window("column", SIZE, theme);
    harness.snapshot_options(name, &SnapshotOptions::new().threshold(2.0).max_failed_pixels(2000));
}

#[test]
fn the_window_matches_its_dark_snapshot() {
    compare(Theme::Dark, "window_dark");
}

#[test]
fn the_window_matches_its_light_snapshot() {
    compare(Theme::Light, "window_light");
}

#[test]
fn controls_change_the_image_as_their_names_say() {
    let mut harness = column();
    let before = shown(&mut harness);
    set(&mut harness, "Exposure", 2.0);
    let brighter = shown(&mut harness);
    assert!(brighter > before + 15.0, "{before} {brighter}");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert!((shown(&mut harness) - before).abs() < 0.5);
    // Ctrl Y redoes, as Ctrl Shift Z does.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    harness.run_steps(3);
    assert!((shown(&mut harness) - brighter).abs() < 0.5);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    set(&mut harness, "Key light", 60.0);
    assert!(shown(&mut harness) > before + 5.0);
}

fn click(harness: &mut Harness<'_, Window>, button: &str) {
    harness.get_by_label(button).click();
    harness.run_steps(2);
}

/// Returns the PSNR in the corner, once it is shown and no longer changes.
fn decibels(harness: &mut Harness<'_, Window>) -> f32 {
    let mut last = None;
    for _ in 0..100 {
        screenshot(harness);
        std::thread::sleep(std::time::Duration::from_millis(30));
        let text = harness.query_by_label_contains("PSNR").and_then(|node| node.accesskit_node().label());
        if text.is_some() && text == last {
            break;
        }
        last = text;
    }
    let text = last.unwrap();
    text.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_comparison_shows_the_image_error_of_a_saving() {
    let mut harness = column();
    let alone = shown(&mut harness);
    click(&mut harness, "Full");
    assert!((shown(&mut harness) - alone).abs() < 1.0);
    let figure = decibels(&mut harness);
    assert!((25.0..70.0).contains(&figure), "{figure}");
    harness.get_by_label("Difference").click();
    harness.run_steps(2);
    let saved = shown(&mut harness);
    assert!(saved > 0.2 && saved < 0.2 * alone, "{saved}");
    click(&mut harness, "Forward");
    assert!(shown(&mut harness) > 2.0 * saved);
    // The image is rendered in the background; until then no second image is shown.
    click(&mut harness, "CPU");
    let mut judged = alone;
    for _ in 0..200 {
        judged = shown(&mut harness);
        if judged < 0.5 * alone {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    assert!(judged < saved, "{judged} {saved}");
    assert!(decibels(&mut harness) > figure + 5.0, "the reference is closer than a reduced target to a full one");
    click(&mut harness, "CPU");
    assert!((shown(&mut harness) - alone).abs() < 1.0, "a second click, and the image stands alone");
}

#[test]
fn values_of_the_compared_preset_can_be_copied() {
    let mut harness = column();
    let before = shown(&mut harness);
    set(&mut harness, "Exposure", 3.0);
    harness.key_press(Key::F5);
    harness.run_steps(2);
    let divider = harness.get_by_label("divider").rect();
    let view = viewport(&harness);
    let image = screenshot(&mut harness);
    let left = brightness(&image, Rect::from_min_max(view.min, divider.left_bottom()));
    let right = brightness(&image, Rect::from_min_max(divider.right_top(), view.max));
    assert!(left > right + 15.0, "{left} {right}");
    harness.get_by_label("Use B").click();
    harness.run_steps(3);
    assert!((shown(&mut harness) - before).abs() < 1.0);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert!(shown(&mut harness) > before + 8.0);
}

#[test]
fn sprite_animation_can_be_frozen_next_to_the_clock() {
    let mut harness = column();
    let is_frozen = |harness: &Harness<'_, Window>| {
        harness.state().session.document.preset.systems.iter().all(|system| system.settings.debug.freeze_animation)
    };
    for expected in [true, false] {
        harness.get_by_label("Freeze").click();
        harness.run_steps(3);
        assert_eq!(is_frozen(&harness), expected);
    }
}

/// Returns the width of the settings panel and the height of the strip.
fn panel_sizes(harness: &Harness<'_, Window>) -> [f32; 2] {
    let view = viewport(harness);
    let strip = harness.get_by_label("Specular scatter").rect();
    [harness.ctx.content_rect().right() - view.right(), strip.height()]
}

#[test]
fn panels_fit_a_resized_window_and_return_with_it() {
    let mut harness = window("column", Vec2::new(1280.0, 800.0), Theme::Dark);
    let wide = panel_sizes(&harness);
    harness.set_size(Vec2::new(640.0, 400.0));
    harness.run_steps(6);
    let narrow = panel_sizes(&harness);
    assert!(narrow[0] < 0.5 * 640.0 && narrow[1] < wide[1], "{narrow:?} {wide:?}");
    harness.set_size(Vec2::new(1280.0, 800.0));
    harness.run_steps(6);
    let again = panel_sizes(&harness);
    assert!((again[0] - wide[0]).abs() < 1.0 && (again[1] - wide[1]).abs() < 1.0, "{again:?} {wide:?}");
    // Nobody has chosen a size, so none is stored.
    let layout = harness.state().layout();
    assert_eq!((layout.settings_width, layout.strip_height), (None, None));
    // The user drags the edge of the panel.
    let edge = Pos2::new(viewport(&harness).right() + 2.0, 300.0);
    harness.hover_at(edge);
    harness.run_steps(2);
    harness.drag_at(edge);
    harness.run_steps(2);
    harness.hover_at(edge - Vec2::new(80.0, 0.0));
    harness.run_steps(2);
    harness.drop_at(edge - Vec2::new(80.0, 0.0));
    harness.run_steps(2);
    let chosen = harness.state().layout().settings_width.unwrap();
    assert!((chosen.size - wide[0] - 80.0).abs() < 3.0, "{chosen:?} {wide:?}");
    assert_eq!((chosen.in_room(1300.0), chosen.in_room(640.0)), (Some(chosen.size), None));
    harness.set_size(Vec2::new(640.0, 400.0));
    harness.run_steps(6);
    assert!(panel_sizes(&harness)[0] < 0.5 * 640.0);
    harness.set_size(Vec2::new(1280.0, 800.0));
    harness.run_steps(6);
    assert!((panel_sizes(&harness)[0] - chosen.size).abs() < 3.0);
}

#[test]
fn undo_names_the_step() {
    let mut harness = column();
    set(&mut harness, "Exposure", 2.0);
    let said = |harness: &Harness<'_, Window>| harness.query_all_by_label("Exposure").count();
    let before = said(&harness);
    harness.get_by_label("Undo").hover();
    harness.run_steps(8);
    assert_eq!(said(&harness), before + 1);
}

#[test]
fn any_setting_is_found_and_brought_into_view() {
    let mut harness = column();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(2);
    harness.get_by_label("Find a setting").type_text("fade scale");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(8);
    let row = harness.get_all_by_label("Fade scale").next().unwrap().rect();
    assert!(Rect::from_min_size(Default::default(), SIZE).contains_rect(row), "{row:?}");
}

#[test]
fn a_click_on_the_strip_shows_that_view_in_the_viewport() {
    let mut harness = column();
    let before = shown(&mut harness);
    harness.get_by_label("Specular scatter").click();
    harness.run_steps(3);
    assert!(shown(&mut harness) < 0.5 * before);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!((shown(&mut harness) - before).abs() < 1.0);
}

#[test]
fn escape_closes_a_menu_and_nothing_else() {
    let mut harness = column();
    harness.get_by_label("Specular scatter").click();
    harness.run_steps(3);
    harness.get_by_label("Compare").click();
    harness.run_steps(3);
    harness.get_by_label("Current settings");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.query_by_label("Current settings").is_none());
    assert_eq!(harness.state_mut().session_mut().view.debug_view, DebugView::SpecularScatter);
}

#[test]
fn time_is_played_and_stepped() {
    let mut harness = column();
    let before = screenshot(&mut harness);
    harness.get_by_label("Next frame (.)").click();
    harness.run_steps(2);
    assert!(screenshot(&mut harness) != before);
    harness.get_by_label("Previous frame (,)").click();
    harness.run_steps(2);
    harness.get_by_label("viewport").hover();
    harness.run_steps(1);
    let part = viewport(&harness);
    assert!((brightness(&screenshot(&mut harness), part) - brightness(&before, part)).abs() < 0.01);
}

/// Writes images of every tab in several sizes and both themes to the folder that HAZE_LOOK names, for visual
/// inspection. HAZE_SIZE=WxH selects a single size.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_every_tab() {
    let Some(folder) = std::env::var_os("HAZE_LOOK").map(std::path::PathBuf::from) else { return };
    let wanted = std::env::var("HAZE_SIZE").ok();
    let sizes = [(1280, 800), (1400, 900), (2560, 1440), (640, 400)]
        .into_iter()
        .filter(|(width, height)| wanted.as_ref().is_none_or(|wanted| *wanted == format!("{width}x{height}")));
    for (size, theme) in sizes.flat_map(|size| [(size, Theme::Dark), (size, Theme::Light)]) {
        let mut harness = window("column", Vec2::new(size.0 as f32, size.1 as f32), theme);
        let save = |harness: &mut Harness<'_, Window>, name: &str| {
            screenshot(harness).save(folder.join(format!("{name}_{}_{theme:?}.png", size.0))).unwrap();
        };
        for (_, name, _) in crate::panels::settings_panel::TABS {
            harness.get_by_label(name).click();
            harness.run_steps(4);
            // Waits for results of worker threads.
            for _ in 0..5 {
                std::thread::sleep(std::time::Duration::from_millis(20));
                screenshot(&mut harness);
            }
            save(&mut harness, name);
        }
        harness.get_by_label("Ramps").click();
        harness.run_steps(4);
        harness.get_by_label("Looks: Diffuse ramp").click();
        for _ in 0..40 {
            std::thread::sleep(std::time::Duration::from_millis(100));
            harness.step();
        }
        save(&mut harness, "looks");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        harness.get_by_label("Light").click();
        harness.run_steps(4);
        harness.get_by_label("Key (Point 1)").click();
        harness.get_by_label("Color of Key (Point 1)").click();
        harness.run_steps(4);
        save(&mut harness, "color");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        for time in ["Add a sun", "Sunset", "Moonlit"] {
            harness.get_by_label(time).click();
            harness.run_steps(4);
            save(&mut harness, time);
        }
        for _ in 0..3 {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
            harness.run_steps(2);
        }
        harness.get_by_label("Look").click();
        harness.get_by_label("Inspect").click();
        harness.run_steps(3);
        set(&mut harness, "Exposure", 1.5);
        harness.key_press(Key::F5);
        decibels(&mut harness);
        let beside = viewport(&harness).center() - Vec2::new(0.1 * size.0 as f32, 0.0);
        harness.hover_at(beside);
        for _ in 0..5 {
            std::thread::sleep(std::time::Duration::from_millis(20));
            screenshot(&mut harness);
        }
        save(&mut harness, "compare");
        harness.key_press(Key::F1);
        harness.run_steps(4);
        save(&mut harness, "help");
        harness.key_press(Key::Escape);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
        harness.run_steps(4);
        save(&mut harness, "export");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(2);
        harness.get_by_label("Find a setting").type_text("size");
        harness.run_steps(4);
        save(&mut harness, "find");
    }
}
