//! Comparison of the image with a second one, to show the image error that a saving costs.

use haze_core::settings::RenderPath;
use haze_demo::shot::Shot;
use haze_preset::{Camera, Preset};

use super::view_options::ViewOptions;
use crate::viewport_renderer::compared_side::ComparedSide;

/// Variant that the image is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum CompareWith {
    /// The preset as it is on disk.
    Saved,
    /// A copy of the preset that the user kept earlier.
    Kept(Box<Preset>),
    /// The same preset without a reduced accumulation target.
    FullResolution,
    /// The same preset in forward mode: each sprite is lit and blended.
    Forward,
    /// The same preset drawn by the CPU renderer, the reference.
    Reference,
}

/// State of the comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareState {
    pub against: Option<CompareWith>,
    /// Fraction of the width at which the second image begins, 0 to 1.
    pub split: f32,
    /// Factor on the difference image, which replaces the two images; 0 shows the two side by side.
    pub difference: f32,
}

impl Default for CompareState {
    fn default() -> Self {
        Self { against: None, split: 0.5, difference: 0.0 }
    }
}

/// Comparison that one click turns on.
pub struct CompareOption {
    pub against: CompareWith,
    /// Label of its button.
    pub short: &'static str,
    /// Label of its menu line.
    pub name: &'static str,
    pub tooltip: &'static str,
}

const fn offer(against: CompareWith, short: &'static str, name: &'static str, tooltip: &'static str) -> CompareOption {
    CompareOption { against, short, name, tooltip }
}

pub static COMPARE_OPTIONS: [CompareOption; 4] = [
    offer(CompareWith::Saved, "Saved", "Saved file", "The preset as it was last saved"),
    offer(CompareWith::FullResolution, "Full", "Full resolution", "The same smoke at full resolution"),
    offer(
        CompareWith::Forward,
        "Forward",
        "Forward shading",
        "The classic path: each sprite is lit and blended separately",
    ),
    offer(CompareWith::Reference, "CPU", "CPU reference", "The same image by the CPU renderer. It takes a while."),
];

impl CompareState {
    /// Turns this comparison on, or off if it is on.
    pub fn toggle(&mut self, against: &CompareWith) {
        self.against = (self.against.as_ref() != Some(against)).then(|| against.clone());
    }

    /// Returns the image shown at a fraction `x` of the width. The difference view counts as the first image.
    pub fn side(&self, x: f32) -> ComparedSide {
        let is_second = self.against.is_some() && self.difference == 0.0 && x >= self.split;
        if is_second { ComparedSide::Second } else { ComparedSide::First }
    }
}

impl CompareWith {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Saved => "Saved",
            Self::Kept(_) => "Earlier settings",
            Self::FullResolution => "Full resolution",
            Self::Forward => "Forward",
            Self::Reference => "CPU reference",
        }
    }

    /// Returns the preset of the second image if it has settings of its own.
    pub fn settings<'a>(&'a self, saved: &'a Preset) -> Option<&'a Preset> {
        match self {
            Self::Saved => Some(saved),
            Self::Kept(preset) => Some(preset),
            Self::FullResolution | Self::Forward | Self::Reference => None,
        }
    }

    /// Returns the shot of the second image, with the camera, time, visible lights and visible systems of the first.
    pub fn shot(&self, first: &Shot, saved: &Preset, view: &ViewOptions) -> Shot {
        let mut shot = first.clone();
        if let Some(settings) = self.settings(saved) {
            shot.preset = with_view_of(settings, &first.preset, view);
        }
        let systems = shot.preset.systems.iter_mut();
        match self {
            Self::FullResolution => systems.for_each(|system| {
                let accumulate = &mut system.settings.accumulate;
                accumulate.fix_scale(1);
                accumulate.max_side = 16384;
            }),
            Self::Forward => systems.for_each(|system| system.settings.path = RenderPath::Forward),
            Self::Saved | Self::Kept(_) | Self::Reference => {}
        }
        shot
    }
}

/// Returns `preset` at the time of `other` with its camera, and with the same lights and systems muted, and lights turned. The
/// exposure stays that of `preset`.
fn with_view_of(preset: &Preset, other: &Preset, view: &ViewOptions) -> Preset {
    let mut preset = preset.evaluate(other.time);
    view.systems.apply(&mut preset, view.systems.has_solo(&other.systems));
    let camera = Camera { exposure: preset.camera.exposure, ..other.camera };
    Preset { camera, time: other.time, lights: view.lights.shown_of_preset(&preset.lights), ..preset }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn the_second_shot_differs_only_in_the_compared_setting() {
        let mut first = Shot::load("column", UVec2::new(64, 36)).unwrap();
        let saved = first.preset.clone();
        first.preset.camera.fov = 70.0;
        first.preset.time = 3.0;
        first.preset.systems[0].settings.boost = 1.0;
        let mut view = ViewOptions::default();
        view.lights.follow(&first.preset.lights);
        view.lights.mute_solo(0).unwrap().is_muted = true;
        first.preset.lights = view.lights.shown(&first.preset.lights);
        let shot = |against: CompareWith| against.shot(&first, &saved, &view).preset;
        let as_saved = shot(CompareWith::Saved);
        let whole = shot(CompareWith::FullResolution);
        assert_eq!((as_saved.camera, as_saved.systems.clone()), (first.preset.camera, saved.systems.clone()));
        assert_eq!((&as_saved.lights, &whole.lights), (&first.preset.lights, &first.preset.lights));
        assert_eq!(as_saved.time.to_bits(), first.preset.time.to_bits());
        assert_eq!(whole.systems[0].settings.accumulate.downscale, 1);
        whole.validate().unwrap();
        let mut back = whole;
        back.systems[0].settings.accumulate = saved.systems[0].settings.accumulate;
        assert_eq!(back, first.preset);
        assert!(shot(CompareWith::Forward).systems[0].settings.is_forward());
        view.systems.mute_solo(&first.preset.systems, 0).is_muted = true;
        let muted = CompareWith::Saved.shot(&first, &saved, &view).preset;
        assert!(muted.systems[0].emitter.rate <= 0.0);
    }
}
