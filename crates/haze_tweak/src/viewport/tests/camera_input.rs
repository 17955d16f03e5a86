//! Tests of camera control.

use eframe::egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase, vec2};
use egui_kittest::kittest::Queryable as _;
use glam::Vec3;
use haze::Light;

use super::{camera, drag, flick, light, lit, projection, undo_name, viewport};
use crate::session::smoke_geometry::SmokeGeometry;

#[test]
fn f_frames_the_smoke_or_the_light_and_home_restores_the_camera() {
    let mut harness = lit(Light::default());
    let saved = camera(&harness);
    harness.key_press(Key::F);
    harness.run();
    assert!(camera(&harness).target.distance(light(&harness).position) < 1e-4);
    harness.state_mut().session.view.lights.selected = None;
    harness.key_press(Key::F);
    harness.run();
    let mut smoke = SmokeGeometry::default();
    let session = &harness.state().session;
    let bounds = session.measure(&mut smoke).bounds();
    assert_eq!(camera(&harness).target, bounds.center());
    for corner in [bounds.min, bounds.max] {
        assert!(projection(&harness).project(corner).is_some_and(|at| viewport(&harness).contains(at)));
    }
    harness.key_press(Key::Num7);
    harness.run();
    let above = camera(&harness);
    assert!((above.position - above.target).normalize().distance(Vec3::Y) < 1e-4);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    harness.run();
    let behind = camera(&harness);
    assert!((behind.position - behind.target).normalize().distance(Vec3::NEG_Z) < 1e-4);
    harness.key_press(Key::Home);
    harness.run();
    assert_eq!(camera(&harness), saved);
}

#[test]
fn keys_do_nothing_while_text_is_typed() {
    let mut harness = lit(Light::default());
    let before = camera(&harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.key_press(Key::F);
    harness.key_press(Key::Num1);
    harness.run();
    assert_eq!(camera(&harness), before);
}

#[test]
fn wheel_steps_are_one_undo_step_and_zoom_towards_the_pointer() {
    let mut harness = lit(Light::default());
    let before = camera(&harness);
    let at = viewport(&harness).center() + vec2(150.0, -60.0);
    let point = projection(&harness).unproject_to_facing_plane(at, before.target);
    harness.hover_at(at);
    let turn = || Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, 1.0),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    };
    for _ in 0..3 {
        harness.event(turn());
    }
    harness.run_steps(6);
    let near = camera(&harness);
    assert!(near.position.distance(near.target) < 0.9 * before.position.distance(before.target));
    assert!(projection(&harness).project(point).unwrap().distance(at) < 1.0);
    assert_eq!(undo_name(&harness).as_deref(), Some("Camera"));
    harness.event(turn());
    harness.run_steps(6);
    harness.state_mut().session.undo();
    assert_eq!(camera(&harness), near, "after a pause it is another step");
    harness.state_mut().session.undo();
    assert_eq!(camera(&harness), before);
}

#[test]
fn a_drag_with_ctrl_moves_no_camera_and_says_when_it_paints() {
    let mut harness = lit(Light::default());
    let before = camera(&harness);
    let from = viewport(&harness).center() + vec2(-180.0, 60.0);
    harness.event(Event::ModifiersChanged(Modifiers::COMMAND));
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(0.0, 20.0), from + vec2(0.0, 60.0)]);
    assert_eq!(camera(&harness), before);
    let message = harness.state().session.messages.latest().map(|message| message.text.clone());
    assert_eq!(message.as_deref(), Some("Ctrl + drag paints on the smoke while Inspect is on"));
}

#[test]
fn the_right_button_with_wasd_flies() {
    let mut harness = lit(Light::default());
    let before = camera(&harness);
    let at = viewport(&harness).center();
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.hover_at(at);
    harness.event(button(true));
    harness.key_down(Key::W);
    harness.step();
    harness.run_steps(4);
    harness.key_up(Key::W);
    harness.event(button(false));
    harness.run();
    let after = camera(&harness);
    let ahead = (before.target - before.position).normalize();
    let way = after.position - before.position;
    assert!(way.dot(ahead) > 0.5 && way.normalize().distance(ahead) < 1e-3, "{way}");
    assert_eq!(undo_name(&harness).as_deref(), Some("Camera"));
    assert!(harness.query_by_label_contains("Here").is_none(), "no menu opens");
}

#[test]
fn a_drag_within_one_long_frame_moves_as_far_as_a_slow_one() {
    for (button, name) in [(PointerButton::Primary, "orbit"), (PointerButton::Secondary, "look")] {
        let mut slow = lit(Light::default());
        let mut fast = lit(Light::default());
        let from = viewport(&slow).center() + vec2(-180.0, 60.0);
        let before = camera(&slow);
        let position = |moved: f32| from + vec2(moved, 0.2 * moved);
        drag(&mut slow, button, &[0.0, 20.0, 46.0, 100.0, 186.0].map(position));
        flick(&mut fast, button, &[0.0, 46.0, 186.0].map(position));
        let slow = camera(&slow);
        let fast = camera(&fast);
        assert!(
            slow.position.distance(fast.position) + slow.target.distance(fast.target) < 1e-3,
            "{name}: {slow:?} {fast:?}"
        );
        assert!(before.position.distance(fast.position) + before.target.distance(fast.target) > 1.0, "{name}");
    }
}
