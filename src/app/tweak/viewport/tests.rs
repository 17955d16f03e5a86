use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, Theme, TouchPhase, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::Vec3;
use haze::preset::Camera;
use haze::{Light, LightKind};

use super::handle::{Handle, Shape, handles};
use super::lens::Lens;
use crate::app::tweak::show::Tab;
use crate::app::tweak::smoke::Smoke;
use crate::app::tweak::testing::{brightness, picture, window};
use crate::app::tweak::window::Window;

const SIZE: [f32; 2] = [1100.0, 700.0];

/// A window with one light of its own, selected, one metre before the smoke.
fn lit(light: Light) -> Harness<'static, Window> {
    let mut harness = window("column", SIZE.into(), Theme::Dark);
    let session = &mut harness.state_mut().session;
    session.document.preset.lights = vec![Light { position: Vec3::new(0.4, 1.6, 1.0), ..light }];
    session.track(false);
    session.show.lights.follow(&session.document.preset.lights);
    session.show.lights.selected = Some(0);
    harness.run();
    harness
}

/// Where the picture is in the window.
fn viewport(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("viewport").rect()
}

/// Presses a button of the pointer, moves by way of some places and lets go.
fn drag(harness: &mut Harness<'_, Window>, button: PointerButton, places: &[Pos2]) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    harness.hover_at(places[0]);
    harness.event(press(places[0], true));
    for &place in &places[1..] {
        harness.hover_at(place);
    }
    harness.event(press(places[places.len() - 1], false));
    harness.run();
}

fn lens(harness: &Harness<'_, Window>) -> Lens {
    Lens::new(&harness.state().session.document.preset.camera, viewport(harness))
}

fn camera(harness: &Harness<'_, Window>) -> Camera {
    harness.state().session.document.preset.camera
}

fn light(harness: &Harness<'_, Window>) -> Light {
    harness.state().session.document.preset.lights[0]
}

fn undo_name(harness: &Harness<'_, Window>) -> Option<String> {
    harness.state().session.document.history().undo_name().map(str::to_owned)
}

/// Where a handle of the first light can be grabbed.
fn handle(harness: &Harness<'_, Window>, handle: Handle) -> Pos2 {
    let shapes = handles(&light(harness), &lens(harness));
    match shapes.into_iter().find(|shape| shape.0 == handle).unwrap().1 {
        Shape::Arrow([from, to]) => from.lerp(to, 0.7),
        Shape::Quad([a, _, c, _]) => a.lerp(c, 0.5),
        Shape::Square(at) | Shape::Knob(at) => at,
    }
}

#[test]
fn a_dragged_axis_moves_the_light_along_it_with_the_pointer_in_one_step() {
    for axis in 0..2 {
        let mut harness = lit(Light::default());
        let (before, seen) = (light(&harness).position, lens(&harness));
        let from = handle(&harness, Handle::Axis(axis));
        let along = seen.project(before + [Vec3::X, Vec3::Y][axis]).unwrap() - seen.project(before).unwrap();
        let to = from + along * 0.6;
        drag(&mut harness, PointerButton::Primary, &[from, from + along * 0.2, to]);
        let moved = light(&harness).position - before;
        assert!((moved[axis] - 0.6).abs() < 0.02, "axis {axis}: {moved}");
        assert!(moved.with_element(axis, 0.0).length() < 1e-6, "{moved}");
        assert!(handle(&harness, Handle::Axis(axis)).distance(to) < 6.0, "it stays under the pointer");
        assert_eq!(undo_name(&harness).as_deref(), Some("position of lamp 1 (point)"));
        harness.state_mut().session.undo();
        assert_eq!((light(&harness).position, undo_name(&harness)), (before, Some("light removed".into())));
    }
}

trait WithElement {
    fn with_element(self, index: usize, value: f32) -> Self;
}

impl WithElement for Vec3 {
    fn with_element(mut self, index: usize, value: f32) -> Self {
        self[index] = value;
        self
    }
}

#[test]
fn the_middle_follows_the_pointer_exactly_and_escape_puts_it_back() {
    let mut harness = lit(Light::default());
    let before = light(&harness).position;
    let from = handle(&harness, Handle::Centre);
    let to = from + vec2(130.0, -70.0);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(5.0, 5.0), to]);
    let after = light(&harness).position;
    assert!(lens(&harness).project(after).unwrap().distance(to) < 1.0);
    assert!((lens(&harness).depth(after) - lens(&harness).depth(before)).abs() < 1e-3);
    // Pressed, moved, then Escape: as it was, and no step.
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
    assert_eq!(undo_name(&harness).as_deref(), Some("position of lamp 1 (point)"));
    assert_eq!(harness.state().session.show.lights.selected, Some(0));
}

#[test]
fn ctrl_snaps_to_a_tenth_of_a_metre_and_shift_is_slow() {
    let mut harness = lit(Light::default());
    let (from, before) = (handle(&harness, Handle::Centre), light(&harness).position);
    harness.event(Event::ModifiersChanged(Modifiers::COMMAND));
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(31.0, 17.0)]);
    let snapped = light(&harness).position;
    for axis in (snapped * 10.0).to_array() {
        assert!((axis - axis.round()).abs() < 1e-4, "{snapped}");
    }
    assert!(snapped.distance(before) > 0.1);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    let from = handle(&harness, Handle::Centre);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(100.0, 0.0)]);
    let moved = lens(&harness).project(light(&harness).position).unwrap() - from;
    assert!((moved.x - 10.0).abs() < 0.5, "{moved}");
}

#[test]
fn radius_cone_and_direction_are_dragged() {
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
    // Under the middle of its cone the one handle is left of it, the other right.
    let at = |harness: &Harness<'_, Window>, what| handle(harness, what);
    let (middle, rim) = (at(&harness, Handle::Aim), at(&harness, Handle::OuterAngle));
    drag(&mut harness, PointerButton::Primary, &[rim, rim + (rim - middle) * 0.3]);
    let outer = light(&harness).outer_angle;
    assert!(outer > before.outer_angle + 5.0, "{outer}");
    let (middle, rim) = (at(&harness, Handle::Aim), at(&harness, Handle::InnerAngle));
    drag(&mut harness, PointerButton::Primary, &[rim, rim + (middle - rim) * 0.5]);
    assert!(light(&harness).inner_angle < before.inner_angle - 5.0);
    assert!((light(&harness).outer_angle - outer).abs() < 1e-5);
    assert_eq!(undo_name(&harness).as_deref(), Some("inner_angle of lamp 1 (spot)"));
}

#[test]
fn a_sun_is_turned_on_its_dome() {
    let mut harness =
        lit(Light { kind: LightKind::Directional, direction: Vec3::new(0.5, -1.0, -1.0), ..Light::default() });
    let from = handle(&harness, Handle::Aim);
    let to = from + vec2(120.0, 30.0);
    drag(&mut harness, PointerButton::Primary, &[from, from + vec2(20.0, 0.0), to]);
    assert!(handle(&harness, Handle::Aim).distance(to) < 1.0);
    assert!((light(&harness).direction.length() - 1.0).abs() < 1e-5);
    assert_eq!(undo_name(&harness).as_deref(), Some("direction of sun 1"));
}

#[test]
fn a_click_selects_a_light_and_a_click_beside_none() {
    let mut harness = lit(Light::default());
    let at = lens(&harness).project(light(&harness).position).unwrap();
    harness.state_mut().session.show.lights.selected = None;
    harness.run();
    let selected = |harness: &Harness<'_, Window>| harness.state().session.show.lights.selected;
    drag(&mut harness, PointerButton::Primary, &[at + vec2(6.0, 4.0)]);
    assert_eq!(selected(&harness), Some(0));
    // A drag beside it turns the camera and leaves it selected.
    let beside = at + vec2(-200.0, 140.0);
    let before = camera(&harness);
    drag(&mut harness, PointerButton::Primary, &[beside, beside + vec2(10.0, 0.0), beside + vec2(60.0, 0.0)]);
    assert_eq!(selected(&harness), Some(0));
    assert_ne!(camera(&harness), before);
    assert_eq!(undo_name(&harness).as_deref(), Some("camera"));
    drag(&mut harness, PointerButton::Primary, &[beside]);
    assert_eq!(selected(&harness), None);
}

#[test]
fn f_shows_all_of_the_smoke_or_the_light_and_home_leads_back() {
    let mut harness = lit(Light::default());
    let saved = camera(&harness);
    harness.key_press(Key::F);
    harness.run();
    assert!(camera(&harness).target.distance(light(&harness).position) < 1e-4);
    harness.state_mut().session.show.lights.selected = None;
    harness.key_press(Key::F);
    harness.run();
    let mut smoke = Smoke::default();
    let session = &harness.state().session;
    let bounds = smoke.of(session).bounds();
    assert_eq!(camera(&harness).target, bounds.centre());
    for corner in [bounds.min, bounds.max] {
        assert!(lens(&harness).project(corner).is_some_and(|at| viewport(&harness).contains(at)));
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
fn keys_do_nothing_while_something_is_typed() {
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
fn turns_of_the_wheel_are_one_step_and_go_towards_the_pointer() {
    let mut harness = lit(Light::default());
    let before = camera(&harness);
    let at = viewport(&harness).center() + vec2(150.0, -60.0);
    let point = lens(&harness).facing(at, before.target);
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
    assert!(lens(&harness).project(point).unwrap().distance(at) < 1.0);
    assert_eq!(undo_name(&harness).as_deref(), Some("camera"));
    harness.event(turn());
    harness.run_steps(6);
    harness.state_mut().session.undo();
    assert_eq!(camera(&harness), near, "after a pause it is another step");
    harness.state_mut().session.undo();
    assert_eq!(camera(&harness), before);
}

#[test]
fn the_right_button_flies() {
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
    let (after, ahead) = (camera(&harness), (before.target - before.position).normalize());
    let way = after.position - before.position;
    assert!(way.dot(ahead) > 0.5 && way.normalize().distance(ahead) < 1e-3, "{way}");
    assert_eq!(undo_name(&harness).as_deref(), Some("camera"));
    assert!(harness.query_by_label_contains("here").is_none(), "no menu opens");
}

#[test]
fn a_muted_light_is_out_of_the_picture_and_stays_in_the_preset() {
    let mut harness = lit(Light { intensity: 200.0, ..Light::default() });
    harness.state_mut().session.show.tab = Tab::Light;
    let part = viewport(&harness);
    let lit = brightness(&picture(&mut harness), part);
    let click = |harness: &mut Harness<'_, Window>, label| {
        harness.get_by_label(label).click();
        harness.run();
        // Tooltips reach over the picture.
        harness.remove_cursor();
        harness.run();
    };
    click(&mut harness, "Leave this light out, lamp 1 (point)");
    let dark = brightness(&picture(&mut harness), part);
    assert!(dark < lit - 5.0, "{dark} {lit}");
    assert_eq!(undo_name(&harness).as_deref(), Some("light removed"), "only the test's own change");
    click(&mut harness, "Show this light alone, lamp 1 (point)");
    assert!((brightness(&picture(&mut harness), part) - lit).abs() < 0.5);
}

#[test]
fn lights_are_added_duplicated_and_deleted_from_the_panel_and_by_key() {
    let mut harness = lit(Light::default());
    harness.state_mut().session.show.tab = Tab::Light;
    harness.run();
    let count = |harness: &Harness<'_, Window>| harness.state().session.document.preset.lights.len();
    let selected = |harness: &Harness<'_, Window>| harness.state().session.show.lights.selected;
    harness.get_by_label("Add").click();
    harness.run_steps(4);
    harness.get_by_label("spot").click();
    harness.run();
    assert_eq!(
        (count(&harness), selected(&harness), undo_name(&harness).as_deref()),
        (2, Some(1), Some("light added"))
    );
    harness.key_press_modifiers(Modifiers::COMMAND, Key::D);
    harness.run();
    assert_eq!((count(&harness), selected(&harness)), (3, Some(2)));
    harness.key_press(Key::Delete);
    harness.run();
    assert_eq!((count(&harness), selected(&harness), undo_name(&harness).as_deref()), (2, None, Some("light removed")));
    harness.get_by_label("lamp 2 (spot)").click();
    harness.run();
    harness.get_by_label("Behind the smoke").click();
    harness.run();
    let session = &harness.state().session;
    let mut behind = session.document.preset.lights[1];
    let bounds = Smoke::default().of(session).bounds();
    let is_behind = lens(&harness).depth(behind.position) > lens(&harness).depth(bounds.centre());
    assert!(is_behind && selected(&harness) == Some(1));
    // Set by angles, a direction keeps its azimuth at any elevation.
    behind.direction = Vec3::NEG_Z;
    harness.state_mut().session.document.preset.lights[1] = behind;
    harness.run();
    let elevation = |value: f64, harness: &mut Harness<'_, Window>| {
        let role = eframe::egui::Role::Slider;
        let is_slider = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == role;
        harness.get_all_by_label("elevation").find(is_slider).unwrap().set_value_accesskit(value);
        harness.run();
    };
    elevation(90.0, &mut harness);
    assert!(harness.state().session.document.preset.lights[1].direction.y < -0.99);
    elevation(0.0, &mut harness);
    assert!(harness.state().session.document.preset.lights[1].direction.distance(Vec3::NEG_Z) < 0.01);
}

#[test]
fn a_right_click_adds_a_light_there_and_another_behind_the_smoke() {
    let mut harness = lit(Light::default());
    let at = viewport(&harness).center() + vec2(-160.0, -40.0);
    drag(&mut harness, PointerButton::Secondary, &[at]);
    harness.run_steps(3);
    harness.get_by_label("Add spot light here").click();
    harness.run();
    let added = |harness: &Harness<'_, Window>| *harness.state().session.document.preset.lights.last().unwrap();
    let spot = added(&harness);
    assert!(spot.kind == LightKind::Spot && lens(&harness).project(spot.position).unwrap().distance(at) < 1.0);
    assert_eq!(undo_name(&harness).as_deref(), Some("light added"));
    harness.state_mut().session.show.lights.selected = None;
    harness.key_press_modifiers(Modifiers::SHIFT, Key::B);
    harness.run();
    assert_eq!(harness.state().session.document.preset.lights.len(), 3);
    assert!(lens(&harness).depth(added(&harness).position) > lens(&harness).depth(spot.position));
}

#[test]
fn a_light_is_put_behind_the_smoke_that_is_clicked_on_or_in_the_picture() {
    let mut harness = lit(Light::default());
    let session = &harness.state().session;
    let mut smoke = Smoke::default();
    let sprites = &smoke.of(session).systems[0];
    let in_view = |at: &Pos2| viewport(&harness).shrink(40.0).contains(*at);
    let seen = sprites.iter().filter(|sprite| lens(&harness).project(sprite.position).is_some_and(|at| in_view(&at)));
    let top = seen.max_by(|a, b| a.position.y.total_cmp(&b.position.y)).unwrap().position;
    let at = lens(&harness).project(top).unwrap();
    drag(&mut harness, PointerButton::Secondary, &[at]);
    harness.run_steps(3);
    harness.get_by_label("Behind the smoke").click();
    harness.run();
    let is_behind = |harness: &Harness<'_, Window>| {
        let (lens, place) = (lens(harness), light(harness).position);
        assert!(lens.depth(place) > lens.depth(top), "{place}");
        lens.project(place).unwrap()
    };
    assert!(is_behind(&harness).distance(at) < 1.0, "not under the pointer");
    // So close that the middle of all smoke is out of the picture.
    let camera = &mut harness.state_mut().session.document.preset.camera;
    (camera.position, camera.target) = (top + Vec3::new(0.0, -0.1, 1.2), top);
    harness.run();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::B);
    harness.run();
    assert!(viewport(&harness).contains(is_behind(&harness)));
}

#[test]
fn overlays_are_drawn_while_they_are_on() {
    let mut harness = lit(Light::default());
    let part = viewport(&harness);
    let plain = picture(&mut harness);
    for name in ["Bounds", "Lit plane", "Particles", "Grid"] {
        let mut click = || {
            harness.get_by_label(name).click();
            harness.remove_cursor();
            harness.run();
            // What is drawn is known from the picture before.
            picture(&mut harness);
            picture(&mut harness)
        };
        let (on, off) = (click(), click());
        let changed = |other: &image::RgbaImage| {
            let pixels = plain.enumerate_pixels().zip(other.pixels());
            let in_view =
                pixels.filter(|((x, y, _), _)| part.shrink2(vec2(0.0, 40.0)).contains(Pos2::new(*x as f32, *y as f32)));
            in_view.filter(|((_, _, a), b)| a != b).count()
        };
        assert!(changed(&on) > 300, "{name}: {}", changed(&on));
        assert!(changed(&off) < 20, "{name}: {}", changed(&off));
    }
}

#[test]
fn the_turntable_takes_lights_round_and_leaves_the_preset_alone() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    let before = harness.state().session.document.preset.clone();
    let shown = |harness: &Harness<'_, Window>| harness.state().session.shot(glam::UVec2::splat(8)).preset.lights[0];
    harness.key_press(Key::T);
    harness.run_steps(8);
    assert!(shown(&harness).position.distance(before.lights[0].position) > 0.2);
    harness.key_press(Key::T);
    harness.run();
    assert_eq!((shown(&harness), &harness.state().session.document.preset), (before.lights[0], &before));
}

#[test]
fn a_true_puff_is_lit_beside_the_ramps_of_the_smoke_while_lights_go_round() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    harness.key_press(Key::T);
    // The figures below the puffs, once they are others than `before`: what is chosen is loaded and compared in the background.
    let figures = |harness: &mut Harness<'_, Window>, before: &str| {
        let begun = std::time::Instant::now();
        loop {
            if let Some(node) = harness.query_by_label_contains("all round: ") {
                let node = node.accesskit_node();
                let text = node.label().filter(|label| !label.is_empty()).or(node.value()).unwrap_or_default();
                if text != before {
                    return text;
                }
            }
            assert!(begun.elapsed().as_secs() < 120, "nothing but {before:?}");
            std::thread::sleep(std::time::Duration::from_millis(20));
            harness.run_steps(1);
        }
    };
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("path-tracing").is_some());
    let of_painted = figures(&mut harness, "");
    if let Some(folder) = std::env::var_os("HAZE_LOOK") {
        picture(&mut harness).save(std::path::Path::new(&folder).join("puff.png")).unwrap();
    }
    // The ramps that were fitted to it.
    let material = &mut harness.state_mut().session.document.preset.systems[0].material;
    material.diffuse_ramp = "diffuse_traced_ash".into();
    let of_other = figures(&mut harness, &of_painted);
    let error = |text: &str| text.split([' ', '%']).find_map(|word| word.parse::<f32>().ok()).unwrap();
    assert!(error(&of_painted) > 10.0 && error(&of_other) > 1.0, "{of_painted} {of_other}");
    harness.key_press(Key::T);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("all round: ").is_none());
}

#[test]
fn the_scene_is_chosen_and_its_props_are_put_away() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    let environment = |harness: &Harness<'_, Window>| harness.state().session.document.preset.environment;
    harness.get_by_label("Scene").click();
    harness.run_steps(3);
    harness.get_by_label("lamp").click();
    harness.run_steps(3);
    assert!(!environment(&harness).lamp && environment(&harness).brazier);
    harness.get_by_label("studio").click();
    harness.run_steps(3);
    assert_eq!(environment(&harness).scene.name(), "studio");
}
