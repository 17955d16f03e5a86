//! Names of lights, and the light that is added to a preset.

use haze::{Light, LightKind, LightRole};

use super::display_names::display_name;

/// Returns the display name of a kind of light, for a name or inside a sentence.
pub fn kind_name(kind: LightKind) -> &'static str {
    match kind {
        LightKind::Directional => "Sun",
        LightKind::Spot => "Spot",
        _ => "Point",
    }
}

/// Returns the display name of a light, with its role and its index plus one: "Key (Point 1)".
pub fn light_name(index: usize, light: &Light) -> String {
    let name = format!("{} {}", kind_name(light.kind), index + 1);
    match light.role {
        LightRole::None => name,
        role => format!("{} ({name})", display_name(role.name())),
    }
}

/// Returns a new light. It has the intensity of the first light of the same kind, if there is one.
pub fn new_light(kind: LightKind, lights: &[Light]) -> Light {
    let usual = if kind == LightKind::Directional { 1.0 } else { 10.0 };
    let alike = lights.iter().find(|light| light.kind == kind);
    Light { kind, intensity: alike.map_or(usual, |light| light.intensity), ..Light::default() }
}
