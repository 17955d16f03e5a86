//! Tests of selections of several stops.

use super::*;

const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL: Modifiers = Modifiers::COMMAND;

fn selected(harness: &Harness<'_, Host>) -> Vec<usize> {
    harness.state().editor.state.selection.iter().collect()
}

fn press(harness: &mut Harness<'_, Host>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(3);
}

fn click_handle(harness: &mut Harness<'_, Host>, index: usize, modifiers: Modifiers) {
    let at = handle(harness, index).center();
    click(harness, at, modifiers);
}

const FIVE: [(f32, u8); 5] = [(0.0, 0), (0.2, 10), (0.4, 20), (0.7, 30), (1.0, 40)];

#[test]
fn clicks_select_ranges_and_toggle_stops() {
    let mut harness = host(&FIVE);
    for (index, modifiers, expected) in [
        (1, NONE, vec![1]),
        (3, SHIFT, vec![1, 2, 3]),
        (2, SHIFT, vec![1, 2]),
        (4, CTRL, vec![1, 2, 4]),
        (1, CTRL, vec![2, 4]),
        (0, NONE, vec![0]),
    ] {
        click_handle(&mut harness, index, modifiers);
        assert_eq!(selected(&harness), expected);
    }
    assert!(steps(&harness).is_empty());
}

#[test]
fn a_band_selects_the_stops_under_it() {
    let mut harness = host(&FIVE);
    let strip = strip(&harness);
    let width = strip.width();
    let from = pos2(strip.left() + 0.1 * width, strip.bottom() + 3.0);
    drag(&mut harness, from, 0.4 * width, NONE);
    assert_eq!((selected(&harness), steps(&harness).len()), (vec![1, 2], 0));
    assert!(harness.get_by_label("stop 3").accesskit_node().is_focused());
    drag(&mut harness, from + Vec2::new(0.7 * width, 0.0), -0.5 * width, NONE);
    assert_eq!(selected(&harness), [2, 3]);
}

#[test]
fn selected_stops_are_dragged_together_in_one_step() {
    let mut harness = host(&FIVE);
    click_handle(&mut harness, 1, NONE);
    click_handle(&mut harness, 2, SHIFT);
    let from = handle(&harness, 1).center();
    let width = strip(&harness).width();
    drag(&mut harness, from, 0.4 * width, NONE);
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.0, 0.6, 0.7, 0.8, 1.0], vec![0, 10, 30, 20, 40]));
    assert_eq!((selected(&harness), steps(&harness)), (vec![1, 3], vec!["move stops"]));
    let from = handle(&harness, 3).center();
    drag(&mut harness, from, 9.0 * width, NONE);
    assert_eq!(positions(&harness), [0.0, 0.7, 0.8, 1.0, 1.0], "at the end they keep their distances");
    // A drag with Alt moves copies of both.
    let from = handle(&harness, 2).center();
    drag(&mut harness, from, -0.5 * width, Modifiers::ALT);
    assert_eq!(harness.state().row.stops.len(), 7);
    assert_eq!(steps(&harness)[2], "copy stops");
}

#[test]
fn keys_select_and_change_several_stops() {
    let mut harness = host(&FIVE);
    harness.get_by_label("stop 2").focus();
    harness.run_steps(3);
    key(&mut harness, Key::ArrowDown, SHIFT);
    assert_eq!(selected(&harness), [1, 2]);
    key(&mut harness, Key::ArrowRight, SHIFT);
    assert_eq!(positions(&harness), [0.0, 0.21, 0.41, 0.7, 1.0]);
    // Ctrl moves only the focus; Space adds the focused stop.
    key(&mut harness, Key::ArrowDown, CTRL);
    key(&mut harness, Key::ArrowDown, CTRL);
    assert_eq!(selected(&harness), [1, 2]);
    assert!(harness.get_by_label("stop 5").accesskit_node().is_focused());
    key(&mut harness, Key::Space, NONE);
    assert_eq!(selected(&harness), [1, 2, 4]);
    key(&mut harness, Key::Delete, NONE);
    assert_eq!((grays(&harness), selected(&harness)), (vec![0, 30], vec![1]));
    key(&mut harness, Key::A, CTRL);
    assert_eq!(selected(&harness), [0, 1]);
    key(&mut harness, Key::Escape, NONE);
    assert_eq!(selected(&harness), [1]);
    assert!(harness.get_by_label("stop 2").accesskit_node().is_focused());
    key(&mut harness, Key::Home, SHIFT);
    assert_eq!(selected(&harness), [0, 1]);
    assert_eq!(steps(&harness), ["move stops", "remove stops"]);
}

#[test]
fn buttons_and_fields_change_several_stops() {
    let mut harness = host(&FIVE);
    click_handle(&mut harness, 1, NONE);
    click_handle(&mut harness, 3, SHIFT);
    press(&mut harness, "Distribute");
    assert_eq!(positions(&harness), [0.0, 0.2, 0.45, 0.7, 1.0]);
    press(&mut harness, "Flip");
    assert_eq!((positions(&harness), grays(&harness)), (vec![0.0, 0.2, 0.45, 0.7, 1.0], vec![0, 30, 20, 10, 40]));
    press(&mut harness, "Mirror");
    assert_eq!(grays(&harness), [0, 30, 20, 10, 20, 30, 40]);
    assert_eq!(selected(&harness), [1, 2, 3, 4, 5]);
    harness.get_by_role_and_label(Role::TextInput, "Color").click();
    harness.run_steps(2);
    key(&mut harness, Key::A, CTRL);
    harness.event(Event::Text("#070707".into()));
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    assert_eq!(grays(&harness), [0, 7, 7, 7, 7, 7, 40]);
    press(&mut harness, "Remove");
    assert_eq!(grays(&harness), [0, 40]);
    assert_eq!(
        steps(&harness),
        ["distribute a part", "flip a part", "mirror a part", "color of stops", "remove stops"]
    );
}

#[test]
fn the_middle_button_removes_a_stop() {
    let mut harness = host(&FIVE);
    let pos = handle(&harness, 1).center();
    harness.hover_at(pos);
    harness.step();
    for pressed in [true, false] {
        harness.event(Event::PointerButton { pos, button: PointerButton::Middle, pressed, modifiers: NONE });
        harness.step();
    }
    harness.run_steps(2);
    assert_eq!((grays(&harness), steps(&harness)), (vec![0, 20, 30, 40], vec!["remove a stop"]));
}

fn type_position(harness: &mut Harness<'_, Host>, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, "Position").click();
    harness.run_steps(2);
    harness.event(Event::Text(text.into()));
    harness.run_steps(2);
    key(harness, Key::Enter, NONE);
    harness.run_steps(3);
}

#[test]
fn relative_changes_can_be_typed() {
    let mut harness = host(&FIVE);
    click_handle(&mut harness, 1, NONE);
    for (text, expected) in [("+0.05", 0.25), ("*2", 0.5), ("/4", 0.125), ("-0.025", 0.1), ("0.3", 0.3), ("x", 0.3)] {
        type_position(&mut harness, text);
        // The index of the lead changes if it passes another stop.
        assert_eq!(positions(&harness)[harness.state().editor.state.selection.lead()], expected, "{text}");
    }
    assert_eq!(steps(&harness), ["move a stop"; 5], "each is done once");
    click_handle(&mut harness, 2, SHIFT);
    type_position(&mut harness, "+0.1");
    assert_eq!(positions(&harness), [0.0, 0.4, 0.5, 0.7, 1.0]);
    type_position(&mut harness, "*0.5");
    assert_eq!(positions(&harness), [0.0, 0.2, 0.25, 0.7, 1.0]);
}

#[test]
fn relative_color_changes_apply_to_each_selected_stop() {
    let mut harness = host(&[(0.0, 200), (0.5, 100), (1.0, 40)]);
    click_handle(&mut harness, 0, NONE);
    click_handle(&mut harness, 1, SHIFT);
    harness.get_by_role_and_label(Role::SpinButton, "value").click();
    harness.run_steps(2);
    harness.event(Event::Text("*0.5".into()));
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    harness.run_steps(3);
    assert_eq!((grays(&harness), steps(&harness)), (vec![100, 50, 40], vec!["color of stops"]));
}
