//! The lighting resolution that `auto` chooses.

use std::fmt;

use crate::assets::ramp_steps::RampSteps;
use crate::settings::{LightingResolution, Settings};

/// Largest step of a ramp times the scale, at which light per texel looks like light per pixel. Steps are those of
/// [`RampSteps`].
const SMOOTH_STEP: f32 = 0.4;
/// Scale from which on the limit stays: a coarser target blurs the smoke more than the light.
const COARSE_SCALE: u32 = 4;

/// Largest step of a ramp at which a target of this scale is lit per texel.
fn largest_smooth_step(scale: u32) -> f32 {
    SMOOTH_STEP / scale.min(COARSE_SCALE) as f32
}

/// Lighting resolution that `auto` chose for a system, with the reason. `Display` formats it as one sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightingChoice {
    /// [`LightingResolution::Target`] or [`LightingResolution::Full`].
    pub resolution: LightingResolution,
    /// Largest step of the ramps in use, 0 to 1: 1 for a hard step from black.
    pub largest_step: f32,
    /// Pixels per texel of the target, along each side.
    pub scale: u32,
}

impl LightingChoice {
    pub(super) fn new(ramp_steps: &RampSteps, settings: &Settings, scale: u32) -> Self {
        Self::of_step(ramp_steps.largest(settings), scale)
    }

    /// Chooses for another scale.
    pub(super) fn at_scale(self, scale: u32) -> Self {
        Self::of_step(self.largest_step, scale)
    }

    fn of_step(largest_step: f32, scale: u32) -> Self {
        let is_smooth = largest_step <= largest_smooth_step(scale);
        let resolution = if is_smooth { LightingResolution::Target } else { LightingResolution::Full };
        Self { resolution, largest_step, scale }
    }
}

impl fmt::Display for LightingChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { resolution, largest_step, scale } = self;
        let limit = largest_smooth_step(*scale);
        let comparison = if *resolution == LightingResolution::Target { "at most" } else { "above" };
        let name = resolution.name();
        write!(
            f,
            "{name}: the largest step of the ramps is {largest_step:.2}, {comparison} {limit:.2} at scale {scale}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_compares_the_step_with_the_limit_of_the_scale() {
        let sentence = |step, scale| {
            let ramps = RampSteps { diffuse: step, ..RampSteps::default() };
            LightingChoice::new(&ramps, &Settings::default(), scale).to_string()
        };
        assert_eq!(sentence(0.05, 4), "target: the largest step of the ramps is 0.05, at most 0.10 at scale 4");
        assert_eq!(sentence(0.09, 8), "target: the largest step of the ramps is 0.09, at most 0.10 at scale 8");
        assert_eq!(sentence(0.27, 2), "full: the largest step of the ramps is 0.27, above 0.20 at scale 2");
    }
}
