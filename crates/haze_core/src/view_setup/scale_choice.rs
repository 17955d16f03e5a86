//! The scale that `auto` chooses for a target.

use std::fmt;

use super::error_prediction::ErrorPrediction;
use super::resolved_settings::ResolvedSettings;
use super::sprite_projector::SpriteTrim;
use super::system_setup::SystemSetup;
use super::view_geometry::ViewGeometry;
use crate::assets::material_assets::MaterialInfo;
use crate::frame::Particle;
use crate::settings::COARSEST_AUTO_SCALE;

/// Fraction of the largest error that the predicted one may be above or below before the scale changes: a moving camera does
/// not make it change back and forth.
const MARGIN: f32 = 0.15;

/// Scale that `auto` chose for a system, with the reason. `Display` formats it as one sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleChoice {
    /// Pixels per texel of the target, along each side.
    pub scale: u32,
    /// Predicted error at this scale: root mean square over the smoke, of the amount 1. `None` for particles in a
    /// host's buffer, which the CPU does not know.
    pub error: Option<f32>,
    /// Predicted error at the next coarser scale, if there is one.
    pub coarser_error: Option<f32>,
    /// Largest error: `max_error` of the settings.
    pub max_error: f32,
}

impl ScaleChoice {
    /// Chooses the scale if the settings leave it open, and applies it to the settings and the setup. `particles`: with
    /// the number of sprites that each stands for; `None` if they are unknown, which keeps the fixed scale. `before`: choice
    /// of the frame before, which is kept as long as it is nearly right.
    pub fn apply(
        view: &ViewGeometry,
        settings: &mut ResolvedSettings,
        setup: &mut SystemSetup,
        trim: &SpriteTrim,
        material: &MaterialInfo,
        particles: Option<(&[Particle], u32)>,
        before: Option<u32>,
    ) -> Option<Self> {
        if !settings.adapts_scale() {
            return None;
        }
        let max_error = settings.accumulate.max_error;
        let choice = match particles {
            Some((particles, particles_per_sample)) => {
                let view = view.uniform(false);
                let projector = setup.projector(&view, settings, trim);
                let prediction =
                    ErrorPrediction::new(&projector, setup, particles, particles_per_sample, settings, material);
                Self::within(&prediction, settings.finest_scale, max_error, before)
            }
            None => Self { scale: settings.scale, error: None, coarser_error: None, max_error },
        };
        *settings = settings.with_scale(choice.scale);
        *setup = setup.with_scale(view, choice.scale);
        Some(choice)
    }

    fn within(prediction: &ErrorPrediction, finest: u32, max_error: f32, before: Option<u32>) -> Self {
        let coarsest_within = |limit: f32| {
            let fits = |scale: &u32| prediction.at(*scale) <= limit;
            (finest + 1..=COARSEST_AUTO_SCALE).take_while(fits).last().unwrap_or(finest)
        };
        let [fine, coarse] = [1.0 - MARGIN, 1.0 + MARGIN].map(|fraction| coarsest_within(fraction * max_error));
        let scale = before.map_or_else(|| coarsest_within(max_error), |before| before.clamp(fine, coarse));
        let error = |scale| (scale <= COARSEST_AUTO_SCALE).then(|| prediction.at(scale));
        Self { scale, error: error(scale), coarser_error: error(scale + 1), max_error }
    }
}

impl fmt::Display for ScaleChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scale, error, coarser_error, max_error } = *self;
        write!(f, "{scale}: ")?;
        match (error, coarser_error) {
            (None, _) => f.write_str("fixed, because the particles are in a buffer that the CPU does not know"),
            (Some(error), None) => write!(f, "predicted error {error:.4}, limit {max_error}; the coarsest scale"),
            (Some(error), Some(coarser)) => {
                write!(f, "predicted error {error:.4}, limit {max_error} ({coarser:.4} at scale {})", scale + 1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that grow by 0.002 per pixel of a texel's side.
    fn choose(finest: u32, max_error: f32, before: Option<u32>) -> ScaleChoice {
        let errors = std::array::from_fn(|index| 0.002 * index as f32);
        ScaleChoice::within(&ErrorPrediction::of(errors), finest, max_error, before)
    }

    #[test]
    fn takes_the_coarsest_scale_within_the_error() {
        let scale = |finest, max_error| choose(finest, max_error, None).scale;
        assert_eq!([1, 2, 4].map(|finest| scale(finest, 0.0041)), [3, 3, 4]);
        assert_eq!((scale(1, 0.0), scale(2, 1.0), scale(12, 1.0)), (1, 4, 12));
    }

    #[test]
    fn keeps_a_scale_that_is_nearly_right() {
        let scale = |finest, max_error, before| choose(finest, max_error, Some(before)).scale;
        assert_eq!([0.0036, 0.0041, 0.0046].map(|limit| scale(1, limit, 3)), [3, 3, 3]);
        assert_eq!([0.0033, 0.0071].map(|limit| scale(1, limit, 3)), [2, 4]);
        assert_eq!([0.0061, 0.0071].map(|limit| scale(1, limit, 2)), [3, 4]);
        assert_eq!(scale(2, 0.0001, 1), 2);
    }

    #[test]
    fn the_sentence_tells_the_error_and_the_next() {
        assert_eq!(choose(2, 0.0041, None).to_string(), "3: predicted error 0.0040, limit 0.0041 (0.0060 at scale 4)");
        assert_eq!(choose(4, 0.0041, None).to_string(), "4: predicted error 0.0060, limit 0.0041; the coarsest scale");
        let unknown = ScaleChoice { scale: 2, error: None, coarser_error: None, max_error: 0.01 }.to_string();
        assert_eq!(unknown, "2: fixed, because the particles are in a buffer that the CPU does not know");
    }
}
