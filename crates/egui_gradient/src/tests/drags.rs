//! Tests of drags that snap, copy, or are cancelled.

use super::*;

#[test]
fn positions_snap_to_the_chosen_number_of_parts() {
    let mut harness = host(&[(0.0, 0), (0.5, 20), (1.0, 30)]);
    let width = strip(&harness).width();
    let parts =
        harness.get_all_by_role(Role::SpinButton).find(|node| node.value().is_some_and(|text| text.contains("parts")));
    parts.unwrap().click();
    harness.run_steps(2);
    harness.event(Event::Text("8".into()));
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    let from = handle(&harness, 1).center();
    drag(&mut harness, from, 0.14 * width, Modifiers::COMMAND);
    assert_eq!(positions(&harness), [0.0, 0.625, 1.0]);
    // With snapping switched on, positions snap without Ctrl, and Ctrl disables it.
    harness.get_by_label("Snap").click();
    harness.run_steps(2);
    let from = handle(&harness, 1).center();
    drag(&mut harness, from, 0.11 * width, NONE);
    assert_eq!(positions(&harness), [0.0, 0.75, 1.0]);
    let from = handle(&harness, 1).center();
    drag(&mut harness, from, 0.03 * width, Modifiers::COMMAND);
    assert!((positions(&harness)[1] - 0.78).abs() < 0.002, "{:?}", positions(&harness));
    key(&mut harness, Key::ArrowLeft, NONE);
    assert_eq!(positions(&harness), [0.0, 0.75, 1.0]);
    let at = on_strip(&harness, 0.2);
    click(&mut harness, at, NONE);
    assert_eq!(positions(&harness), [0.0, 0.25, 0.75, 1.0]);
}

#[test]
fn with_shift_a_stop_snaps_to_another_stop() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (0.6, 20), (1.0, 30)]);
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    drag(&mut harness, from, 0.29 * width, Modifiers::SHIFT);
    assert_eq!(
        (harness.state().row.stops[1].at, grays(&harness)),
        (harness.state().row.stops[2].at, vec![0, 10, 20, 30])
    );
    // It snaps only to a stop nearby.
    let from = handle(&harness, 1).center();
    drag(&mut harness, from, -0.2 * width, Modifiers::SHIFT);
    assert!((positions(&harness)[1] - 0.4).abs() < 0.005, "{:?}", positions(&harness));
}

/// Presses at a position and moves the pointer without releasing the button.
fn hold(harness: &mut Harness<'_, Host>, from: Pos2, by: f32) {
    harness.hover_at(from);
    harness.step();
    button(harness, from, true, NONE);
    for part in 1..=4 {
        harness.hover_at(from + Vec2::new(by * part as f32 / 4.0, 0.0));
        harness.step();
    }
}

#[test]
fn escape_cancels_a_drag_without_an_undo_step() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (0.5, 20), (1.0, 30)]);
    let before = harness.state().row.clone();
    let width = strip(&harness).width();
    for (from, by) in [(handle(&harness, 1).center(), 0.4), (on_strip(&harness, 0.8), 0.1)] {
        hold(&mut harness, from, by * width);
        assert_ne!(harness.state().row, before);
        key(&mut harness, Key::Escape, NONE);
        assert_eq!(harness.state().row, before);
        let end = from + Vec2::new(0.5 * by * width, 0.0);
        harness.hover_at(end);
        harness.step();
        button(&mut harness, end, false, NONE);
        harness.run_steps(2);
        assert_eq!((&harness.state().row, steps(&harness).len()), (&before, 0));
    }
    // The next drag works as usual.
    let from = handle(&harness, 1).center();
    drag(&mut harness, from, 0.1 * width, NONE);
    assert_eq!((positions(&harness), steps(&harness)), (vec![0.0, 0.4, 0.5, 1.0], vec!["move a stop"]));
}

#[test]
fn a_drag_with_alt_moves_a_copy() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (1.0, 30)]);
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    drag(&mut harness, from, 0.2 * width, Modifiers::ALT);
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.0, 0.3, 0.5, 1.0], vec![0, 10, 10, 30]));
    assert_eq!((steps(&harness), harness.state().editor.state.selection.lead()), (vec!["copy a stop"], 2));
}

#[test]
fn alt_during_a_drag_slows_it_to_a_tenth_and_the_readout_shows_the_position() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (1.0, 30)]);
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    hold(&mut harness, from, 0.2 * width);
    assert!(harness.query_by_label("0.5000  #0a0a0a").is_some());
    let fine = from + Vec2::new(0.3 * width, 0.0);
    harness.event(Event::ModifiersChanged(Modifiers::ALT));
    harness.hover_at(fine);
    harness.run_steps(2);
    assert!((harness.state().row.stops[1].at - 0.51).abs() < 1.0e-4, "{:?}", positions(&harness));
    assert!(harness.query_by_label("0.5100  #0a0a0a  fine").is_some());
    // After Alt is released, the stop follows the pointer at full speed.
    harness.event(Event::ModifiersChanged(NONE));
    harness.hover_at(from + Vec2::new(0.4 * width, 0.0));
    harness.run_steps(2);
    assert!((harness.state().row.stops[1].at - 0.61).abs() < 1.0e-4, "{:?}", positions(&harness));
    button(&mut harness, from + Vec2::new(0.4 * width, 0.0), false, NONE);
    harness.run_steps(2);
    assert_eq!((steps(&harness), harness.state().row.stops.len()), (vec!["move a stop"], 3));
    assert!(harness.query_by_label_contains("#0a0a0a").is_none(), "nothing is left of it");
}

#[test]
fn a_drag_ends_if_the_host_replaces_the_stops() {
    let mut harness = host(&[(0.0, 0), (0.3, 10), (1.0, 30)]);
    let before = harness.state().row.clone();
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    hold(&mut harness, from, 0.2 * width);
    harness.state_mut().row = before.clone();
    harness.hover_at(from + Vec2::new(0.3 * width, 0.0));
    harness.run_steps(2);
    assert_eq!(harness.state().row, before);
}

/// Presses at a position, moves to others, and calls `check` after each. Then releases.
fn drag_through(
    harness: &mut Harness<'_, Host>,
    from: Pos2,
    positions: &[Pos2],
    mut check: impl FnMut(&Harness<'_, Host>, usize),
) {
    harness.hover_at(from);
    harness.step();
    button(harness, from, true, NONE);
    for (index, position) in positions.iter().enumerate() {
        harness.hover_at(*position);
        harness.run_steps(2);
        check(harness, index);
    }
    button(harness, positions[positions.len() - 1], false, NONE);
    harness.run_steps(2);
}

#[test]
fn a_stop_dragged_off_the_strip_is_removed_and_comes_back_with_the_pointer() {
    let mut harness = host(&[(0.0, 0), (0.5, 20), (1.0, 30)]);
    let from = handle(&harness, 1).center();
    let near = from + Vec2::new(30.0, 4.0);
    let off = from + Vec2::new(30.0, 70.0);
    let counts = [3, 2, 3, 2];
    drag_through(&mut harness, from, &[near, off, near, off], |harness, index| {
        assert_eq!(harness.state().row.stops.len(), counts[index], "{index}");
        let says = harness.query_all_by_label_contains("Release to delete #141414").next().is_some();
        assert_eq!(says, counts[index] == 2, "{index}");
    });
    assert_eq!((grays(&harness), steps(&harness)), (vec![0, 30], vec!["remove a stop"]));
    // Brought back before the release, it is moved.
    let from = handle(&harness, 1).center();
    let off = from + Vec2::new(-40.0, -90.0);
    let near = from - Vec2::new(40.0, 0.0);
    drag_through(&mut harness, from, &[off, near], |_, _| {});
    assert_eq!((grays(&harness), steps(&harness)), (vec![0, 30], vec!["remove a stop", "move a stop"]));
    // Escape restores it, and the last stop cannot be removed.
    let from = handle(&harness, 1).center();
    hold(&mut harness, from, 0.0);
    harness.hover_at(from + Vec2::new(0.0, 80.0));
    harness.run_steps(2);
    assert_eq!(harness.state().row.stops.len(), 1);
    key(&mut harness, Key::Escape, NONE);
    button(&mut harness, from, false, NONE);
    harness.run_steps(2);
    assert_eq!((grays(&harness), steps(&harness).len()), (vec![0, 30], 2));
    let mut harness = host(&[(0.5, 20)]);
    let from = handle(&harness, 0).center();
    drag_through(&mut harness, from, &[from + Vec2::new(0.0, 90.0)], |_, _| {});
    assert_eq!(grays(&harness), [20]);
}

#[test]
fn the_middle_between_two_stops_is_dragged() {
    let mut harness = host(&[(0.0, 0), (0.4, 200), (1.0, 30)]);
    let width = strip(&harness).width();
    let middle = harness.get_by_label("middle between stop 1 and 2").rect().center();
    let color = {
        let row = harness.state().row.clone();
        let gradient = stop_operations::gradient(&row.stops, haze_author::ramp::Blend::default()).unwrap();
        gradient_strip::color_at(&gradient, 0.2).0[0]
    };
    drag(&mut harness, middle, 0.1 * width, NONE);
    assert_eq!((grays(&harness), steps(&harness)), (vec![0, color, 200, 30], vec!["add a stop"]));
    assert!((positions(&harness)[1] - 0.3).abs() < 0.01, "{:?}", positions(&harness));
    // No mark where there is no room for it.
    assert!(harness.query_by_label("middle between stop 2 and 3").is_none());
}

#[test]
fn a_simpler_gradient_is_chosen_by_its_error() {
    let mut harness = host(&[(0.0, 0), (0.25, 50), (0.5, 100), (0.75, 60), (1.0, 20)]);
    harness.get_by_label("Simplify").click();
    harness.run_steps(3);
    harness.get_by_label_contains("3 stops, error").click();
    harness.run_steps(3);
    assert_eq!((harness.state().row.stops.len(), steps(&harness)), (3, vec!["simplify"]));
}

#[test]
fn a_stop_under_the_pointer_is_pointed_at_and_its_tooltip_is_one_line() {
    let mut harness = host(&[(0.0, 0), (0.5, 20), (1.0, 30)]);
    let middle = handle(&harness, 1).center();
    harness.hover_at(middle);
    harness.run_steps(8);
    assert_eq!(harness.state().pointed_at, Some(0.5));
    let tooltip = harness.get_by_label_contains("#141414 at 0.5000").rect();
    assert!(tooltip.height() < 24.0, "{tooltip}");
}
