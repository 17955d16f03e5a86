//! What several settings make together: values that a look is made of, and that are no settings of their own.

use std::ops::RangeInclusive;

use glam::Vec3;
use haze::preset::PresetSystem;

/// A value of a system.
pub struct Made {
    pub name: &'static str,
    pub tooltip: &'static str,
    pub unit: &'static str,
    /// What it may be, and what is usual.
    pub range: RangeInclusive<f32>,
    pub usual: (f32, f32),
    /// The settings that make it, from the system on.
    pub of: &'static [&'static str],
    pub get: fn(&PresetSystem) -> f32,
    pub set: fn(&mut PresetSystem, f32),
}

pub const THICKNESS: Made = Made {
    name: "thickness",
    tooltip: "How much one full-grown sprite covers: amount, opacity and boost together.",
    unit: "",
    range: 0.001..=16.0,
    usual: (0.001, 3.0),
    of: &["emitter.amount", "settings.accumulate.opacity", "settings.boost"],
    get: thickness,
    set: set_thickness,
};

pub const WIND: Made = Made {
    name: "wind",
    tooltip: "How fast the air moves. Its direction is a setting of the emitter; from stillness it blows to the right.",
    unit: "m/s",
    range: 0.0..=20.0,
    usual: (0.0, 4.0),
    of: &["emitter.wind"],
    get: |system| system.emitter.wind.length(),
    set: |system, speed| system.emitter.wind = system.emitter.wind.normalize_or(Vec3::X) * speed,
};

pub const SOFTNESS: Made = Made {
    name: "softness",
    tooltip: "Distance over which smoke dissolves before a surface: 1 / fade_scale.",
    unit: "m",
    range: 0.001..=10.0,
    usual: (0.01, 2.0),
    of: &["settings.soft_fade.fade_scale"],
    get: |system| 1.0 / system.settings.soft_fade.fade_scale,
    set: |system, reach| system.settings.soft_fade.fade_scale = 1.0 / reach,
};

impl Made {
    /// What it is called among the paths of settings.
    pub fn path(&self, system: usize) -> String {
        format!("systems[{system}].{}", self.name)
    }

    /// The system and the value that such a path names.
    pub fn find(path: &str) -> Option<(usize, Self)> {
        let (system, name) = path.strip_prefix("systems[")?.split_once("].")?;
        let made = [THICKNESS, WIND, SOFTNESS].into_iter().find(|made| made.name == name)?;
        Some((system.parse().ok()?, made))
    }
}

fn thickness(system: &PresetSystem) -> f32 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thickness_is_what_it_is_set_to_as_far_as_it_goes() {
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
    fn a_little_more_moves_amount_and_boost_alike() {
        let mut system = PresetSystem::default();
        let before = system.clone();
        set_thickness(&mut system, 1.21 * thickness(&before));
        assert!((system.emitter.amount / before.emitter.amount - 1.1).abs() < 1e-3);
        assert!((system.settings.boost / before.settings.boost - 1.1).abs() < 1e-3);
        assert!((system.settings.accumulate.opacity / before.settings.accumulate.opacity - 1.0).abs() < 1e-3);
    }
}
