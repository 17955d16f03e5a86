//! Reasons why settings have no effect in their context.

mod condition;
mod rule;
mod system_rules;

use glam::UVec2;

use haze_core::frame::{Light, LightKind};
use haze_core::settings::{field_values, is_field_named};
use haze_preset::{Environment, Preset, PresetSystem, SceneName};
use rule::{NoEffectRule, find_reason, rule};
use system_rules::SYSTEM_RULES;

const LIGHT_RULES: &[NoEffectRule<Light>] = &[
    rule(
        "the light's intensity is 0",
        |light, _| light.intensity <= 0.0,
        &[
            "kind",
            "position",
            "direction",
            "color",
            "range",
            "radius",
            "inner_angle",
            "outer_angle",
            "specular_scatter",
        ],
    ),
    rule(
        "a directional light shines from infinitely far",
        |light, _| light.kind == LightKind::Directional,
        &["position", "range"],
    ),
    rule("a point light shines in all directions", |light, _| light.kind == LightKind::Point, &["direction"]),
    rule("only with kind spot", |light, _| light.kind != LightKind::Spot, &["inner_angle", "outer_angle"]),
];

const NO_SHADOW: &str = "only where a system has a shadow.strength above 0";

const ENVIRONMENT_RULES: &[NoEffectRule<Environment>] = &[
    rule(
        "the scene is that of scene_file",
        |environment, _| !environment.scene_file.is_empty(),
        &["scene", "lamp", "brazier"],
    ),
    rule("only with a scene_file", |environment, _| environment.scene_file.is_empty(), &["scene_scale"]),
    rule("only in the yard", |environment, _| environment.scene != SceneName::Yard, &["lamp", "brazier"]),
    rule("the light is that of sky_file", is_lit_by_sky, &["zenith", "horizon", "ground"]),
    rule(
        "only with a sky_file",
        |environment, _| environment.sky_file.is_empty(),
        &["sky_rotation", "sky_exposure", "sky_light"],
    ),
];

fn is_lit_by_sky(environment: &Environment, _: UVec2) -> bool {
    environment.sky_light && !environment.sky_file.is_empty()
}

/// Returns the reason why a field has no effect with the other values as they are; `None` if it has an effect. `path` is
/// formatted as by [`field_path`](haze_core::settings::field_path); `size` is the image's, in pixels.
pub fn no_effect_reason(preset: &Preset, path: &str, size: UVec2) -> Option<&'static str> {
    let item = |list: &str| {
        let (index, field) = path.strip_prefix(list)?.strip_prefix('[')?.split_once("].")?;
        Some((index.parse::<usize>().ok()?, field))
    };
    if let Some((index, field)) = item("systems") {
        // The shadow that a system casts may fall on another.
        if field == "settings.shadow.density" && preset.systems.iter().any(|system| system.settings.receives_shadow()) {
            return None;
        }
        if field == "settings.sort_priority" && preset.systems.len() < 2 {
            return Some("there is one system");
        }
        let is_color = ["settings.ambient.sky_color", "settings.ambient.ground_color"].contains(&field);
        if is_color && is_lit_by_sky(&preset.environment, size) {
            return Some("the light is that of environment.sky_file");
        }
        return find_reason(SYSTEM_RULES, preset.systems.get(index)?, field, size);
    }
    if let Some((index, field)) = item("lights") {
        if field == "smoke_shadow" && !preset.systems.iter().any(|system| system.settings.receives_shadow()) {
            return Some(NO_SHADOW);
        }
        return find_reason(LIGHT_RULES, preset.lights.get(index)?, field, size);
    }
    if path == "camera.heat_haze" {
        let casts_light = |system: &PresetSystem| system.settings.burns() && system.settings.fire.light > 0.0;
        return (!preset.systems.iter().any(casts_light)).then_some("only above fires that cast light");
    }
    find_reason(ENVIRONMENT_RULES, &preset.environment, path.strip_prefix("environment.")?, size)
}

/// Returns the reason why none of the fields that [`set_field`](haze_core::settings::set_field) has set has an effect; `None` if
/// one has. `path`: as it was given; `name`: as it was returned.
pub fn no_effect_reason_of_set(preset: &Preset, path: &str, name: &str, size: UVec2) -> Option<&'static str> {
    let fields = field_values(preset).into_iter().map(|(field, _)| field);
    let fields = fields.filter(|field| is_field_named(field, path, name));
    let reasons: Option<Vec<_>> = fields.map(|field| no_effect_reason(preset, &field, size)).collect();
    reasons?.first().copied()
}

/// Conditions under which a field has an effect, for a dotted path without list indices.
pub(super) fn effect_conditions(path: &str) -> impl Iterator<Item = &'static str> {
    fn of<T>(rules: &'static [NoEffectRule<T>], field: Option<&str>) -> Vec<&'static str> {
        let Some(field) = field else { return Vec::new() };
        rules.iter().filter(|rule| rule.applies_to(field)).map(|rule| rule.reason).collect()
    }
    let all = [
        of(SYSTEM_RULES, path.strip_prefix("systems.")),
        of(LIGHT_RULES, path.strip_prefix("lights.")),
        of(ENVIRONMENT_RULES, path.strip_prefix("environment.")),
    ];
    let is_condition =
        |reason: &&str| reason.starts_with("only ") || reason.starts_with("not ") || reason.contains(" only");
    all.into_iter().flatten().filter(is_condition)
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_core::settings::ScaleMode;

    #[test]
    fn every_row_names_existing_fields() {
        let preset =
            Preset { lights: vec![Light::default()], systems: vec![PresetSystem::default()], ..Preset::default() };
        let paths: Vec<_> = field_values(&preset).into_iter().map(|(path, _)| path).collect();
        let systems = SYSTEM_RULES.iter().flat_map(|rule| rule.fields).map(|field| format!("systems[0].{field}"));
        let lights = LIGHT_RULES.iter().flat_map(|rule| rule.fields).map(|field| format!("lights[0].{field}"));
        let environments =
            ENVIRONMENT_RULES.iter().flat_map(|rule| rule.fields).map(|field| format!("environment.{field}"));
        for field in systems.chain(lights).chain(environments) {
            let group = format!("{field}.");
            assert!(paths.iter().any(|path| *path == field || path.starts_with(&group)), "{field}");
        }
    }

    #[test]
    fn reasons_are_unique_and_apply_to_their_fields_only() {
        let preset = Preset { systems: vec![PresetSystem::default()], ..Preset::default() };
        let reason = |path: &str| no_effect_reason(&preset, path, UVec2::new(640, 360));
        assert_eq!(reason("systems[0].settings.exponential.density"), Some("only with technique density"));
        assert_eq!(reason("systems[0].settings.boost"), None);
        assert_eq!(reason("systems[1].settings.exponential.density"), None);
        assert_eq!(reason("camera.fov"), None);
        assert_eq!(reason("camera.heat_haze"), Some("only above fires that cast light"));
        let mut reasons: Vec<_> = SYSTEM_RULES.iter().map(|rule| rule.reason).collect();
        reasons.sort_unstable();
        assert!(reasons.windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn a_set_has_no_effect_if_none_of_its_fields_has_one() {
        let mut preset = Preset { systems: vec![PresetSystem::default(); 2], ..Preset::default() };
        preset.systems[1].settings.accumulate.scale_mode = ScaleMode::Auto;
        let reason = |preset: &mut Preset, path: &str| {
            let name = preset.set_field(path, "3").unwrap();
            no_effect_reason_of_set(preset, path, &name, UVec2::new(640, 360))
        };
        assert_eq!(reason(&mut preset, "accumulate.downscale"), None);
        assert_eq!(reason(&mut preset, "systems[0].settings.accumulate.downscale"), None);
        let only_fixed = Some("only with scale_mode fixed");
        assert_eq!(reason(&mut preset, "systems[1].settings.accumulate.downscale"), only_fixed);
        preset.systems[0].settings.accumulate.scale_mode = ScaleMode::Auto;
        assert_eq!(reason(&mut preset, "accumulate.downscale"), only_fixed);
    }
}
