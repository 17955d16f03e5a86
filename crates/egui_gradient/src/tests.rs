//! Tests of the editor in a window: input by pointer and keys.

#![allow(clippy::float_cmp, reason = "positions are rounded")]

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Role, Theme, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

mod clipboard;
mod colors;
mod drags;
mod harness;
mod several;

use super::*;
use harness::*;
use haze_author::ramp::template::{TEMPLATES, Template};
use haze_author::ramp::{Curve, HexColor};

#[test]
fn a_click_adds_a_stop_with_the_color_at_that_position() {
    let mut harness = host(&[(0.0, 0), (1.0, 255)]);
    let at = on_strip(&harness, 0.25);
    let expected = {
        let rows = vec![harness.state().row.clone()];
        let recipe = haze_author::ramp::RampRecipe { rows, ..Default::default() };
        let light = recipe.gradient().unwrap().sample(0.25, 0.0).x;
        (haze_core::formula::color::srgb_from_linear(light) * 255.0).round() as u8
    };
    click(&mut harness, at, NONE);
    assert_eq!(positions(&harness), [0.0, 0.25, 1.0]);
    assert!(grays(&harness)[1].abs_diff(expected) <= 1 && (5..200).contains(&expected), "{expected}");
    assert_eq!((steps(&harness), harness.state().editor.state.selection.lead()), (vec!["add a stop"], 1));
    let at = on_strip(&harness, 0.62);
    click(&mut harness, at, Modifiers::COMMAND);
    assert_eq!(positions(&harness), [0.0, 0.25, 0.6, 1.0]);
    // A press followed by a drag adds a stop and moves it, in one step.
    let at = on_strip(&harness, 0.8);
    let width = strip(&harness).width();
    drag(&mut harness, at, 0.1 * width, NONE);
    assert_eq!(positions(&harness), [0.0, 0.25, 0.6, 0.9, 1.0]);
    assert_eq!(steps(&harness).len(), 3);
}

#[test]
fn a_drag_is_one_step_and_can_pass_other_stops() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (0.5, 20), (1.0, 30)]);
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    drag(&mut harness, from, 0.4 * width, NONE);
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.0, 0.5, 0.7, 1.0], vec![0, 20, 10, 30]));
    assert!(harness.state().changes > 2, "the host sees it on its way");
    assert_eq!(steps(&harness), ["move a stop"]);
    assert_eq!(harness.state().editor.state.selection.lead(), 2);
    let from = handle(&harness, 2).center();
    drag(&mut harness, from, -0.17 * width, Modifiers::COMMAND);
    assert_eq!(positions(&harness), [0.0, 0.5, 0.5, 1.0], "Ctrl snaps");
    assert_eq!(grays(&harness), [0, 20, 10, 30], "at one place it stays on its side");
    let from = handle(&harness, 2).center();
    drag(&mut harness, from, 9.0 * width, NONE);
    assert_eq!(positions(&harness), [0.0, 0.5, 1.0, 1.0]);
    // A click without movement is not a step.
    let count = steps(&harness).len();
    let at = handle(&harness, 0).center();
    click(&mut harness, at, NONE);
    assert_eq!((steps(&harness).len(), harness.state().editor.state.selection.lead()), (count, 0));
}

#[test]
fn stops_at_one_position_have_separate_handles() {
    let mut harness = host(&[(0.5, 1), (0.5, 2), (0.5, 3), (1.0, 4)]);
    for (index, width) in [(0, -30.0), (2, 30.0)] {
        let from = handle(&harness, index).center();
        drag(&mut harness, from, width, NONE);
    }
    assert_eq!(grays(&harness), [1, 2, 3, 4]);
    let at = positions(&harness);
    assert!(at[0] < 0.45 && (at[1] - 0.5).abs() < 1.0e-3 && at[2] > 0.55, "{at:?}");
}

#[test]
fn stops_are_edited_by_keyboard_alone() {
    let mut harness = host(&[(0.0, 0), (0.5, 10), (1.0, 20)]);
    let has_keyboard = |harness: &Harness<'_, Host>, index: usize| {
        harness.get_by_label(&format!("stop {}", index + 1)).accesskit_node().is_focused()
    };
    harness.get_by_label("stop 1").focus();
    harness.run_steps(3);
    assert!(has_keyboard(&harness, 0));
    key(&mut harness, Key::Tab, NONE);
    assert!(has_keyboard(&harness, 1));
    assert_eq!(harness.state().editor.state.selection.lead(), 1);
    for (modifiers, pressed, expected) in [
        (NONE, Key::ArrowRight, 0.501),
        (Modifiers::SHIFT, Key::ArrowRight, 0.511),
        (Modifiers::COMMAND, Key::ArrowRight, 0.6),
        (NONE, Key::ArrowLeft, 0.599),
        (Modifiers::COMMAND, Key::ArrowLeft, 0.5),
    ] {
        key(&mut harness, pressed, modifiers);
        assert_eq!(positions(&harness)[1], expected);
        assert!(has_keyboard(&harness, 1));
    }
    assert_eq!(steps(&harness).len(), 5);
    // A stop that passes another keeps the focus.
    for _ in 0..6 {
        key(&mut harness, Key::ArrowRight, Modifiers::COMMAND);
    }
    assert_eq!(grays(&harness), [0, 10, 20]);
    key(&mut harness, Key::Tab, Modifiers::SHIFT);
    for _ in 0..11 {
        key(&mut harness, Key::ArrowRight, Modifiers::COMMAND);
    }
    assert_eq!(positions(&harness), [1.0, 1.0, 1.0]);
    for _ in 0..2 {
        key(&mut harness, Key::ArrowLeft, Modifiers::COMMAND);
    }
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.8, 1.0, 1.0], vec![0, 10, 20]));
    key(&mut harness, Key::Delete, NONE);
    key(&mut harness, Key::Delete, NONE);
    assert_eq!(grays(&harness), [20]);
    key(&mut harness, Key::Delete, NONE);
    assert_eq!(grays(&harness), [20], "the last one stays");
    harness.get_by_label("gradient: add a stop").focus();
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    assert_eq!(positions(&harness), [0.5, 1.0]);
    assert!(has_keyboard(&harness, 0));
}

#[test]
fn positions_and_colors_can_be_typed() {
    let mut harness = host(&[(0.0, 0), (0.5, 10), (1.0, 20)]);
    harness.get_by_label("next stop").click();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::SpinButton, "Position").click();
    harness.run_steps(2);
    harness.event(Event::Text("0.125".into()));
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    assert_eq!((positions(&harness), steps(&harness)), (vec![0.0, 0.125, 1.0], vec!["move a stop"]));
    for (text, is_good) in [("#ff8000", true), ("orange", false)] {
        harness.get_by_role_and_label(Role::TextInput, "Color").click();
        harness.run_steps(2);
        key(&mut harness, Key::A, Modifiers::COMMAND);
        harness.event(Event::Text(text.into()));
        harness.run_steps(2);
        key(&mut harness, Key::Enter, NONE);
        assert_eq!(harness.state().row.stops[1].color, HexColor([255, 128, 0]));
        assert_eq!(harness.state().refused.is_empty(), is_good);
    }
    assert_eq!(steps(&harness), ["move a stop", "color of a stop"]);
    assert_eq!(harness.state().refused, [r##""orange" is not valid; expected an sRGB color, "#rrggbb""##]);
}

#[test]
fn a_curve_is_set_for_the_selected_stop_only() {
    let mut harness = host(&[(0.0, 0), (1.0, 20)]);
    harness.get_by_role(Role::ComboBox).click();
    harness.run_steps(3);
    harness.get_by_label("Constant").click();
    harness.run_steps(3);
    assert_eq!(harness.state().row.stops[0].curve, Curve::Constant);
    assert_eq!(harness.state().row.stops[1].curve, Curve::Monotone);
    assert_eq!(steps(&harness), ["curve of a stop"]);
}

#[test]
fn each_button_is_one_undo_step() {
    let mut harness = host(&[(0.0, 0), (0.2, 10), (1.0, 20)]);
    let press = |harness: &mut Harness<'_, Host>, name: &str| {
        harness.get_by_label(name).click();
        harness.run_steps(3);
    };
    press(&mut harness, "Flip");
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.0, 0.8, 1.0], vec![20, 10, 0]));
    press(&mut harness, "Distribute");
    assert_eq!(positions(&harness), [0.0, 0.5, 1.0]);
    press(&mut harness, "Steps");
    assert_eq!(positions(&harness), [0.0, 0.333, 0.667]);
    press(&mut harness, "Templates");
    for template in TEMPLATES {
        assert!(harness.query_by_label(&template.name.replace('_', " ")).is_some(), "{}", template.name);
    }
    press(&mut harness, "hard toon");
    assert_eq!(harness.state().row.stops, Template::find("hard_toon").unwrap().recipe().rows[0].stops);
    press(&mut harness, "Remove");
    assert_eq!(harness.state().row.stops.len(), 2);
    assert_eq!(steps(&harness), ["flip", "distribute", "even steps", "template", "remove a stop"]);
    assert_eq!(harness.state().row.at, 0.5, "the row stays where it is");
}

#[test]
fn ten_thousand_stops_can_be_edited() {
    let list: Vec<_> = (0..10_000u32).map(|index| (index as f32 / 9999.0, index as u8)).collect();
    let mut harness = host(&list);
    let lane = strip(&harness).bottom() + 3.0;
    let width = strip(&harness).width();
    let at = pos2(strip(&harness).left() + 0.75 * width, lane);
    click(&mut harness, at, NONE);
    let selected = harness.state().editor.state.selection.lead();
    assert!(selected.abs_diff(7500) < 40, "{selected}");
    let name = format!("stop {}", selected + 1);
    assert!(harness.get_by_label(&name).accesskit_node().is_focused());
    key(&mut harness, Key::Delete, NONE);
    assert_eq!(harness.state().row.stops.len(), 9999);
    let begun = std::time::Instant::now();
    harness.run_steps(10);
    let frame = begun.elapsed() / 10;
    assert!(frame.as_millis() < 100, "{frame:?} a frame");
}

#[test]
fn all_controls_fit_in_a_narrow_panel() {
    for theme in [Theme::Dark, Theme::Light] {
        let mut harness = host(&[(0.0, 0), (0.5, 128), (0.5, 200), (1.0, 255)]);
        harness.ctx.set_theme(theme);
        harness.run_steps(2);
        let names = ["stop 1", "stop 4", "gradient: add a stop", "next stop", "Flip", "Mirror", "Paste", "Templates"];
        for name in names {
            let rect = harness.get_by_label(name).rect();
            assert!(rect.left() >= 0.0 && rect.right() <= 330.0 && rect.bottom() <= 260.0, "{name} {rect:?}");
        }
    }
}

/// Writes screenshots to the folder `HAZE_LOOK`.
#[test]
#[ignore = "writes screenshots for manual review"]
fn screenshots_of_the_editor() {
    let folder = std::path::PathBuf::from(std::env::var_os("HAZE_LOOK").unwrap());
    for (theme, name) in [(Theme::Dark, "dark"), (Theme::Light, "light")] {
        let mut harness = host(&[(0.0, 20), (0.3, 60), (0.3, 160), (0.33, 200), (0.8, 220), (1.0, 255)]);
        harness.ctx.set_theme(theme);
        harness.get_by_label("stop 3").focus();
        harness.run_steps(3);
        harness.render().unwrap().save(folder.join(format!("gradient_{name}.png"))).unwrap();
        // Several stops during a drag; then the eyedropper.
        key(&mut harness, Key::ArrowDown, Modifiers::SHIFT);
        let from = handle(&harness, 3).center();
        for pos in [from, from, from + Vec2::new(20.0, 0.0), from + Vec2::new(40.0, 0.0)] {
            harness.hover_at(pos);
            harness.step();
            if pos == from {
                button(&mut harness, from, true, NONE);
            }
        }
        harness.run_steps(3);
        harness.render().unwrap().save(folder.join(format!("gradient_drag_{name}.png"))).unwrap();
        button(&mut harness, from + Vec2::new(40.0, 0.0), false, NONE);
        harness.get_by_label("Pick color").click();
        harness.run_steps(5);
        let at = on_strip(&harness, 0.6);
        harness.hover_at(at);
        harness.run_steps(3);
        key(&mut harness, Key::Num3, NONE);
        harness.render().unwrap().save(folder.join(format!("gradient_eyedropper_{name}.png"))).unwrap();
    }
}
