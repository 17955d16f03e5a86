//! Look tab: the few controls that determine a look.

use eframe::egui::Ui;
use haze::{Light, LightRole};
use haze_preset::{Preset, PresetSystem};

use super::rows::setting_rows::{FIVE_VALUES, LabelledField, RowContext, show_named};
use super::rows::{self, Row, RowRequest, setting_rows, value_control};
use crate::document::display_names::display_name;
use crate::document::light_defaults::light_name;
use crate::session::light_view::LightView;
use crate::session::look_controls::{ControlTarget, LOOK_SECTIONS};
use crate::session::macro_param::MacroParam;

/// Draws the look of one system of the preset.
pub fn panel(ui: &mut Ui, context: &mut RowContext<'_>, preset: &mut Preset, shown: &mut LightView, index: usize) {
    shown.follow(&preset.lights);
    // While the slider is held, it does not pass on to another light.
    let is_held = ui.input(|input| input.pointer.any_down()) || ui.memory(|memory| memory.focused().is_some());
    let key = shown.held_key_light(preset, index, is_held);
    let Preset { systems, lights, camera, .. } = preset;
    let Some(system) = systems.get_mut(index) else {
        ui.weak("This preset has no smoke.");
        return;
    };
    let path = [("systems", Some(index))];
    let mut is_first = true;
    for section in LOOK_SECTIONS {
        if !section.is_shown(system, index, |path| context.changed.contains(path)) {
            continue;
        }
        if !std::mem::take(&mut is_first) {
            ui.add_space(4.0);
            ui.strong(display_name(section.name));
        }
        for control in section.controls {
            let title = control.name;
            match control.target {
                ControlTarget::Macro(param) => macro_row(ui, context, system, index, param),
                ControlTarget::System(field, usual) => {
                    show_named(ui, context, &path, system, LabelledField { title, path: field, usual });
                }
                ControlTarget::Camera(field, usual) => {
                    let field = LabelledField { title, path: field, usual };
                    show_named(ui, context, &[("camera", None)], camera, field);
                }
                ControlTarget::KeyLight(field, usual) => {
                    if let Some((key, light)) = key.and_then(|key| Some((key, lights.get_mut(key)?))) {
                        key_light_row(ui, context, key, light, LabelledField { title, path: field, usual });
                    }
                }
            }
        }
    }
}

/// Draws the row of the key light, which `light` at an index is, or else of the brightest one.
fn key_light_row(ui: &mut Ui, context: &mut RowContext<'_>, key: usize, light: &mut Light, field: LabelledField<'_>) {
    let is_key = light.role == LightRole::Key;
    let title = if is_key { field.title } else { BRIGHTEST };
    show_named(ui, context, &[("lights", Some(key))], light, LabelledField { title, ..field });
    rows::note(ui, if context.second.is_some() { 2.0 } else { 1.0 }, |ui| {
        ui.weak(light_name(key, light)).on_hover_text(if is_key { KEY } else { NO_KEY });
        if !is_key && ui.small_button("Make it the key light").on_hover_text(KEY).clicked() {
            light.role = LightRole::Key;
        }
    });
}

/// Name of the slider in a preset without a key light.
const BRIGHTEST: &str = "brightest light";

/// Tooltips of the name of the light.
const KEY: &str = "The key light is the main light of the preset. Change it on the Light tab.";
const NO_KEY: &str = "No light has the role Key, so this is the light that is brightest at the emitter now.";

/// Draws the row of a value that several settings make.
fn macro_row(ui: &mut Ui, context: &mut RowContext<'_>, system: &mut PresetSystem, index: usize, param: &MacroParam) {
    let paths: Vec<_> = param.of.iter().map(|path| format!("systems[{index}].{path}")).collect();
    let is_changed = paths.iter().any(|path| context.changed.contains(path));
    let apart = paths.iter().any(|path| context.second.is_some_and(|second| second.contains_key(path)));
    let second = context.second.map(|_| apart.then_some("another value"));
    let reason_without_effect =
        paths.iter().map(|path| (context.reason_without_effect)(path)).collect::<Option<Vec<_>>>();
    let reason_without_effect = reason_without_effect.and_then(|reasons| reasons.first().copied());
    let sheet = FIVE_VALUES.filter(|_| context.has_sheets);
    let row =
        Row { name: param.name, tooltip: param.tooltip, is_changed, second, sheet, key: None, reason_without_effect };
    let refused = &mut context.refused;
    let before = ui.cursor().min;
    let request = row.show(ui, |ui, label| {
        let mut value = (param.get)(system);
        if value_control::number(ui, label, &mut value, &param.range, Some(param.usual), param.unit, refused) {
            (param.set)(system, value);
        }
    });
    if context.searched_path == Some(param.path(index).as_str()) {
        setting_rows::scroll_to_and_mark(ui, before);
    }
    match request {
        Some(RowRequest::Sheet) => context.requests.push((RowRequest::Sheet, param.path(index))),
        Some(request) => context.requests.extend(paths.into_iter().map(|path| (request, path))),
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Role, Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use haze::LightRole;

    use crate::document::display_names::display_name;
    use crate::session::look_controls::LOOK_SECTIONS;
    use crate::session::view_options::Tab;
    use crate::window::Window;
    use crate::window::testing::window;

    fn set_key(harness: &mut Harness<'_, Window>, name: &str, value: f64) {
        let sliders = harness.get_all_by_label(name);
        let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider);
        slider.unwrap().set_value_accesskit(value);
        harness.run_steps(3);
    }

    fn intensities(harness: &Harness<'_, Window>) -> Vec<f32> {
        harness.state().session.document.preset.lights.iter().map(|light| light.intensity).collect()
    }

    #[test]
    fn the_key_light_is_the_one_that_the_preset_names_and_else_the_brightest_says_so() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        let before = intensities(&harness);
        // Darker than all others, it is still the key light.
        for value in [50.0, 0.0, 1.0] {
            set_key(&mut harness, "Key light", value);
        }
        let mut expected = before;
        expected[0] = 1.0;
        assert_eq!(intensities(&harness), expected);
        assert!(harness.query_by_label("Key (Point 1)").is_some());
        // Without a key light, the slider has another name and drives the light that is brightest now.
        let lights = &mut harness.state_mut().session.document.preset.lights;
        lights[0].role = LightRole::None;
        lights[0].intensity = 0.1;
        lights[2].intensity = 900.0;
        harness.run_steps(3);
        assert!(harness.query_all_by_label("Key light").next().is_none());
        assert!(harness.query_by_label("Practical (Point 3)").is_some());
        set_key(&mut harness, "Brightest light", 800.0);
        assert!((intensities(&harness)[2] - 800.0).abs() < 1e-3);
        harness.get_by_label("Make it the key light").click();
        harness.run_steps(3);
        assert!(harness.query_by_label("Key (Point 3)").is_some());
        set_key(&mut harness, "Key light", 0.0);
        assert!(intensities(&harness)[2].abs() < 1e-3);
    }

    #[test]
    fn sliders_have_names_for_artists_and_are_found_by_either_name() {
        let mut harness = window("column", Vec2::new(1000.0, 900.0), Theme::Dark);
        let has = |harness: &Harness<'_, Window>, name: &str| harness.query_all_by_label(name).next().is_some();
        let preset = harness.state().session.document.preset.clone();
        for section in LOOK_SECTIONS {
            let is_shown = section.is_shown(&preset.systems[0], 0, |_| false);
            for control in section.controls {
                assert_eq!(has(&harness, &display_name(control.name)), is_shown, "{}", control.name);
            }
        }
        assert!(!has(&harness, "Radius start"));
        let find = |harness: &mut Harness<'_, Window>, text: &str| {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
            harness.run_steps(2);
            harness.get_by_label("Find a setting").type_text(text);
            harness.run_steps(2);
            harness.key_press(Key::Enter);
            harness.run_steps(8);
        };
        for (text, tab) in [
            ("radius start", Tab::Smoke),
            ("size at birth", Tab::Look),
            ("buoyancy", Tab::Smoke),
            ("rise", Tab::Look),
            ("thickness", Tab::Look),
            ("specular scatter intensity", Tab::Smoke),
            ("key light", Tab::Look),
            ("glow", Tab::Look),
        ] {
            find(&mut harness, text);
            assert_eq!(harness.state().session.view.tab, tab, "{text}");
        }
        // Undo and files use the field's own name, and the tooltip shows it.
        let sliders = harness.get_all_by_label("Rise");
        let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider).unwrap().rect();
        harness.hover_at(slider.left_center() - Vec2::new(115.0, 0.0));
        harness.run_steps(8);
        assert!(harness.query_all_by_label_contains("systems[0].emitter.buoyancy").next().is_some());
    }

    #[test]
    fn a_look_has_the_sections_of_its_system_and_keeps_a_slider_that_reaches_0() {
        let mut harness = window("campfire", Vec2::new(1000.0, 900.0), Theme::Dark);
        let top = |harness: &Harness<'_, Window>, name: &str| {
            let mut found = harness.query_all_by_label(name);
            found.find(|node| node.accesskit_node().role() == Role::Slider).map(|node| node.rect().top())
        };
        let fire = top(&harness, "Flicker").unwrap();
        assert!(fire < top(&harness, "Rise").unwrap(), "a fire's own sliders come first");
        set_key(&mut harness, "Fire", 0.0);
        assert!(harness.state().session.document.preset.systems[0].settings.fire.intensity.abs() < 1e-6);
        assert!(top(&harness, "Fire").is_some());
        // A preset without fire lacks the section.
        let harness = window("steam_vent", Vec2::new(1000.0, 900.0), Theme::Dark);
        assert!(top(&harness, "Fire").is_none() && top(&harness, "Rise").is_some());
    }
}
