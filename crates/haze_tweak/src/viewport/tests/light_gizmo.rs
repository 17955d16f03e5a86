//! Tests of picking and dragging lights.

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use glam::Vec3;
use haze::{Light, LightKind};
use haze_preset::KeyValue;

use super::{camera, drag, flick, handle, light, lit, projection, undo_name};
use crate::document::keyframes::set_key;
use crate::session::view_options::Tab;
use crate::viewport::light_handle::{Handle, Shape, handles};
use crate::window::Window;

#[test]
fn an_axis_drag_moves_the_light_along_the_axis_in_one_step() {
    for axis in 0..2 {
        let mut harness = lit(Light::default());
        let before = light(&harness).position;
        let seen = projection(&harness);
        let from = handle(&harness, Handle::Axis(axis));
        let along = seen.project(before + Vec3::AXES[axis]).unwrap() - seen.project(before).unwrap();
        let to = from + along * 0.6;
        drag(&mut harness, PointerButton::Primary, &[from, from + along * 0.2, to]);
        let moved = light(&harness).position - before;
        assert!((moved[axis] - 0.6).abs() < 0.02, "axis {axis}: {moved}");
        assert!((moved - moved[axis] * Vec3::AXES[axis]).length() < 1e-6, "{moved}");
        assert!(handle(&harness, Handle::Axis(axis)).distance(to) < 6.0, "it stays under the pointer");
        assert_eq!(undo_name(&harness).as_deref(), Some("Position of Point 1"));
        harness.state_mut().session.undo();
        assert_eq!((light(&harness).position, undo_name(&harness)), (before, Some("Light removed".into())));
    }
}

/// A window between two keyframes of a light's position.
fn moving() -> Harness<'static, Window> {
    let mut harness = lit(Light::default());
    let session = &mut harness.state_mut().session;
    let own = session.document.preset.lights[0].position;
    for time in [0.0, 4.0] {
        let value = KeyValue::Vector(own + Vec3::X * 0.2 * time);
        set_key(&mut session.document.preset, "lights[0].position", time, value);
    }
    session.track(false);
    session.playback.time = 2.0;
    harness.run_steps(4);
    harness
}

/// Center handle of the light, which is where the light is at the shown time.
fn shown_center(harness: &Harness<'_, Window>) -> Pos2 {
    let shown = harness.state().session.preset_now();
    let shapes = handles(&shown.lights[0], &projection(harness));
    let Shape::Square(center) = shapes.into_iter().find(|shape| shape.0 == Handle::Center).unwrap().1 else {
        unreachable!()
    };
    center
}

#[test]
fn a_drag_of_a_light_with_keyframes_is_one_keyframe_and_one_step() {
    let mut harness = moving();
    let own = light(&harness).position;
    let seen = projection(&harness);
    let from = shown_center(&harness);
    let to = from + vec2(60.0, -40.0);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(20.0, -10.0), to]);
    let session = &harness.state().session;
    let keys: Vec<_> = session.document.preset.animation[0].keys.iter().map(|key| key.time).collect();
    assert_eq!(keys, [0.0, 2.0, 4.0]);
    assert!(seen.project(session.preset_now().lights[0].position).unwrap().distance(to) < 1.5);
    assert_eq!(light(&harness).position, own);
    assert_eq!(undo_name(&harness).as_deref(), Some("Position of Point 1"));
    harness.state_mut().session.undo();
    assert_eq!(harness.state().session.document.preset.animation[0].keys.len(), 2);
}

#[test]
fn a_center_drag_follows_the_pointer_and_escape_cancels_it() {
    let mut harness = lit(Light::default());
    let before = light(&harness).position;
    let from = handle(&harness, Handle::Center);
    let to = from + vec2(130.0, -70.0);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(5.0, 5.0), to]);
    let after = light(&harness).position;
    assert!(projection(&harness).project(after).unwrap().distance(to) < 1.0);
    assert!((projection(&harness).depth(after) - projection(&harness).depth(before)).abs() < 1e-3);
    // Pressed, moved, then Escape: the light is as before, and there is no step.
    let press = |pos, pressed| {
        let modifiers = Modifiers::NONE;
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers }
    };
    harness.hover_at(to);
    harness.event(press(to, true));
    harness.hover_at(to + vec2(40.0, 40.0));
    harness.step();
    assert_ne!(light(&harness).position, after);
    harness.key_press(Key::Escape);
    harness.hover_at(to + vec2(90.0, 40.0));
    let eye = camera(&harness);
    harness.event(press(to + vec2(90.0, 40.0), false));
    harness.run();
    assert_eq!((light(&harness).position, camera(&harness)), (after, eye));
    assert_eq!(undo_name(&harness).as_deref(), Some("Position of Point 1"));
    assert_eq!(harness.state().session.view.lights.selected, Some(0));
}

#[test]
fn ctrl_snaps_to_a_tenth_of_a_metre_and_shift_slows_the_drag() {
    let mut harness = lit(Light::default());
    let from = handle(&harness, Handle::Center);
    let before = light(&harness).position;
    harness.event(Event::ModifiersChanged(Modifiers::COMMAND));
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(31.0, 17.0)]);
    let snapped = light(&harness).position;
    for axis in (snapped * 10.0).to_array() {
        assert!((axis - axis.round()).abs() < 1e-4, "{snapped}");
    }
    assert!(snapped.distance(before) > 0.1);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    let from = handle(&harness, Handle::Center);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(100.0, 0.0)]);
    let moved = projection(&harness).project(light(&harness).position).unwrap() - from;
    assert!((moved.x - 10.0).abs() < 0.5, "{moved}");
}

#[test]
fn radius_cone_and_direction_can_be_dragged() {
    let mut harness = lit(Light { kind: LightKind::Spot, direction: Vec3::new(0.3, -1.0, 0.0), ..Light::default() });
    let before = light(&harness);
    let mut pull = |what, by| {
        let from = handle(&harness, what);
        drag(&mut harness, PointerButton::Primary, &[from, from + by]);
        light(&harness)
    };
    let wider = pull(Handle::Radius, vec2(-50.0, 50.0));
    assert!(wider.radius > before.radius + 0.2, "{}", wider.radius);
    let way = pull(Handle::Aim, vec2(40.0, -20.0));
    assert!(way.direction.x > before.direction.normalize().x + 0.1, "{}", way.direction);
    assert_eq!((way.outer_angle, way.position), (before.outer_angle, before.position));
    // Seen from below the cone's center, one handle is to the left and the other to the right.
    let at = |harness: &Harness<'_, Window>, what| handle(harness, what);
    let middle = at(&harness, Handle::Aim);
    let rim = at(&harness, Handle::OuterAngle);
    drag(&mut harness, PointerButton::Primary, &[rim, rim + (rim - middle) * 0.3]);
    let outer = light(&harness).outer_angle;
    assert!(outer > before.outer_angle + 5.0, "{outer}");
    let middle = at(&harness, Handle::Aim);
    let rim = at(&harness, Handle::InnerAngle);
    drag(&mut harness, PointerButton::Primary, &[rim, rim + (middle - rim) * 0.5]);
    assert!(light(&harness).inner_angle < before.inner_angle - 5.0);
    assert!((light(&harness).outer_angle - outer).abs() < 1e-5);
    assert_eq!(undo_name(&harness).as_deref(), Some("Inner angle of Spot 1"));
}

#[test]
fn a_sun_is_moved_on_its_dome() {
    let mut harness =
        lit(Light { kind: LightKind::Directional, direction: Vec3::new(0.5, -1.0, -1.0), ..Light::default() });
    let from = handle(&harness, Handle::Aim);
    let to = from + vec2(120.0, 30.0);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(20.0, 0.0), to]);
    assert!(handle(&harness, Handle::Aim).distance(to) < 1.0);
    assert!((light(&harness).direction.length() - 1.0).abs() < 1e-5);
    assert_eq!(undo_name(&harness).as_deref(), Some("Direction of Sun 1"));
}

#[test]
fn a_click_selects_a_light_and_a_click_elsewhere_deselects() {
    let mut harness = lit(Light::default());
    let at = projection(&harness).project(light(&harness).position).unwrap();
    harness.state_mut().session.view.lights.selected = None;
    harness.run();
    let selected = |harness: &Harness<'_, Window>| harness.state().session.view.lights.selected;
    drag(&mut harness, PointerButton::Primary, &[at + vec2(6.0, 4.0)]);
    assert_eq!(selected(&harness), Some(0));
    assert_eq!(harness.state().session.view.tab, Tab::Light, "its settings are shown");
    // A drag elsewhere turns the camera and keeps the selection.
    let beside = at + vec2(-200.0, 140.0);
    let before = camera(&harness);
    drag(&mut harness, PointerButton::Primary, &[beside, beside + vec2(10.0, 0.0), beside + vec2(60.0, 0.0)]);
    assert_eq!(selected(&harness), Some(0));
    assert_ne!(camera(&harness), before);
    assert_eq!(undo_name(&harness).as_deref(), Some("Camera"));
    drag(&mut harness, PointerButton::Primary, &[beside]);
    assert_eq!(selected(&harness), None);
}

#[test]
fn a_light_dragged_within_one_long_frame_ends_under_the_pointer() {
    let mut harness = lit(Light::default());
    let from = handle(&harness, Handle::Center);
    let to = from + vec2(130.0, -70.0);
    flick(&mut harness, PointerButton::Primary, &[from, from + vec2(46.0, -20.0), to]);
    let after = light(&harness).position;
    assert!(projection(&harness).project(after).unwrap().distance(to) < 1.0, "{after}");
    assert_eq!(undo_name(&harness).as_deref(), Some("Position of Point 1"));
}

#[test]
fn escape_during_a_drag_leaves_no_keyframe() {
    let mut harness = moving();
    let before = harness.state().session.document.preset.clone();
    let from = shown_center(&harness);
    harness.hover_at(from);
    harness.run_steps(2);
    harness.drag_at(from);
    harness.run_steps(2);
    harness.hover_at(from + vec2(50.0, -30.0));
    harness.run_steps(3);
    assert_eq!(harness.state().session.document.preset.animation[0].keys.len(), 3);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    harness.drop_at(from + vec2(50.0, -30.0));
    harness.run_steps(3);
    assert_eq!(harness.state().session.document.preset, before);
    assert!((harness.state().session.playback.time - 2.0).abs() < 1e-6);
}
