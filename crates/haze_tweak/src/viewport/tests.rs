mod camera_input;
mod light_gizmo;
mod pixel_readout;
mod smoke_paint;
mod turntable;

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Theme, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::Vec3;
use haze::{Light, LightKind, LightRole};
use haze_preset::Camera;

use super::light_handle::{Handle, Shape, handles};
use super::screen_projection::ScreenProjection;
use crate::session::smoke_geometry::SmokeGeometry;
use crate::session::view_options::Tab;
use crate::window::Window;
use crate::window::drag_end::split_events_at_buttons;
use crate::window::testing::{brightness, screenshot, window};

const SIZE: [f32; 2] = [1100.0, 700.0];

/// Opens a window with one selected light, one metre in front of the smoke.
fn lit(light: Light) -> Harness<'static, Window> {
    let mut harness = window("column", SIZE.into(), Theme::Dark);
    let session = &mut harness.state_mut().session;
    session.document.preset.lights = vec![Light { position: Vec3::new(0.4, 1.6, 1.0), ..light }];
    session.track(false);
    session.view.lights.follow(&session.document.preset.lights);
    session.view.lights.selected = Some(0);
    // A busy machine renders thumbnails of systems in between, so that it does not rest.
    harness.run_steps(6);
    harness
}

/// Returns the rectangle of the viewport.
fn viewport(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("viewport").rect()
}

/// Presses a pointer button, moves along positions and releases it.
fn drag(harness: &mut Harness<'_, Window>, button: PointerButton, positions: &[Pos2]) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    harness.hover_at(positions[0]);
    harness.event(press(positions[0], true));
    for &position in &positions[1..] {
        harness.hover_at(position);
    }
    harness.event(press(positions[positions.len() - 1], false));
    harness.run();
}

/// Moves the pointer along positions with a button held, in a single frame as after a long wait. The window then splits
/// the events as for a display.
fn flick(harness: &mut Harness<'_, Window>, button: PointerButton, positions: &[Pos2]) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    let first = positions[0];
    let last = positions[positions.len() - 1];
    harness.hover_at(first);
    harness.step();
    let moves = positions[1..].iter().map(|&position| Event::PointerMoved(position));
    let mut events: Vec<_> = [press(first, true)].into_iter().chain(moves).chain([press(last, false)]).collect();
    let mut later = Vec::new();
    loop {
        split_events_at_buttons(&mut later, &mut events);
        harness.input_mut().events = std::mem::take(&mut events);
        harness.step();
        if later.is_empty() {
            break;
        }
    }
    harness.run();
}

fn projection(harness: &Harness<'_, Window>) -> ScreenProjection {
    ScreenProjection::new(&harness.state().session.document.preset.camera, viewport(harness))
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

/// Returns a position where a handle of the first light can be hit.
fn handle(harness: &Harness<'_, Window>, handle: Handle) -> Pos2 {
    let shapes = handles(&light(harness), &projection(harness));
    match shapes.into_iter().find(|shape| shape.0 == handle).unwrap().1 {
        Shape::Arrow([from, to]) => from.lerp(to, 0.7),
        Shape::Quad([a, _, c, _]) => a.lerp(c, 0.5),
        Shape::Square(at) | Shape::Knob(at) => at,
    }
}

#[test]
fn a_muted_light_is_not_in_the_image_but_stays_in_the_preset() {
    let mut harness = lit(Light { intensity: 200.0, ..Light::default() });
    harness.state_mut().session.view.tab = Tab::Light;
    let part = viewport(&harness);
    let lit = brightness(&screenshot(&mut harness), part);
    let click = |harness: &mut Harness<'_, Window>, label| {
        harness.get_by_label(label).click();
        harness.run();
        // Tooltips would overlap the image.
        harness.remove_cursor();
        harness.run();
    };
    click(&mut harness, "Mute: hide this light: Point 1");
    let dark = brightness(&screenshot(&mut harness), part);
    assert!(dark < lit - 5.0, "{dark} {lit}");
    assert_eq!(undo_name(&harness).as_deref(), Some("Light removed"), "only the test's own change");
    click(&mut harness, "Solo: show only this light: Point 1");
    assert!((brightness(&screenshot(&mut harness), part) - lit).abs() < 0.5);
}

#[test]
fn lights_are_added_duplicated_and_deleted_by_panel_and_by_key() {
    let mut harness = lit(Light::default());
    harness.state_mut().session.view.tab = Tab::Light;
    harness.run();
    let count = |harness: &Harness<'_, Window>| harness.state().session.document.preset.lights.len();
    let selected = |harness: &Harness<'_, Window>| harness.state().session.view.lights.selected;
    harness.get_by_label("Add light").click();
    harness.run_steps(4);
    harness.get_by_label("Spot").click();
    harness.run();
    assert_eq!(
        (count(&harness), selected(&harness), undo_name(&harness).as_deref()),
        (2, Some(1), Some("Light added"))
    );
    harness.key_press_modifiers(Modifiers::COMMAND, Key::D);
    harness.run();
    assert_eq!((count(&harness), selected(&harness)), (3, Some(2)));
    harness.key_press(Key::Delete);
    harness.run();
    assert_eq!((count(&harness), selected(&harness), undo_name(&harness).as_deref()), (2, None, Some("Light removed")));
    harness.get_by_label("Spot 2").click();
    harness.run();
    harness.get_by_label("Move behind smoke").click();
    harness.run();
    let session = &harness.state().session;
    let mut behind = session.document.preset.lights[1];
    let bounds = session.measure(&mut SmokeGeometry::default()).bounds();
    let is_behind = projection(&harness).depth(behind.position) > projection(&harness).depth(bounds.center());
    assert!(is_behind && selected(&harness) == Some(1));
    // A direction that is set by angles keeps its azimuth at any elevation.
    behind.direction = Vec3::NEG_Z;
    harness.state_mut().session.document.preset.lights[1] = behind;
    harness.run();
    let elevation = |value: f64, harness: &mut Harness<'_, Window>| {
        let role = eframe::egui::Role::Slider;
        let is_slider = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == role;
        harness.get_all_by_label("Elevation").find(is_slider).unwrap().set_value_accesskit(value);
        harness.run();
    };
    elevation(90.0, &mut harness);
    assert!(harness.state().session.document.preset.lights[1].direction.y < -0.99);
    elevation(0.0, &mut harness);
    assert!(harness.state().session.document.preset.lights[1].direction.distance(Vec3::NEG_Z) < 0.01);
}

#[test]
fn a_right_click_adds_a_light_there_or_behind_the_smoke() {
    let mut harness = lit(Light::default());
    let at = viewport(&harness).center() + vec2(-160.0, -40.0);
    drag(&mut harness, PointerButton::Secondary, &[at]);
    harness.run_steps(3);
    harness.get_by_label("Add Spot Light Here").click();
    harness.run();
    let added = |harness: &Harness<'_, Window>| *harness.state().session.document.preset.lights.last().unwrap();
    let spot = added(&harness);
    assert!(spot.kind == LightKind::Spot && projection(&harness).project(spot.position).unwrap().distance(at) < 1.0);
    assert_eq!(undo_name(&harness).as_deref(), Some("Light added"));
    harness.state_mut().session.view.lights.selected = None;
    harness.key_press_modifiers(Modifiers::SHIFT, Key::B);
    harness.run();
    assert_eq!(harness.state().session.document.preset.lights.len(), 3);
    assert!(projection(&harness).depth(added(&harness).position) > projection(&harness).depth(spot.position));
}

#[test]
fn a_light_is_put_behind_the_clicked_smoke_or_the_smoke_in_the_image() {
    let mut harness = lit(Light::default());
    let session = &harness.state().session;
    let mut smoke = SmokeGeometry::default();
    let sprites = &session.measure(&mut smoke).systems[0];
    let in_view = |at: &Pos2| viewport(&harness).shrink(40.0).contains(*at);
    let seen =
        sprites.iter().filter(|sprite| projection(&harness).project(sprite.position).is_some_and(|at| in_view(&at)));
    let top = seen.max_by(|a, b| a.position.y.total_cmp(&b.position.y)).unwrap().position;
    let at = projection(&harness).project(top).unwrap();
    drag(&mut harness, PointerButton::Secondary, &[at]);
    harness.run_steps(3);
    harness.get_by_label("Move Light behind Smoke").click();
    harness.run();
    let is_behind = |harness: &Harness<'_, Window>| {
        let projection = projection(harness);
        let position = light(harness).position;
        assert!(projection.depth(position) > projection.depth(top), "{position}");
        projection.project(position).unwrap()
    };
    assert!(is_behind(&harness).distance(at) < 1.0, "not under the pointer");
    // So close that the center of all smoke is outside the image.
    let camera = &mut harness.state_mut().session.document.preset.camera;
    camera.position = top + Vec3::new(0.0, -0.1, 1.2);
    camera.target = top;
    harness.run();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::B);
    harness.run();
    assert!(viewport(&harness).contains(is_behind(&harness)));
}

#[test]
fn a_click_on_a_selected_light_keeps_it_selected() {
    let mut harness = lit(Light::default());
    harness.state_mut().session.view.tab = Tab::Light;
    harness.run();
    for _ in 0..2 {
        harness.get_by_label("Point 1").click();
        harness.run();
        assert_eq!(harness.state().session.view.lights.selected, Some(0));
        assert!(harness.query_all_by_label("Intensity").next().is_some());
    }
}

#[test]
fn one_click_changes_the_role_of_a_light_and_a_preset_has_one_key_light() {
    let mut harness = lit(Light::default());
    harness.state_mut().session.view.tab = Tab::Light;
    let lights = &mut harness.state_mut().session.document.preset.lights;
    lights.push(Light { role: LightRole::Key, ..Light::default() });
    harness.run();
    harness.get_by_label("Key").click();
    harness.run();
    let roles = |harness: &Harness<'_, Window>| {
        harness.state().session.document.preset.lights.iter().map(|light| light.role).collect::<Vec<_>>()
    };
    assert_eq!(roles(&harness), [LightRole::Key, LightRole::None]);
    assert!(harness.query_by_label("Key (Point 1)").is_some());
    harness.get_by_label("Fill").click();
    harness.run();
    assert_eq!(roles(&harness), [LightRole::Fill, LightRole::None]);
}

#[test]
fn overlays_are_drawn_while_they_are_on() {
    let mut harness = lit(Light::default());
    let part = viewport(&harness);
    let plain = screenshot(&mut harness);
    for name in ["Bounds", "Lit plane", "Particles", "Grid"] {
        let mut click = || {
            harness.get_by_label(name).click();
            harness.remove_cursor();
            harness.run();
            // Overlays use data of the previous image.
            screenshot(&mut harness);
            screenshot(&mut harness)
        };
        let on = click();
        let off = click();
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
fn the_scene_can_be_chosen_and_its_props_hidden() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    let environment = |harness: &Harness<'_, Window>| harness.state().session.document.preset.environment.clone();
    harness.get_by_label("Scene").click();
    harness.run_steps(3);
    harness.get_by_label("Lamp").click();
    harness.run_steps(3);
    assert!(!environment(&harness).lamp && environment(&harness).brazier);
    harness.get_by_label("Studio").click();
    harness.run_steps(3);
    assert_eq!(environment(&harness).scene.name(), "studio");
}
