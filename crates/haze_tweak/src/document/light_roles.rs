//! Roles of lights: the key light, and the rule that a preset has at most one.

use glam::Vec3;
use haze::{Light, LightKind, LightRole};

/// Returns the light whose role is key.
pub fn key_light(lights: &[Light]) -> Option<usize> {
    lights.iter().position(is_key)
}

/// Takes the role of key from all lights other than `index`, if that light has it.
pub fn keep_one_key(lights: &mut [Light], index: usize) {
    if lights.get(index).is_some_and(is_key) {
        let others = lights.iter_mut().enumerate().filter(|(other, light)| *other != index && is_key(light));
        others.for_each(|(_, light)| light.role = LightRole::None);
    }
}

/// Returns the index of the light that a path leads to: 1 for `lights[1].role`.
pub fn light_of(path: &str) -> Option<usize> {
    path.strip_prefix("lights[")?.split_once(']')?.0.parse().ok()
}

fn is_key(light: &Light) -> bool {
    light.role == LightRole::Key
}

/// Returns the brightness of a light at a position, without shadows and cones.
pub fn brightness_at(light: &Light, position: Vec3) -> f32 {
    let distance = light.position.distance(position);
    let falloff = match light.kind {
        LightKind::Directional => 1.0,
        _ if distance > light.range => return 0.0,
        _ => (distance * distance).max(0.1),
    };
    light.intensity * light.color.max_element() / falloff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_key_light_takes_the_role_from_the_last() {
        let light = |role| Light { role, ..Light::default() };
        let mut lights = [light(LightRole::Key), light(LightRole::Fill), light(LightRole::Key)];
        keep_one_key(&mut lights, 1);
        assert_eq!(key_light(&lights), Some(0));
        keep_one_key(&mut lights, 2);
        assert_eq!(lights.map(|light| light.role), [LightRole::None, LightRole::Fill, LightRole::Key]);
        assert_eq!(key_light(&lights), Some(2));
    }

    #[test]
    fn brightness_falls_with_distance_and_ends_at_the_range() {
        let lamp = Light { position: Vec3::ZERO, intensity: 8.0, range: 10.0, ..Light::default() };
        let is_at = |light: &Light, metres: f32, expected: f32| {
            let brightness = brightness_at(light, Vec3::X * metres);
            assert!((brightness - expected).abs() < 1e-6, "{brightness} at {metres} m");
        };
        is_at(&lamp, 2.0, 2.0);
        is_at(&lamp, 11.0, 0.0);
        let sun = Light { kind: LightKind::Directional, ..lamp };
        is_at(&sun, 11.0, 8.0);
    }
}
