use eframe::egui::{Key, Modifiers, PointerButton, Pos2, Rect, Role, Theme, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze_preset::{Ease, KeyValue, Preset, Track};

use crate::document::keyframes::set_key;
use crate::session::view_options::Tab;
use crate::window::Window;
use crate::window::testing::{click_at, row_menu, row_name, window};

const INTENSITY: &str = "lights[0].intensity";

fn preset<'h>(harness: &'h Harness<'_, Window>) -> &'h Preset {
    &harness.state().session.document.preset
}

fn track<'h>(harness: &'h Harness<'_, Window>, setting: &str) -> Option<&'h Track> {
    preset(harness).animation.iter().find(|track| track.setting == setting)
}

fn times(harness: &Harness<'_, Window>, setting: &str) -> Vec<f32> {
    track(harness, setting).map_or(Vec::new(), |track| track.keys.iter().map(|key| key.time).collect())
}

/// Window in which the intensity of the first light rises from 10 at 0 s to 50 at 4 s, at 2 s.
fn rising() -> Harness<'static, Window> {
    let mut harness = window("column", Vec2::new(1280.0, 800.0), Theme::Dark);
    let session = &mut harness.state_mut().session;
    for (time, value) in [(0.0, 10.0), (4.0, 50.0)] {
        set_key(&mut session.document.preset, INTENSITY, time, KeyValue::Number(value));
    }
    session.document.preset.animation[0].keys[0].ease = Ease::Linear;
    session.playback.time = 2.0;
    session.view.tab = Tab::Light;
    session.view.lights.selected = Some(0);
    harness.run_steps(4);
    harness
}

fn undo(harness: &mut Harness<'_, Window>) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
}

fn drag(harness: &mut Harness<'_, Window>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(2);
    let button = |pos, pressed| egui_button(pos, PointerButton::Primary, pressed);
    harness.event(button(from, true));
    harness.run_steps(2);
    for fraction in [0.3, 0.7, 1.0] {
        harness.event(eframe::egui::Event::PointerMoved(from + fraction * (to - from)));
        harness.run_steps(2);
    }
    harness.event(button(to, false));
    harness.run_steps(3);
}

fn egui_button(pos: Pos2, button: PointerButton, pressed: bool) -> eframe::egui::Event {
    eframe::egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
}

fn keyframe(harness: &Harness<'_, Window>, number: usize) -> Rect {
    harness.get_by_label_contains(&format!("Keyframe {number} of Intensity")).rect()
}

fn set_intensity(harness: &mut Harness<'_, Window>, value: f64) {
    let sliders = harness.get_all_by_label("Intensity");
    let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider);
    slider.unwrap().set_value_accesskit(value);
    harness.run_steps(3);
}

#[test]
fn the_first_keyframe_opens_the_list_and_a_change_at_another_time_is_the_next() {
    let mut harness = window("column", Vec2::new(1280.0, 800.0), Theme::Dark);
    assert!(harness.query_by_label("Keys").is_none(), "without keyframes there is no list");
    harness.state_mut().session.view.tab = Tab::Light;
    harness.state_mut().session.view.lights.selected = Some(0);
    harness.state_mut().session.playback.time = 1.25;
    harness.run_steps(4);
    let before = preset(&harness).clone();
    row_menu(&mut harness, "Intensity");
    harness.get_by_label("Add Keyframe at 1.25 s").click();
    harness.run_steps(4);
    assert_eq!(times(&harness, INTENSITY), [1.25]);
    assert_eq!(track(&harness, INTENSITY).unwrap().keys[0].value, KeyValue::Number(before.lights[0].intensity));
    harness.get_by_label("Keys");
    keyframe(&harness, 1);
    // Elsewhere, a change of the setting is a keyframe; of another setting it is not.
    harness.state_mut().session.playback.time = 3.0;
    harness.run_steps(3);
    set_intensity(&mut harness, 77.0);
    assert_eq!(times(&harness, INTENSITY), [1.25, 3.0]);
    assert_eq!(preset(&harness).lights, before.lights, "its own value stays");
    let shown = harness.state().session.shot(glam::UVec2::splat(8)).preset;
    assert!((shown.lights[0].intensity - 77.0).abs() < 1e-3 && shown.animation.is_empty());
    // One step each.
    undo(&mut harness);
    assert_eq!(times(&harness, INTENSITY), [1.25]);
    undo(&mut harness);
    assert_eq!(*preset(&harness), before);
    assert!(harness.query_by_label("Keys").is_none());
}

#[test]
fn the_diamond_of_a_row_adds_and_deletes() {
    let mut harness = rising();
    let name = row_name(&harness, "Intensity");
    let add = harness.get_by_label("Add Keyframe at 2.00 s: Intensity").rect();
    assert!(add.left() > name.x, "beside the name");
    click_at(&mut harness, add.center(), PointerButton::Primary);
    assert_eq!(times(&harness, INTENSITY), [0.0, 2.0, 4.0]);
    assert_eq!(track(&harness, INTENSITY).unwrap().keys[1].value, KeyValue::Number(30.0));
    let delete = harness.get_by_label("Delete Keyframe at 2.00 s: Intensity").rect();
    click_at(&mut harness, delete.center(), PointerButton::Primary);
    assert_eq!(times(&harness, INTENSITY), [0.0, 4.0]);
    // A setting without keyframes has one while the pointer is over its name.
    assert!(harness.query_by_label("Add Keyframe at 2.00 s: Radius").is_none());
    let radius = row_name(&harness, "Radius");
    harness.hover_at(radius);
    harness.run_steps(3);
    harness.get_by_label("Add Keyframe at 2.00 s: Radius");
    // The menu deletes all keyframes.
    row_menu(&mut harness, "Intensity");
    harness.get_by_label("Delete All Keyframes").click();
    harness.run_steps(4);
    assert!(preset(&harness).animation.is_empty());
}

#[test]
fn a_keyframe_is_dragged_in_one_step_and_clicked_to_go_there() {
    let mut harness = rising();
    let last = keyframe(&harness, 2).center();
    let lane = harness.get_by_label_contains("Keyframes of Intensity").rect();
    let settled = preset(&harness).clone();
    // The axis reaches from 0 s to the end of the playback.
    let second = (lane.width() - 16.0) / *harness.state().session.playback.range.end() as f32;
    drag(&mut harness, last, last - Vec2::new(second, 0.0));
    let moved = times(&harness, INTENSITY)[1];
    assert!((moved - 3.0).abs() < 0.03, "{moved}");
    undo(&mut harness);
    assert_eq!(*preset(&harness), settled);
    let last = keyframe(&harness, 2).center();
    click_at(&mut harness, last, PointerButton::Primary);
    let time = harness.state().session.playback.time;
    assert!((time - 4.0).abs() < 1e-4, "{time} {last}");
    // A click on the row goes to its time, too.
    click_at(&mut harness, pos2(lane.left() + 8.0 + second, lane.center().y), PointerButton::Primary);
    assert!((harness.state().session.playback.time - 1.0).abs() < 0.03);
    assert_eq!(*preset(&harness), settled);
}

#[test]
fn menus_ease_copy_paste_and_delete() {
    let mut harness = rising();
    let choose = |harness: &mut Harness<'_, Window>, at: Pos2, entry: &str| {
        click_at(harness, at, PointerButton::Secondary);
        harness.get_by_label(entry).click();
        harness.run_steps(4);
    };
    let first = keyframe(&harness, 1).center();
    choose(&mut harness, first, "Hold");
    assert_eq!(track(&harness, INTENSITY).unwrap().keys[0].ease, Ease::Hold);
    choose(&mut harness, first, "Copy Keyframe");
    let lane = harness.get_by_label_contains("Keyframes of Intensity").rect();
    let second = (lane.width() - 16.0) / *harness.state().session.playback.range.end() as f32;
    let at_two = pos2(lane.left() + 8.0 + 2.0 * second, lane.center().y);
    click_at(&mut harness, at_two, PointerButton::Secondary);
    harness.get_by_label_contains("Paste Keyframes at 2.0").click();
    harness.run_steps(4);
    let track_now = track(&harness, INTENSITY).unwrap();
    assert_eq!(track_now.keys.len(), 3);
    assert_eq!((&track_now.keys[1].value, track_now.keys[1].ease), (&KeyValue::Number(10.0), Ease::Hold));
    let middle = keyframe(&harness, 2).center();
    choose(&mut harness, middle, "Delete Keyframe");
    assert_eq!(times(&harness, INTENSITY), [0.0, 4.0]);
    choose(&mut harness, at_two, "Delete Track");
    assert!(preset(&harness).animation.is_empty());
}

#[test]
fn the_selected_track_has_a_curve_a_loop_and_flicker() {
    let mut harness = rising();
    harness.get_by_role_and_label(Role::Button, "Intensity of Key (Point 1)").click();
    harness.run_steps(4);
    let curve = harness.get_by_label("Curve of lights[0].intensity").rect();
    let last = keyframe(&harness, 2).center().x;
    // The last keyframe is 8 % below the top. Down to the middle, it is 30.
    let height = curve.height();
    let point = pos2(last, curve.top() + 0.08 / 1.16 * height);
    drag(&mut harness, point, pos2(last, curve.center().y));
    let KeyValue::Number(value) = track(&harness, INTENSITY).unwrap().keys[1].value else { unreachable!() };
    assert!((value - 30.0).abs() < 1.0, "{value}");
    undo(&mut harness);
    harness.get_by_label("Loop").click();
    harness.run_steps(4);
    assert!((track(&harness, INTENSITY).unwrap().period - 5.0).abs() < 1e-5);
    let sliders = harness.get_all_by_label("Flicker");
    sliders.into_iter().next_back().unwrap().set_value_accesskit(0.5);
    harness.run_steps(4);
    assert!((track(&harness, INTENSITY).unwrap().flicker.amount - 0.5).abs() < 1e-3);
    preset(&harness).validate().unwrap();
    // The list can be closed.
    harness.get_by_label("Keys").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Loop").is_none());
}

#[test]
fn tracks_follow_their_lights() {
    let mut harness = rising();
    harness.get_by_label("Duplicate").click();
    harness.run_steps(4);
    assert_eq!(times(&harness, "lights[1].intensity"), [0.0, 4.0]);
    harness.state_mut().session.view.lights.selected = Some(0);
    harness.run_steps(3);
    harness.get_by_label("Delete").click();
    harness.run_steps(4);
    assert_eq!((times(&harness, INTENSITY).len(), preset(&harness).animation.len()), (2, 1));
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!((preset(&harness).lights.len(), preset(&harness).animation.len()), (3, 1));
    // A muted light takes its track along, and the others keep theirs.
    let session = &mut harness.state_mut().session;
    set_key(&mut session.document.preset, "lights[1].intensity", 0.0, KeyValue::Number(3.0));
    session.view.lights.mute_solo(0).unwrap().is_muted = true;
    let shot = session.animated_shot(glam::UVec2::splat(8));
    assert_eq!(shot.preset.animation.len(), 1);
    assert_eq!(shot.at_its_time().preset.lights[0].intensity.to_bits(), 3.0_f32.to_bits());
}

#[test]
fn a_reset_restores_the_saved_keyframes() {
    let mut harness = rising();
    let name = row_name(&harness, "Intensity");
    assert!(harness.state().session.changed().contains(INTENSITY));
    harness.get_by_label("Reset Intensity").click();
    harness.run_steps(4);
    assert!(preset(&harness).animation.is_empty() && !harness.state().session.document.is_dirty(), "{name}");
}

#[test]
fn nothing_is_clipped_in_the_smallest_window() {
    let size = Vec2::new(640.0, 400.0);
    let mut harness = window("column", size, Theme::Dark);
    let session = &mut harness.state_mut().session;
    set_key(&mut session.document.preset, INTENSITY, 0.0, KeyValue::Number(1.0));
    session.view.tracks.select(INTENSITY);
    harness.run_steps(5);
    let image = harness.get_by_label("viewport").rect();
    let lane = harness.get_by_label_contains("Keyframes of Intensity").rect();
    assert!(lane.right() <= size.x && lane.top() >= image.bottom(), "{lane} {image}");
    assert!(image.height() > 80.0, "{image}");
}

fn curve(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label_contains("Curve of lights[0].intensity").rect()
}

#[test]
fn a_press_on_a_point_of_the_curve_moves_nothing_until_it_is_dragged() {
    let mut harness = rising();
    harness.state_mut().session.view.tracks.select(INTENSITY);
    harness.run_steps(4);
    let before = preset(&harness).clone();
    let key = keyframe(&harness, 2).center();
    let plot = curve(&harness);
    // A few points beside the mark, and within its reach. The highest value has a margin of 0.08 of the range above it.
    let point = pos2(key.x - 3.0, plot.top() + plot.height() * 0.08 / 1.16 + 2.0);
    harness.hover_at(point);
    harness.run_steps(2);
    harness.event(egui_button(point, PointerButton::Primary, true));
    harness.run_steps(3);
    assert_eq!(*preset(&harness), before);
    // The point keeps its distance from the pointer.
    let to = point + Vec2::new(0.0, 30.0);
    harness.event(eframe::egui::Event::PointerMoved(to));
    harness.run_steps(3);
    harness.event(egui_button(to, PointerButton::Primary, false));
    harness.run_steps(3);
    let keys = &track(&harness, INTENSITY).unwrap().keys;
    assert!((keys[1].time - 4.0).abs() < 0.011, "{keys:?}");
    let KeyValue::Number(value) = keys[1].value else { unreachable!() };
    let expected = 50.0 - 30.0 / plot.height() * 1.16 * 40.0;
    assert!((value - expected).abs() < 0.3, "{value} {expected}");
}

#[test]
fn seconds_are_written_along_the_ruler_and_a_click_goes_there() {
    let mut harness = rising();
    let ruler = harness.get_by_label("Time ruler").rect();
    assert!(ruler.bottom() <= keyframe(&harness, 1).top() + 1.0, "{ruler}");
    let position = pos2(keyframe(&harness, 2).center().x, ruler.center().y);
    click_at(&mut harness, position, PointerButton::Primary);
    assert!((harness.state().session.playback.time - 4.0).abs() < 0.02);
    let axis = |end: f64, width: f32| {
        let mut session = crate::session::Session::open(std::path::Path::new("column"), None).unwrap();
        session.playback.range = 0.0..=end;
        super::TimeAxis::new(0.0, width, &session).labels(50.0)
    };
    assert_eq!(axis(10.0, 516.0), (vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], 0));
    let (times, decimals) = axis(1.0, 266.0);
    assert_eq!((times.len(), decimals), (6, 1));
}

#[test]
fn a_track_that_only_flickers_has_no_keyframes_elsewhere() {
    use crate::panels::rows::key_mark::{KeyMarks, KeyState};
    let mut harness = rising();
    let session = &mut harness.state_mut().session;
    session.document.preset.animation[0].flicker.amount = 0.5;
    session.document.preset.animation[0].keys.clear();
    assert_eq!(KeyMarks::new(&session.document.preset, 2.0).of(INTENSITY).state, KeyState::None);
    harness.run_steps(4);
    // Its diamond adds the first one.
    assert!(harness.query_all_by_label_contains("Add Keyframe at 2.00 s: Intensity").next().is_some());
}
