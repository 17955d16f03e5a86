//! Look tab: the few controls that determine a look.

use eframe::egui::Ui;
use haze::preset::{Preset, PresetSystem};
use haze::{Light, LightKind};

use super::rows::setting_rows::{FIVE_VALUES, RowContext, show_named};
use super::rows::{self, Row, RowRequest, setting_rows, value_control};
use crate::tweak::document::light_defaults::light_name;
use crate::tweak::session::light_view::LightView;
use crate::tweak::session::look_controls::{ControlTarget, LOOK_CONTROLS};
use crate::tweak::session::macro_param::MacroParam;

/// Draws the look of one system of the preset.
pub fn panel(ui: &mut Ui, context: &mut RowContext<'_>, preset: &mut Preset, shown: &mut LightView, index: usize) {
    shown.follow(&preset.lights);
    let key = shown.key_light(index, || key_light(preset, index));
    let Preset { systems, lights, camera, .. } = preset;
    let Some(system) = systems.get_mut(index) else {
        ui.weak("The preset has no smoke.");
        return;
    };
    let path = [("systems", Some(index))];
    for control in LOOK_CONTROLS {
        let name = control.name;
        match control.target {
            ControlTarget::Macro(param) => macro_row(ui, context, system, index, param),
            ControlTarget::System(field, usual) => show_named(ui, context, &path, system, (name, field, usual)),
            ControlTarget::Camera(field, usual) => {
                show_named(ui, context, &[("camera", None)], camera, (name, field, usual));
            }
            ControlTarget::KeyLight(field, usual) => {
                let Some((key, light)) = key.and_then(|key| Some((key, lights.get_mut(key)?))) else { continue };
                show_named(ui, context, &[("lights", Some(key))], light, (name, field, usual));
                let marks = if context.second.is_some() { 2.0 } else { 1.0 };
                rows::note(ui, marks, &light_name(key, light)).on_hover_text(KEY);
            }
        }
    }
}

/// Tooltip: definition of the key light.
const KEY: &str = "The light that was brightest at the emitter when the preset was opened";

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
    let row = Row { name: param.name, tooltip: param.tooltip, is_changed, second, sheet, reason_without_effect };
    let refused = &mut context.refused;
    let before = ui.cursor().min;
    let request = row.show(ui, |ui, label| {
        let mut value = (param.get)(system);
        if value_control::number(ui, label, &mut value, (&param.range, Some(param.usual)), param.unit, refused) {
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

/// Returns the light that is brightest at the emitter.
fn key_light(preset: &Preset, system: usize) -> Option<usize> {
    let at = preset.systems.get(system)?.emitter.position;
    let brightness = |light: &Light| {
        let falloff =
            if light.kind == LightKind::Directional { 1.0 } else { light.position.distance_squared(at).max(0.1) };
        light.intensity * light.color.max_element() / falloff
    };
    let lights = preset.lights.iter().enumerate();
    lights.max_by(|a, b| brightness(a.1).total_cmp(&brightness(b.1))).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Modifiers, Role, Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};

    use crate::tweak::session::look_controls::LOOK_CONTROLS;
    use crate::tweak::session::view_options::Tab;
    use crate::tweak::window::Window;
    use crate::tweak::window::testing::window;

    fn set_key(harness: &mut Harness<'_, Window>, value: f64) {
        let sliders = harness.get_all_by_label("key light");
        let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider);
        slider.unwrap().set_value_accesskit(value);
        harness.run_steps(3);
    }

    fn intensities(harness: &Harness<'_, Window>) -> Vec<f32> {
        harness.state().session.document.preset.lights.iter().map(|light| light.intensity).collect()
    }

    #[test]
    fn the_key_light_stays_the_same_when_it_becomes_darker_than_another_and_is_named() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        let before = intensities(&harness);
        set_key(&mut harness, 50.0);
        let bright = intensities(&harness);
        let key = (0..before.len()).find(|&index| (bright[index] - before[index]).abs() > 1.0e-3).unwrap();
        let name = super::light_name(key, &harness.state().session.document.preset.lights[key]);
        assert!(harness.query_by_label(&name).is_some(), "{name}");
        for value in [0.0, 1.0] {
            set_key(&mut harness, value);
        }
        let mut expected = before;
        expected[key] = 1.0;
        assert_eq!(intensities(&harness), expected);
        // After it is removed, another light is the key light.
        harness.state_mut().session.document.preset.lights.remove(key);
        harness.run_steps(3);
        assert!(harness.query_by_label(&name).is_none(), "{name}");
        set_key(&mut harness, 7.0);
        assert!(intensities(&harness).contains(&7.0));
    }

    #[test]
    fn sliders_have_names_for_artists_and_are_found_by_either_name() {
        let mut harness = window("column", Vec2::new(1000.0, 900.0), Theme::Dark);
        let has = |harness: &Harness<'_, Window>, name| harness.query_all_by_label(name).next().is_some();
        for control in LOOK_CONTROLS {
            assert!(has(&harness, control.name), "{}", control.name);
        }
        assert!(!has(&harness, "radius start"));
        let find = |harness: &mut Harness<'_, Window>, text: &str| {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
            harness.run_steps(2);
            harness.get_by_label("find a setting").type_text(text);
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
        let sliders = harness.get_all_by_label("rise");
        let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider).unwrap().rect();
        harness.hover_at(slider.left_center() - Vec2::new(115.0, 0.0));
        harness.run_steps(8);
        assert!(harness.query_all_by_label_contains("systems[0].emitter.buoyancy").next().is_some());
    }
}
