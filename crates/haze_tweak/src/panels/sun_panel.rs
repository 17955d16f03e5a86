//! Sun and sky as one control: time of day, elevation and azimuth set the lights, the sky and the ambient light together.

use eframe::egui::Ui;
use glam::Vec3;
use haze::{Light, LightKind, LightRole};
use haze_author::daylight::{Body, SUN_ELEVATION, TIMES_OF_DAY, body_of, set_time, sun_of};
use haze_author::light_angles::{Angles, MAX_ELEVATION, to_angles};
use haze_core::frame::MAX_LIGHTS;
use haze_core::settings::Backlight;
use haze_preset::Preset;

use super::rows::setting_rows::RowContext;
use super::rows::{Row, value_control};
use crate::document::display_names::sentence_case;
use crate::document::light_roles::keep_one_key;
use crate::session::light_view::LightView;

/// Elevation of a new sun, degrees.
const NEW_SUN: f32 = 18.0;

const TOOLTIP: &str = "Moves the sun, and gives sun, sky, ambient light and fill lights the colors and the brightness of that \
     time. All are ordinary settings: change any of them afterwards.";

/// Draws the control, or the button that adds a sun. `position`: center of the smoke.
pub fn panel(ui: &mut Ui, context: &mut RowContext<'_>, preset: &mut Preset, shown: &mut LightView, position: Vec3) {
    let Some(index) = sun_of(&preset.lights) else {
        ui.horizontal_wrapped(|ui| {
            let can_add = preset.lights.len() < MAX_LIGHTS;
            let button = ui.add_enabled(can_add, eframe::egui::Button::new("Add a sun"));
            let about = "Adds a sun as the key light, with a sky to match, and turns on the backlight ramps. Other lights stay.";
            if button.on_hover_text(about).clicked() {
                add(preset, shown, position);
            }
            ui.weak("This preset has no sun.");
        });
        return;
    };
    let Some(sun) = preset.lights.get(index) else { return };
    let body = body_of(sun);
    let before = to_angles(sun.direction);
    let mut wanted = (body, before);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for time in TIMES_OF_DAY {
            let is_now = time.body == body && (time.elevation - before.elevation).abs() < 0.05;
            if ui.selectable_label(is_now, sentence_case(time.name)).on_hover_text(TOOLTIP).clicked() {
                wanted = (time.body, Angles { elevation: time.elevation, ..before });
            }
        }
    });
    let (whose, elevations) = match body {
        Body::Sun => ("sun", SUN_ELEVATION),
        Body::Moon => ("moon", 1.0..=90.0),
    };
    let path = format!("lights[{index}].direction");
    let mut angle = |what: &str, value: &mut f32, range| {
        let name = format!("{whose} {what}");
        let row = Row {
            name: &name,
            tooltip: TOOLTIP,
            is_changed: context.changed.contains(&path),
            second: context.second.map(|_| None),
            sheet: None,
            key: None,
            reason_without_effect: None,
        };
        let refused = &mut context.refused;
        let request = row.show(ui, |ui, label| {
            value_control::number(ui, label, value, &range, None, "degrees", refused);
        });
        context.requests.extend(request.map(|request| (request, path.clone())));
    };
    angle("elevation", &mut wanted.1.elevation, elevations);
    angle("azimuth", &mut wanted.1.azimuth, -180.0..=180.0);
    if wanted != (body, before) {
        let (body, angles) = wanted;
        let elevation = angles.elevation.min(MAX_ELEVATION);
        set_time(preset, index, body, Angles { elevation, ..angles }, position);
    }
}

/// Adds a sun to the right of the camera, and selects it.
fn add(preset: &mut Preset, shown: &mut LightView, position: Vec3) {
    let end = preset.lights.len();
    let forward = preset.camera.target - preset.camera.position;
    let direction = forward.with_y(0.0).cross(Vec3::NEG_Y).normalize_or(Vec3::NEG_X);
    let sun = Light {
        kind: LightKind::Directional,
        role: LightRole::Key,
        direction,
        // The model's brightness is taken.
        intensity: 0.0,
        specular_scatter: 0.0,
        ..Light::default()
    };
    shown.insert(preset, end, sun);
    for system in &mut preset.systems {
        // Smoke in front of the sun shows the light that comes through it.
        system.settings.diffuse.backlight = Backlight::Ramp;
    }
    keep_one_key(&mut preset.lights, end);
    let angles = Angles { elevation: NEW_SUN, ..to_angles(direction) };
    set_time(preset, end, Body::Sun, angles, position);
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Role, Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use haze::LightRole;
    use haze_author::daylight::Daylight;
    use haze_preset::Preset;

    use super::*;
    use crate::window::Window;
    use crate::window::testing::window;

    fn preset(harness: &Harness<'_, Window>) -> Preset {
        harness.state().session.document.preset.clone()
    }

    fn light_tab(preset: &str) -> Harness<'static, Window> {
        let mut harness = window(preset, Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Light").click();
        harness.run_steps(3);
        harness
    }

    fn click(harness: &mut Harness<'_, Window>, name: &str) {
        harness.get_by_label(name).click();
        harness.run_steps(3);
    }

    #[test]
    fn a_time_of_day_is_one_step_and_everything_stays_an_ordinary_setting() {
        let mut harness = light_tab("steam_vent");
        let before = preset(&harness);
        click(&mut harness, "Sunset");
        let sunset = preset(&harness);
        let sun = sunset.lights[0];
        let environment = &sunset.environment;
        assert!((to_angles(sun.direction).elevation - 3.0).abs() < 0.01 && sun.color.y < 0.5, "{sun:?}");
        assert!((to_angles(sun.direction).azimuth - to_angles(before.lights[0].direction).azimuth).abs() < 0.1);
        assert!(environment.horizon.x > environment.horizon.z, "{environment:?}");
        assert_ne!(sunset.systems[0].settings.ambient.sky_color, before.systems[0].settings.ambient.sky_color);
        // A change made afterwards stays until the sun moves again.
        harness.state_mut().session.document.preset.environment.horizon = Vec3::Y;
        harness.run_steps(3);
        assert_eq!(preset(&harness).environment.horizon, Vec3::Y);
        for _ in 0..2 {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
            harness.run_steps(3);
        }
        assert_eq!(preset(&harness), before);
        click(&mut harness, "Moonlit");
        assert_eq!(body_of(&preset(&harness).lights[0]), Body::Moon);
        assert!(harness.query_all_by_label("Moon elevation").next().is_some());
    }

    #[test]
    fn a_drag_of_the_elevation_is_one_step() {
        let mut harness = light_tab("steam_vent");
        let before = preset(&harness);
        let slider =
            harness.get_all_by_label("Sun elevation").find(|node| node.accesskit_node().role() == Role::Slider);
        let rect = slider.unwrap().rect();
        harness.hover_at(rect.center());
        harness.drag_at(rect.center());
        for fraction in [0.3, 0.2, 0.15] {
            harness.hover_at(rect.left_center() + Vec2::new(fraction * rect.width(), 0.0));
            harness.run_steps(2);
        }
        harness.drop_at(rect.left_center() + Vec2::new(0.15 * rect.width(), 0.0));
        harness.run_steps(3);
        let low = to_angles(preset(&harness).lights[0].direction).elevation;
        assert!((0.0..10.0).contains(&low), "{low}");
        assert_ne!(preset(&harness).environment, before.environment);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(preset(&harness), before);
    }

    #[test]
    fn a_preset_without_a_sun_is_offered_one() {
        let mut harness = light_tab("column");
        assert!(harness.query_by_label("Sunset").is_none());
        click(&mut harness, "Add a sun");
        let lights = preset(&harness).lights;
        assert_eq!((lights.len(), sun_of(&lights)), (4, Some(3)));
        assert_eq!(lights[0].role, LightRole::None);
        let systems = preset(&harness).systems;
        assert!(systems.iter().all(|system| system.settings.diffuse.backlight == Backlight::Ramp));
        assert_eq!(lights[3].color, Daylight::new(Body::Sun, NEW_SUN).color);
        click(&mut harness, "Dusk");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(preset(&harness).lights, lights);
    }

    #[test]
    fn the_control_needs_no_more_width_than_the_narrowest_panel_has() {
        let mut harness = window("steam_vent", Vec2::new(640.0, 400.0), Theme::Dark);
        harness.get_by_label("Light").click();
        harness.run_steps(3);
        for time in TIMES_OF_DAY {
            let rect = harness.get_by_label(&sentence_case(time.name)).rect();
            assert!(rect.right() <= 640.0, "{}: {rect}", time.name);
        }
    }
}
