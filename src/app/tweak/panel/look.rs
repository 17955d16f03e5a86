//! The first panel: the few controls that make a look.

use eframe::egui::{self, Ui};
use glam::Vec3;
use haze::preset::{Preset, PresetSystem};
use haze::{Light, LightKind};

use super::fields::{self, Desk, Named};
use super::row::{self, Asked, Row};

/// Settings of the system that are shown as they are, under names that tell what they do, as far as they make sense: what comes before the rows of their
/// own, and after.
const BEFORE: [Named; 3] = [
    ("size at birth", "emitter.radius_start", Some((0.0, 1.5))),
    ("size at death", "emitter.radius_end", Some((0.0, 4.0))),
    ("rise", "emitter.buoyancy", Some((-1.0, 3.0))),
];
const AFTER: [Named; 2] = [
    ("turbulence", "emitter.turbulence", Some((0.0, 3.0))),
    ("swirl size", "emitter.turbulence_scale", Some((0.1, 6.0))),
];
const KEY_LIGHT: [Named; 1] = [("key light", "intensity", Some((0.0, 100.0)))];
const LIGHT: [Named; 2] = [
    ("scatter colour", "settings.soft_scatter.scatter_colour", None),
    ("glow", "settings.specular_scatter.intensity", Some((0.0, 4.0))),
];
const EXPOSURE: [Named; 1] = [("exposure", "exposure", Some((-4.0, 4.0)))];

/// Draws the look of one system of the preset.
pub fn panel(ui: &mut Ui, desk: &mut Desk<'_>, preset: &mut Preset, index: usize) {
    let key = key_light(preset, index);
    let Some(system) = preset.systems.get_mut(index) else {
        ui.weak("The preset has no smoke.");
        return;
    };
    thickness(ui, desk, system, index);
    fields::show_named(ui, desk, &[("systems", Some(index))], system, &BEFORE);
    wind(ui, desk, system, index);
    fields::show_named(ui, desk, &[("systems", Some(index))], system, &AFTER);
    softness(ui, desk, system, index);
    if let Some((key, light)) = key.and_then(|key| Some((key, preset.lights.get_mut(key)?))) {
        fields::show_named(ui, desk, &[("lights", Some(key))], light, &KEY_LIGHT);
    }
    if let Some(system) = preset.systems.get_mut(index) {
        fields::show_named(ui, desk, &[("systems", Some(index))], system, &LIGHT);
    }
    fields::show_named(ui, desk, &[("camera", None)], &mut preset.camera, &EXPOSURE);
}

/// A row for what several settings make together.
fn made_row(
    ui: &mut Ui,
    desk: &mut Desk<'_>,
    name: &str,
    tooltip: &str,
    paths: &[String],
    control: impl FnOnce(&mut Ui, &egui::Response, &mut Option<String>),
) {
    let is_changed = paths.iter().any(|path| desk.changed.contains(path));
    let apart = paths.iter().any(|path| desk.second.is_some_and(|second| second.contains_key(path)));
    let second = desk.second.map(|_| apart.then_some("another value"));
    let inert = paths.iter().map(|path| (desk.inert)(path)).collect::<Option<Vec<_>>>();
    let inert = inert.and_then(|reasons| reasons.first().copied());
    let row = Row { name, tooltip, is_changed, second, sheet: None, inert };
    let refused = &mut desk.refused;
    let asked: Option<Asked> = row.show(ui, |ui, label| control(ui, label, refused));
    desk.asked.extend(asked.into_iter().flat_map(|asked| paths.iter().map(move |path| (asked, path.clone()))));
}

fn thickness(ui: &mut Ui, desk: &mut Desk<'_>, system: &mut PresetSystem, index: usize) {
    let paths = ["emitter.amount", "settings.accumulate.opacity", "settings.boost"];
    let paths = paths.map(|path| format!("systems[{index}].{path}"));
    let tooltip = "How much one full-grown sprite covers: amount, opacity and boost together.";
    made_row(ui, desk, "thickness", tooltip, &paths, |ui, label, refused| {
        let mut value = thickness_of(system);
        if row::number(ui, label, &mut value, (&(0.001..=16.0), Some((0.001, 3.0))), "", refused) {
            set_thickness(system, value);
        }
    });
}

fn thickness_of(system: &PresetSystem) -> f32 {
    system.emitter.amount * system.settings.accumulate.opacity * system.settings.boost
}

/// Amount and boost take equal shares, as far as they go; opacity takes what they cannot.
fn set_thickness(system: &mut PresetSystem, thickness: f32) {
    // The field, its most, and its share of what is to be gained.
    let mut of = [
        (&mut system.emitter.amount, 1.0, 0.5),
        (&mut system.settings.boost, 16.0, 1.0),
        (&mut system.settings.accumulate.opacity, 1.0, 1.0),
    ];
    // What is nothing cannot be multiplied.
    of.iter_mut().for_each(|(value, ..)| **value = value.max(1.0e-3));
    for at in 0..of.len() {
        let product: f32 = of.iter().map(|(value, ..)| **value).product();
        let (value, most, share) = &mut of[at];
        **value = (**value * (thickness / product).powf(*share)).clamp(1.0e-3, *most);
    }
}

fn wind(ui: &mut Ui, desk: &mut Desk<'_>, system: &mut PresetSystem, index: usize) {
    let path = [format!("systems[{index}].emitter.wind")];
    let tooltip =
        "How fast the air moves. Its direction is a setting of the emitter; from stillness it blows to the right.";
    made_row(ui, desk, "wind", tooltip, &path, |ui, label, refused| {
        let wind = &mut system.emitter.wind;
        let mut speed = wind.length();
        if row::number(ui, label, &mut speed, (&(0.0..=20.0), Some((0.0, 4.0))), "m/s", refused) {
            *wind = wind.normalize_or(Vec3::X) * speed;
        }
    });
}

fn softness(ui: &mut Ui, desk: &mut Desk<'_>, system: &mut PresetSystem, index: usize) {
    let path = [format!("systems[{index}].settings.soft_fade.fade_scale")];
    let tooltip = "Distance over which smoke dissolves before a surface: 1 / fade_scale.";
    made_row(ui, desk, "softness", tooltip, &path, |ui, label, refused| {
        let mut reach = 1.0 / system.settings.soft_fade.fade_scale;
        if row::number(ui, label, &mut reach, (&(0.001..=10.0), Some((0.01, 2.0))), "m", refused) {
            system.settings.soft_fade.fade_scale = 1.0 / reach;
        }
    });
}

/// The light that is brightest where the smoke is born.
fn key_light(preset: &Preset, system: usize) -> Option<usize> {
    let at = preset.systems.get(system)?.emitter.position;
    let brightness = |light: &Light| {
        let falloff =
            if light.kind == LightKind::Directional { 1.0 } else { light.position.distance_squared(at).max(0.1) };
        light.intensity * light.colour.max_element() / falloff
    };
    let lights = preset.lights.iter().enumerate();
    lights.max_by(|a, b| brightness(a.1).total_cmp(&brightness(b.1))).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thickness_is_what_it_is_set_to_as_far_as_it_goes() {
        let mut system = PresetSystem::default();
        for wanted in [0.001, 0.05, 0.3, 1.0, 4.0, 15.0, 0.2] {
            set_thickness(&mut system, wanted);
            let found = thickness_of(&system);
            assert!((found / wanted - 1.0).abs() < 1e-3, "{wanted} {found} {system:?}");
            let settings = &system.settings;
            assert!(system.emitter.amount <= 1.0 && settings.boost <= 16.0 && settings.accumulate.opacity <= 1.0);
        }
    }

    #[test]
    fn a_little_more_moves_amount_and_boost_alike() {
        let mut system = PresetSystem::default();
        let before = system.clone();
        set_thickness(&mut system, 1.21 * thickness_of(&before));
        assert!((system.emitter.amount / before.emitter.amount - 1.1).abs() < 1e-3);
        assert!((system.settings.boost / before.settings.boost - 1.1).abs() < 1e-3);
        assert!((system.settings.accumulate.opacity / before.settings.accumulate.opacity - 1.0).abs() < 1e-3);
    }
}
