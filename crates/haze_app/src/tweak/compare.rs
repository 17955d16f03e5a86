//! A second picture beside the first: every saving shows its price.

use haze::preset::{Camera, Preset};
use haze::settings::Path;
use haze_demo::shot::Shot;

use super::lights::ShownLights;

/// What the picture is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Against {
    /// The preset as it is on disk.
    Saved,
    /// The preset as it once was.
    Kept(Box<Preset>),
    /// The same without a reduced target.
    FullResolution,
    /// The same lit and blended sprite by sprite.
    Forward,
    /// The same by the renderer that the specification is.
    Reference,
}

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    First,
    Second,
}

/// How the two are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Compare {
    pub against: Option<Against>,
    /// Share of the width from which on the second is shown.
    pub split: f32,
    /// Multiplies the difference of the two, which is shown instead; 0: they stand side by side.
    pub difference: f32,
}

impl Default for Compare {
    fn default() -> Self {
        Self { against: None, split: 0.5, difference: 0.0 }
    }
}

/// What one click shows beside the picture.
pub struct Offer {
    pub against: Against,
    /// On a button.
    pub short: &'static str,
    /// On a line of its own.
    pub name: &'static str,
    pub tooltip: &'static str,
}

const fn offer(against: Against, short: &'static str, name: &'static str, tooltip: &'static str) -> Offer {
    Offer { against, short, name, tooltip }
}

pub static OFFERS: [Offer; 4] = [
    offer(Against::Saved, "Saved", "As saved", "The preset as it is on disk"),
    offer(Against::FullResolution, "Full", "Full resolution", "The same smoke without a reduced target"),
    offer(Against::Forward, "Forward", "Forward", "The same smoke lit and blended sprite by sprite, the classic way"),
    offer(Against::Reference, "CPU", "CPU reference", "The same by the CPU renderer, the specification: takes a while"),
];

impl Compare {
    /// Shows this beside the picture, or no longer.
    pub fn toggle(&mut self, against: &Against) {
        self.against = (self.against.as_ref() != Some(against)).then(|| against.clone());
    }

    /// Which of the two is seen at a share of the width. Of their difference, the first.
    pub fn side(&self, x: f32) -> Side {
        let is_second = self.against.is_some() && self.difference == 0.0 && x >= self.split;
        if is_second { Side::Second } else { Side::First }
    }
}

impl Against {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Saved => "as saved",
            Self::Kept(_) => "as kept",
            Self::FullResolution => "full resolution",
            Self::Forward => "forward",
            Self::Reference => "CPU reference",
        }
    }

    /// The settings of the second, where it has any of its own.
    pub fn settings<'a>(&'a self, saved: &'a Preset) -> Option<&'a Preset> {
        match self {
            Self::Saved => Some(saved),
            Self::Kept(preset) => Some(preset),
            Self::FullResolution | Self::Forward | Self::Reference => None,
        }
    }

    /// The second shot: seen as the first is, at the same time.
    pub fn shot(&self, first: &Shot, saved: &Preset, lights: &ShownLights) -> Shot {
        let mut shot = first.clone();
        if let Some(settings) = self.settings(saved) {
            shot.preset = seen_as(settings, &first.preset, lights);
        }
        let systems = shot.preset.systems.iter_mut();
        match self {
            Self::FullResolution => systems.for_each(|system| {
                let accumulate = &mut system.settings.accumulate;
                (accumulate.scale, accumulate.max_side) = (1, 16384);
            }),
            Self::Forward => systems.for_each(|system| system.settings.path = Path::Forward),
            Self::Saved | Self::Kept(_) | Self::Reference => {}
        }
        shot
    }
}

/// A preset from where another is seen, at its time, with the same lights muted and turned. How it is exposed is its own.
fn seen_as(preset: &Preset, other: &Preset, lights: &ShownLights) -> Preset {
    let camera = Camera { exposure: preset.camera.exposure, ..other.camera };
    Preset { camera, time: other.time, lights: lights.shown_of(&preset.lights), ..preset.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn the_second_differs_only_in_what_it_is_for() {
        let mut first = Shot::load("column", UVec2::new(64, 36)).unwrap();
        let saved = first.preset.clone();
        first.preset.camera.fov = 70.0;
        first.preset.time = 3.0;
        first.preset.systems[0].settings.boost = 1.0;
        let mut lights = ShownLights::default();
        lights.follow(&first.preset.lights);
        lights.marks(0).unwrap().is_muted = true;
        first.preset.lights = lights.shown(&first.preset.lights);
        let shot = |against: Against| against.shot(&first, &saved, &lights).preset;
        let (as_saved, whole) = (shot(Against::Saved), shot(Against::FullResolution));
        assert_eq!((as_saved.camera, as_saved.systems.clone()), (first.preset.camera, saved.systems.clone()));
        assert_eq!((&as_saved.lights, &whole.lights), (&first.preset.lights, &first.preset.lights));
        assert_eq!(as_saved.time.to_bits(), first.preset.time.to_bits());
        assert_eq!(whole.systems[0].settings.accumulate.scale, 1);
        whole.validate().unwrap();
        let mut back = whole;
        back.systems[0].settings.accumulate = saved.systems[0].settings.accumulate;
        assert_eq!(back, first.preset);
        assert!(shot(Against::Forward).systems[0].settings.is_forward());
    }
}
