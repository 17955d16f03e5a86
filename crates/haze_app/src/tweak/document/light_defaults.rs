//! Names of lights, and the light that is added to a preset.

use haze::{Light, LightKind};

/// Returns the display name of a light, which contains its index plus one.
pub fn light_name(index: usize, light: &Light) -> String {
    let number = index + 1;
    match light.kind {
        LightKind::Directional => format!("sun {number}"),
        kind => format!("lamp {number} ({})", kind.name()),
    }
}

/// Returns a new light. It has the intensity of the first light of the same kind, if there is one.
pub fn new_light(kind: LightKind, lights: &[Light]) -> Light {
    let usual = if kind == LightKind::Directional { 1.0 } else { 10.0 };
    let alike = lights.iter().find(|light| light.kind == kind);
    Light { kind, intensity: alike.map_or(usual, |light| light.intensity), ..Light::default() }
}
