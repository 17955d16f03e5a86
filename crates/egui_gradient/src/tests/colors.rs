//! Tests of color fields, pasted colors and the eyedropper.

use super::*;

fn color(harness: &Harness<'_, Host>, index: usize) -> [u8; 3] {
    harness.state().row.stops[index].color.0
}

fn type_into(harness: &mut Harness<'_, Host>, name: &str, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, name).click();
    harness.run_steps(2);
    harness.event(Event::Text(text.into()));
    harness.run_steps(2);
    key(harness, Key::Enter, NONE);
}

#[test]
fn hue_saturation_and_value_can_be_typed() {
    let mut harness = host(&[(0.0, 100), (1.0, 20)]);
    for (name, number, expected) in [
        // A gray remembers its hue and shows it once it has a saturation.
        ("hue", "210", [100, 100, 100]),
        ("saturation", "50", [50, 75, 100]),
        ("value", "100", [128, 191, 255]),
        ("saturation", "0", [255, 255, 255]),
        ("saturation", "100", [0, 128, 255]),
    ] {
        type_into(&mut harness, name, number);
        assert_eq!(color(&harness, 0), expected, "{name} {number}");
    }
    // Changing only the hue of a gray is not a step.
    assert_eq!(steps(&harness), ["color of a stop"; 4]);
    // The remembered hue belongs to one stop only.
    harness.get_by_label("next stop").click();
    harness.run_steps(2);
    type_into(&mut harness, "saturation", "50");
    assert_eq!(color(&harness, 1), [20, 10, 10]);
}

#[test]
fn a_pasted_color_is_applied_to_the_selected_stop() {
    let mut harness = host(&[(0.0, 100), (1.0, 20)]);
    harness.get_by_label("stop 2").focus();
    harness.run_steps(2);
    harness.event(Event::Paste(" #ff8000\n".into()));
    harness.run_steps(2);
    assert_eq!((color(&harness, 0), color(&harness, 1)), ([100; 3], [255, 128, 0]));
    assert_eq!((steps(&harness), harness.state().refused.len()), (vec!["color of a stop"], 0));
}

/// Activates the eyedropper with press and release in one frame.
fn begin(harness: &mut Harness<'_, Host>) {
    let pos = harness.get_by_label("Pick color").rect().center();
    harness.hover_at(pos);
    harness.step();
    let button = |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: NONE };
    harness.input_mut().events.extend([true, false].map(button));
    harness.run_steps(3);
    assert!(harness.state().editor.state.eyedropper.is_some());
}

#[test]
fn the_eyedropper_picks_a_color_and_blocks_other_widgets() {
    let mut harness = host(&[(0.0, 0), (1.0, 255)]);
    let at = on_strip(&harness, 0.7);
    let expected = {
        let shown = harness.render().unwrap();
        let [r, g, b, _] = shown.get_pixel(at.x as u32, at.y as u32).0;
        [r, g, b]
    };
    begin(&mut harness);
    click(&mut harness, at, NONE);
    harness.run_steps(2);
    assert_eq!((positions(&harness), color(&harness, 0)), (vec![0.0, 1.0], expected));
    assert!(expected[0] > 100, "{expected:?}");
    assert_eq!(steps(&harness), ["color of a stop"]);
    assert!(harness.state().editor.state.eyedropper.is_none());
    // Escape cancels the eyedropper.
    begin(&mut harness);
    key(&mut harness, Key::Escape, NONE);
    assert!(harness.state().editor.state.eyedropper.is_none());
    click(&mut harness, at, NONE);
    assert_eq!(positions(&harness).len(), 3);
}

#[test]
fn a_stroke_picks_the_gradient_along_its_path() {
    let mut harness = host(&[(0.0, 0), (0.5, 250), (1.0, 40)]);
    begin(&mut harness);
    let from = on_strip(&harness, 0.99);
    let width = strip(&harness).width();
    // The stroke runs over the strip from right to left, so the result is the reversed gradient.
    let wanted = {
        let row = harness.state().row.clone();
        let recipe = haze_author::ramp::RampRecipe { rows: vec![row], ..Default::default() };
        recipe.gradient().unwrap()
    };
    drag(&mut harness, from, -0.98 * width, NONE);
    harness.run_steps(3);
    let row = harness.state().row.clone();
    assert!((3..20).contains(&row.stops.len()), "{row:?}");
    let recipe = haze_author::ramp::RampRecipe { rows: vec![row], ..Default::default() };
    let taken = recipe.gradient().unwrap();
    let code = |light: f32| haze_core::formula::color::srgb_from_linear(light) * 255.0;
    for step in 5..=95 {
        let at = step as f32 / 100.0;
        let taken = code(taken.sample(at, 0.0).x);
        let wanted = code(wanted.sample(0.99 - 0.98 * at, 0.0).x);
        // Tolerance: 10 for the fit, and the change of color over half a part of the stroke.
        assert!((taken - wanted).abs() < 20.0, "{at}: {taken} {wanted}");
    }
    assert_eq!(steps(&harness), ["gradient of a stroke"]);
}

#[test]
fn the_eyedropper_has_a_magnifier_and_is_moved_by_keys() {
    let mut harness = host(&[(0.0, 0), (1.0, 255)]);
    begin(&mut harness);
    let at = on_strip(&harness, 0.5);
    harness.hover_at(at);
    harness.run_steps(3);
    let said = |harness: &Harness<'_, Host>| {
        let node = harness.get_by_label_contains("×");
        node.accesskit_node().label().or_else(|| node.accesskit_node().value()).unwrap_or_default()
    };
    assert!(said(&harness).ends_with("1×1"), "{}", said(&harness));
    let before = said(&harness);
    // On a gradient from black to white, ten pixels to the right is lighter.
    key(&mut harness, Key::ArrowRight, Modifiers::SHIFT);
    let lighter = said(&harness);
    assert!(lighter > before, "{before} {lighter}");
    key(&mut harness, Key::ArrowLeft, Modifiers::SHIFT);
    assert_eq!(said(&harness), before);
    key(&mut harness, Key::Num5, NONE);
    assert!(said(&harness).ends_with("5×5"), "{}", said(&harness));
    key(&mut harness, Key::Num1, NONE);
    assert!(steps(&harness).is_empty(), "nothing is taken yet");
    key(&mut harness, Key::Enter, NONE);
    assert_eq!(steps(&harness), ["color of a stop"]);
    assert!(before.starts_with(&String::from(HexColor(color(&harness, 0)))), "{before}");
    // A stroke by keys alone.
    harness.get_by_label("Pick color").focus();
    harness.run_steps(2);
    key(&mut harness, Key::Enter, NONE);
    harness.hover_at(at);
    harness.run_steps(2);
    key(&mut harness, Key::Space, NONE);
    for _ in 0..5 {
        key(&mut harness, Key::ArrowRight, Modifiers::SHIFT);
    }
    key(&mut harness, Key::Enter, NONE);
    assert_eq!(steps(&harness), ["color of a stop", "gradient of a stroke"]);
    assert!(grays(&harness).is_sorted(), "{:?}", grays(&harness));
}
