//! List of lights, and the settings of the selected light.

use eframe::egui::{self, Ui};
use glam::UVec2;
use haze::{Bounds, Light, LightKind, LightRole};
use haze_core::formula::color::luminance;
use haze_core::frame::MAX_LIGHTS;
use haze_preset::{Camera, Preset};

use super::comparison_bar::width;
use super::rows::color_popup::swatch;
use super::rows::setting_rows::RowContext;
use super::rows::{self, Row, setting_rows, value_control};
use crate::document::display_names::display_name;
use crate::document::light_defaults::{kind_name, light_name, new_light};
use crate::document::light_roles::{keep_one_key, light_of};
use crate::session::light_view::LightView;
use crate::session::smoke_geometry::{SmokeGeometry, place_behind};
use haze_author::daylight::{irradiance, set_brightness};
use haze_author::light_angles::{Angles, MAX_ELEVATION, from_angles, to_angles};

/// Draws the list and the settings of the selected light. `smoke`: as it is shown. `image_size`: pixels.
pub fn panel(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    preset: &mut Preset,
    shown: &mut LightView,
    smoke: &SmokeGeometry,
    image_size: UVec2,
) {
    shown.follow(&preset.lights);
    // If a setting of a light was searched for, that light is selected.
    let sought = context.searched_path.and_then(light_of);
    shown.selected = sought.or(shown.selected).filter(|&index| index < preset.lights.len());
    for (index, light) in preset.lights.iter_mut().enumerate() {
        ui.horizontal(|ui| entry(ui, index, light, shown));
    }
    ui.horizontal_wrapped(|ui| tools(ui, preset, shown, smoke, image_size));
    let position = smoke.bounds().center();
    let all: f32 = preset.lights.iter().map(|light| luminance(irradiance(light, position))).sum();
    let selected = shown.selected.and_then(|index| Some((index, preset.lights.get_mut(index)?)));
    let Some((index, light)) = selected else {
        ui.weak(if preset.lights.is_empty() { "This preset has no lights." } else { "Select a light to edit it." });
        return;
    };
    ui.separator();
    let before = light.role;
    role(ui, context, index, light);
    at_smoke(ui, context, index, light, position, all);
    if light.kind != LightKind::Point {
        angles(ui, context, index, light);
    }
    setting_rows::show_where(ui, context, &[("lights", Some(index))], light, &|name| name != "role");
    if light.role != before {
        keep_one_key(&mut preset.lights, index);
    }
}

/// Gap between the buttons of roles, points.
const GAP: f32 = 2.0;

/// Draws the roles of a light side by side, so that one click changes the role.
fn role(ui: &mut Ui, context: &mut RowContext<'_>, index: usize, light: &mut Light) {
    let path = format!("lights[{index}].role");
    let second = context.second(&path, "");
    let row = Row {
        name: "role",
        tooltip: context.tooltips.field("lights.role").unwrap_or_default(),
        is_changed: context.changed.contains(&path),
        second: second.as_ref().map(Option::as_deref),
        sheet: None,
        key: None,
        reason_without_effect: None,
    };
    let begin = ui.cursor().min;
    let tooltips = context.tooltips;
    let request = row.show(ui, |ui, label| {
        let usual = ui.spacing().clone();
        ui.spacing_mut().item_spacing.x = GAP;
        ui.spacing_mut().button_padding.x = 4.0;
        // In a narrow panel, the roles are in a list.
        let button = |role: &LightRole| width(ui, &display_name(role.name())) + GAP;
        if LightRole::ALL.iter().map(button).sum::<f32>() > ui.available_width() {
            *ui.spacing_mut() = usual;
            let tooltip = |choice: &str| tooltips.choice("lights.role", choice);
            value_control::choice(ui, &mut light.role, &path, tooltip).labelled_by(label.id);
            return;
        }
        for &role in LightRole::ALL {
            let tooltip = tooltips.choice("lights.role", role.name()).unwrap_or_default();
            ui.selectable_value(&mut light.role, role, display_name(role.name())).on_hover_text(tooltip);
        }
    });
    if context.searched_path == Some(path.as_str()) {
        setting_rows::scroll_to_and_mark(ui, begin);
    }
    context.requests.extend(request.map(|request| (request, path)));
}

const AT_SMOKE: &str = "Light that arrives at the center of the smoke, in one unit for all lights: the intensity of a white sun \
     that is as bright there. Shadows and other smoke are left out. Times π it is lux, if intensities are candela and lux \
     divided by π. A change sets the intensity.";

/// Draws the brightness of a light at the smoke, which sets its intensity. `position`: center of the smoke. `all`: brightness
/// of all lights there.
fn at_smoke(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    index: usize,
    light: &mut Light,
    position: glam::Vec3,
    all: f32,
) {
    let mut brightness = luminance(irradiance(light, position));
    let path = format!("lights[{index}].intensity");
    let row = Row {
        name: "at the smoke",
        tooltip: AT_SMOKE,
        is_changed: context.changed.contains(&path),
        second: context.second.map(|_| None),
        sheet: None,
        key: None,
        reason_without_effect: (light.intensity > 0.0 && brightness <= 0.0).then_some("the smoke is out of reach"),
    };
    let fraction = brightness / all;
    let refused = &mut context.refused;
    let request = row.show(ui, |ui, label| {
        if value_control::number(ui, label, &mut brightness, &(0.0..=1.0e9), Some((0.0, 10.0)), "", refused) {
            set_brightness(light, position, brightness);
        }
    });
    context.requests.extend(request.map(|request| (request, path)));
    if fraction.is_finite() && row.reason_without_effect.is_none() {
        rows::note(ui, if context.second.is_some() { 2.0 } else { 1.0 }, |ui| {
            let text = egui::RichText::new(format!("{:.0} % of all lights there", 100.0 * fraction)).weak();
            // A longer line would widen a narrow panel.
            ui.add(egui::Label::new(text).truncate()).on_hover_text(AT_SMOKE);
        });
    }
}

/// Draws a light of the list.
fn entry(ui: &mut Ui, index: usize, light: &mut Light, shown: &mut LightView) {
    let name = light_name(index, light);
    let is_selected = shown.selected == Some(index);
    let button = egui::Button::selectable(is_selected, &name);
    let height = ui.spacing().interact_size.y;
    // The width that the rest of the row leaves.
    let width = (ui.available_width() - 200.0).clamp(40.0, 130.0);
    let button = ui.add_sized([width, height], button.truncate()).on_hover_text(&name);
    if button.clicked() {
        shown.selected = Some(index);
    }
    // Brighter by the intensity beside it.
    let range = 0.0..=light.color.max_element().max(1.0);
    swatch(ui, &mut light.color, &range).accessible_name(format!("Color of {name}"));
    let speed = 0.01 * light.intensity.max(0.1);
    let intensity = egui::DragValue::new(&mut light.intensity).speed(speed).range(0.0..=1.0e9).max_decimals(3);
    let intensity = ui.add_sized([70.0, height], intensity.update_while_editing(false));
    intensity.on_hover_text("Intensity").accessible_name(format!("Intensity of {name}"));
    if let Some(mute_solo) = shown.mute_solo(index) {
        let mut toggle = |sign: &str, is_on: &mut bool, what: &str| {
            let button = ui.add(egui::Button::selectable(*is_on, sign).min_size(egui::vec2(22.0, height)));
            let button = button.on_hover_text(format!("{what}. The preset does not change."));
            if button.accessible_name(format!("{what}: {name}")).clicked() {
                *is_on = !*is_on;
            }
        };
        toggle("S", &mut mute_solo.is_solo, "Solo: show only this light");
        toggle("M", &mut mute_solo.is_muted, "Mute: hide this light");
    }
}

/// Draws the buttons for the list and the selected light.
fn tools(ui: &mut Ui, preset: &mut Preset, shown: &mut LightView, smoke: &SmokeGeometry, image_size: UVec2) {
    ui.add_enabled_ui(preset.lights.len() < MAX_LIGHTS, |ui| {
        ui.menu_button("Add light", |ui| {
            for &kind in LightKind::ALL {
                if ui.button(kind_name(kind)).clicked() {
                    let light = beside(new_light(kind, &preset.lights), &preset.camera, &smoke.bounds());
                    let end = preset.lights.len();
                    shown.insert(preset, end, light);
                }
            }
        });
        if let Some(index) = shown.selected
            && ui.button("Duplicate").clicked()
        {
            shown.duplicate(preset, index);
        }
    });
    let Some(index) = shown.selected else { return };
    if ui.button("Delete").clicked() {
        shown.remove(preset, index);
    }
    let behind = ui.button("Move behind smoke").on_hover_text("Moves the light behind the smoke, seen from the camera");
    if behind.clicked() {
        let eye = preset.camera.position;
        let point = smoke.visible_center(&preset.camera, image_size);
        if let Some(light) = preset.lights.get_mut(index) {
            place_behind(light, eye, point, &smoke.bounds);
        }
    }
}

/// Returns the light placed above the smoke, to the side of the camera.
fn beside(mut light: Light, camera: &Camera, bounds: &Bounds) -> Light {
    let reach = 0.5 * (bounds.max - bounds.min);
    let right = (camera.target - camera.position).cross(glam::Vec3::Y).normalize_or(glam::Vec3::X);
    light.position = bounds.center() + right * (reach.length() + 0.5);
    light.direction = bounds.center() - light.position - glam::Vec3::Y;
    light
}

/// Draws the direction of a light as angles.
fn angles(ui: &mut Ui, context: &mut RowContext<'_>, index: usize, light: &mut Light) {
    let before = to_angles(light.direction);
    let mut edited = before;
    let path = format!("lights[{index}].direction");
    let mut angle = |name: &str, value: &mut f32, most: f32, tooltip: &str| {
        let second = context.second(&path, "");
        let second = second.as_ref().map(Option::as_deref);
        let row = Row {
            name,
            tooltip,
            is_changed: context.changed.contains(&path),
            second,
            sheet: None,
            key: context.keys.map(|keys| keys.of(&path)),
            reason_without_effect: None,
        };
        let refused = &mut context.refused;
        let request = row.show(ui, |ui, label| {
            ui.spacing_mut().item_spacing.x = GAP;
            ui.spacing_mut().button_padding.x = 4.0;
            value_control::number(ui, label, value, &(-most..=most), None, "degrees", refused);
        });
        context.requests.extend(request.map(|request| (request, path.clone())));
    };
    angle(
        "azimuth",
        &mut edited.azimuth,
        180.0,
        "Horizontal direction that the light comes from: 0° is +z, 90° is +x.",
    );
    angle(
        "elevation",
        &mut edited.elevation,
        90.0,
        "Height of the light above the horizon: 0° is level, 90° straight above.",
    );
    if edited != before {
        let elevation = edited.elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION);
        light.direction = from_angles(Angles { elevation, ..edited });
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Role, Theme, Vec2};
    use egui_kittest::kittest::{NodeT as _, Queryable as _};

    use super::*;
    use crate::window::testing::window;

    #[test]
    fn lights_of_all_kinds_are_compared_and_set_in_one_unit() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Light").click();
        harness.run_steps(3);
        let mut fractions = 0.0;
        for (light, name) in ["Key (Point 1)", "Fill (Sun 2)", "Practical (Point 3)"].into_iter().enumerate() {
            harness.get_by_label(name).click();
            harness.run_steps(3);
            let fraction = harness.get_by_label_contains("% of all lights there").accesskit_node().value().unwrap();
            fractions += fraction.split(' ').next().unwrap().parse::<f32>().unwrap();
            let sliders = harness.get_all_by_label("At the smoke");
            let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider).unwrap();
            slider.set_value_accesskit(2.0);
            harness.run_steps(3);
            let session = &harness.state().session;
            let position = session.smoke.bounds().center();
            let brightness = luminance(irradiance(&session.document.preset.lights[light], position));
            assert!((brightness - 2.0).abs() < 0.01, "{name}: {brightness}");
            harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
            harness.run_steps(3);
        }
        assert!((fractions - 100.0).abs() < 2.0, "{fractions}");
        assert!(!harness.state().session.document.is_dirty());
    }

    #[test]
    fn a_code_typed_into_a_color_popup_scrolls_no_tab() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Light").click();
        harness.run_steps(3);
        harness.get_by_label("Key (Point 1)").click();
        harness.run_steps(3);
        let rect = harness.get_by_label("Add light").rect();
        let wells: Vec<_> = harness.get_all_by_role(Role::ColorWell).collect();
        // The color of the selected light, in the middle of the window.
        wells[3].click();
        harness.run_steps(8);
        harness.get_by_role_and_label(Role::TextInput, "Hex").click();
        harness.run_steps(3);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.event(egui::Event::Text("#00ff00".into()));
        harness.run_steps(20);
        assert_eq!(harness.get_by_label("Add light").rect(), rect);
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        assert_eq!(harness.state().session.document.preset.lights[0].color, glam::Vec3::Y);
    }

    #[test]
    fn a_selected_light_does_not_widen_the_narrowest_panel() {
        let mut harness = window("column", Vec2::new(640.0, 400.0), Theme::Dark);
        // Numbers with many digits.
        harness.state_mut().session.document.preset.lights[1].direction = glam::Vec3::new(-0.998, -0.152, -0.134);
        harness.get_by_label("Light").click();
        harness.run_steps(3);
        for light in 0..3 {
            harness.state_mut().session.view.lights.selected = Some(light);
            harness.run_steps(5);
            let tab = harness.get_by_label("Look").rect();
            let image = harness.get_by_label("viewport").rect();
            assert!(tab.left() >= image.right(), "{light}: {tab} {image}");
        }
    }
}
