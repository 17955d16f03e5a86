//! Values that are computed from one or several settings, such as thickness. They are no settings of their own.

use std::ops::RangeInclusive;

use glam::Vec3;
use haze_preset::PresetSystem;

/// Computed value of a system.
pub struct MacroParam {
    pub name: &'static str,
    pub tooltip: &'static str,
    pub unit: &'static str,
    /// Valid range, and the usual range for the slider.
    pub range: RangeInclusive<f32>,
    pub usual: (f32, f32),
    /// Paths of the settings it is computed from, relative to the system.
    pub of: &'static [&'static str],
    pub get: fn(&PresetSystem) -> f32,
    pub set: fn(&mut PresetSystem, f32),
}

pub const THICKNESS: MacroParam = MacroParam {
    name: "thickness",
    tooltip: "How opaque one grown sprite is: amount × opacity × boost. Higher: denser smoke.",
    unit: "",
    range: 0.001..=16.0,
    usual: (0.001, 3.0),
    of: &["emitter.amount", "settings.accumulate.opacity", "settings.boost"],
    get: thickness,
    set: set_thickness,
};

pub const WIND: MacroParam = MacroParam {
    name: "wind",
    tooltip: "Speed of the air. The emitter's wind sets the direction; a new wind blows along +x.",
    unit: "m/s",
    range: 0.0..=20.0,
    usual: (0.0, 4.0),
    of: &["emitter.wind"],
    get: |system| system.emitter.wind.length(),
    set: |system, speed| system.emitter.wind = system.emitter.wind.normalize_or(Vec3::X) * speed,
};

pub const SOFTNESS: MacroParam = MacroParam {
    name: "softness",
    tooltip: "Distance over which smoke fades in front of a surface: 1 / fade scale.",
    unit: "m",
    range: 0.001..=10.0,
    usual: (0.01, 2.0),
    of: &["settings.soft_fade.fade_scale"],
    get: |system| 1.0 / system.settings.soft_fade.fade_scale,
    set: |system, reach| system.settings.soft_fade.fade_scale = 1.0 / reach,
};

impl MacroParam {
    /// Returns the path of the value, in the form of a setting's path.
    pub fn path(&self, system: usize) -> String {
        format!("systems[{system}].{}", self.name)
    }

    /// Returns the index of the system and the value that a path names.
    pub fn find(path: &str) -> Option<(usize, Self)> {
        let (system, name) = path.strip_prefix("systems[")?.split_once("].")?;
        let made = [THICKNESS, WIND, SOFTNESS].into_iter().find(|made| made.name == name)?;
        Some((system.parse().ok()?, made))
    }
}

fn thickness(system: &PresetSystem) -> f32 {
    system.emitter.amount * system.settings.accumulate.opacity * system.settings.boost
}

/// Sets the product. Amount and boost change by the same factor within their ranges; opacity takes the rest.
fn set_thickness(system: &mut PresetSystem, thickness: f32) {
    // Field, its upper limit, and the exponent of its fraction in the remaining factor.
    let mut of = [
        (&mut system.emitter.amount, 1.0, 0.5),
        (&mut system.settings.boost, 16.0, 1.0),
        (&mut system.settings.accumulate.opacity, 1.0, 1.0),
    ];
    // A factor of 0 cannot be scaled.
    of.iter_mut().for_each(|(value, ..)| **value = value.max(1.0e-3));
    for at in 0..of.len() {
        let product: f32 = of.iter().map(|(value, ..)| **value).product();
        let (value, most, fraction) = &mut of[at];
        **value = (**value * (thickness / product).powf(*fraction)).clamp(1.0e-3, *most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thickness_reaches_its_set_value_within_its_range() {
        let mut system = PresetSystem::default();
        for wanted in [0.001, 0.05, 0.3, 1.0, 4.0, 15.0, 0.2] {
            set_thickness(&mut system, wanted);
            let found = thickness(&system);
            assert!((found / wanted - 1.0).abs() < 1e-3, "{wanted} {found} {system:?}");
            let settings = &system.settings;
            assert!(system.emitter.amount <= 1.0 && settings.boost <= 16.0 && settings.accumulate.opacity <= 1.0);
        }
    }

    #[test]
    fn a_small_increase_scales_amount_and_boost_equally() {
        let mut system = PresetSystem::default();
        let before = system.clone();
        set_thickness(&mut system, 1.21 * thickness(&before));
        assert!((system.emitter.amount / before.emitter.amount - 1.1).abs() < 1e-3);
        assert!((system.settings.boost / before.settings.boost - 1.1).abs() < 1e-3);
        assert!((system.settings.accumulate.opacity / before.settings.accumulate.opacity - 1.0).abs() < 1e-3);
    }
}
