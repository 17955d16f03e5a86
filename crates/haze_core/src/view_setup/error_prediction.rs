//! Prediction of the error of a coarse target, from the detail of the sprites that it loses.

use glam::Vec2;

use super::density_splat::erosion_of;
use super::optical_depth::optical_depth;
use super::sprite_projector::{ProjectedSprite, SpriteProjector, TexelGrid};
use super::system_setup::SystemSetup;
use crate::assets::material_assets::MaterialInfo;
use crate::assets::sprite::sprite_detail::LostDetail;
use crate::formula::grain::octave_fraction;
use crate::frame::Particle;
use crate::settings::{BlendOrder, COARSEST_AUTO_SCALE, Settings};

/// Maximum number of sprites that stand for all.
const SAMPLE: usize = 256;

// Sizes of the errors: chosen so that the predictions are near the errors of the built-in presets, in the table of
// `docs/upsampling.md`.

/// Standard deviation of the noise's density and of its tilt, of the built-in noise.
const DENSITY_DEVIATION: f32 = 0.14;
const TILT_DEVIATION: f32 = 0.3;
/// Change of a sprite's amount with the density of its grain, at an erosion of 1, on average.
const EROSION_SLOPE: f32 = 0.3;
/// Change of the amount of a volumetric sprite with the density of its noise, on average.
const MARCH_SLOPE: f32 = 0.5;
/// Change of the light with the normal, on average over directions and lights.
const LIGHT_SLOPE: f32 = 0.25;
/// Error of a sphere without an image whose diameter is one texel, relative to its amount.
const SPHERE_LOSS: f32 = 0.3;
/// Power of the scale that the error of interpolating between texels grows with.
const INTERPOLATION_POWER: f32 = 1.5;

/// Errors of a system's smoke, predicted for each scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorPrediction {
    /// Root mean square over the smoke at scale 1, 2 …
    errors: [f32; COARSEST_AUTO_SCALE as usize],
}

impl ErrorPrediction {
    /// Predicts the errors from `particles`. `particles_per_sample`: number of sprites that each stands for. `setup`: of the
    /// system, at any scale.
    pub fn new(
        projector: &SpriteProjector<'_>,
        setup: &SystemSetup,
        particles: &[Particle],
        particles_per_sample: u32,
        settings: &Settings,
        material: &MaterialInfo,
    ) -> Self {
        let step = particles.len().div_ceil(SAMPLE).max(1);
        let sample = particles.iter().step_by(step).filter(|particle: &&Particle| particle.is_visible());
        let mut areas = 0.0_f64;
        let mut depths = 0.0_f64;
        let mut squares = [[0.0_f64; 2]; COARSEST_AUTO_SCALE as usize];
        let grid = TexelGrid { origin: Vec2::ZERO, scale: 1.0, size: projector.view.size.as_uvec2() };
        for covered in projector.coverages(&grid, sample) {
            let erosion = erosion_of(projector.system, covered.particle);
            let weight = covered.texels * f64::from(covered.sprite.amount).powi(2);
            for (scale, [amount, normal]) in (1..).zip(&mut squares) {
                let lost = lost_detail(&covered.sprite, scale as f32, erosion, settings, material);
                *amount += weight * f64::from(lost.amount * lost.amount);
                *normal += weight * f64::from(lost.normal * lost.normal);
            }
            areas += covered.texels;
            depths += covered.texels * f64::from(optical_depth(covered.particle, settings));
        }
        let count = step as f64 * f64::from(particles_per_sample);
        let of_box = setup.pixels.as_dvec2().element_product().max(1.0);
        // Sprites at random positions cover this much of their box.
        let covered = (of_box * (1.0 - (-count * areas / of_box).exp())).max(1.0e-9);
        let depth = count * depths / covered;
        let [by_amount, by_normal] = visibility(depth, settings.order());
        let error = |[amount, normal]: [f64; 2]| {
            let light = f64::from(LIGHT_SLOPE * LIGHT_SLOPE);
            (count / covered * (by_amount * amount + light * by_normal * normal)).sqrt() as f32
        };
        Self { errors: squares.map(error) }
    }

    /// A prediction for tests: the errors at scale 1, 2 …
    #[cfg(test)]
    pub(super) fn of(errors: [f32; COARSEST_AUTO_SCALE as usize]) -> Self {
        Self { errors }
    }

    /// Predicted error at a scale, 1 to [`COARSEST_AUTO_SCALE`].
    pub fn at(&self, scale: u32) -> f32 {
        self.errors[(scale.clamp(1, COARSEST_AUTO_SCALE) - 1) as usize]
    }
}

/// Mean square of the fraction with which a sprite's amount, and its normal, show in the image. `depth`: mean optical depth
/// of the smoke.
fn visibility(depth: f64, order: BlendOrder) -> [f64; 2] {
    let mean = |depth: f64| if depth > 1.0e-3 { (1.0 - (-depth).exp()) / depth } else { 1.0 };
    // The amount shows through all other sprites. Smoke is uneven: the mean over depths from 0 to twice the mean one.
    let by_amount = mean(4.0 * depth);
    let by_normal = match order {
        // Through those in front.
        BlendOrder::Sorted => mean(2.0 * depth),
        // As one of all.
        BlendOrder::Weighted => mean(depth).powi(2),
    };
    [by_amount, by_normal]
}

/// Detail that a target loses of a sprite.
fn lost_detail(
    sprite: &ProjectedSprite,
    scale: f32,
    erosion: f32,
    settings: &Settings,
    material: &MaterialInfo,
) -> LostDetail {
    let texels = (sprite.diameter / scale).max(1.0e-3);
    if settings.technique.is_volumetric() {
        let metres_per_texel = 2.0 * sprite.radius / texels;
        let fineness = metres_per_texel * material.noise_size / settings.volumetric.noise_size;
        let amount = MARCH_SLOPE * DENSITY_DEVIATION * lost_noise(fineness, settings.volumetric.noise_octaves);
        return LostDetail { amount, normal: amount };
    }
    if !settings.technique.is_flat() {
        let amount = SPHERE_LOSS * texels.max(1.0).powf(-INTERPOLATION_POWER);
        return LostDetail { amount, normal: amount };
    }
    let detail = &material.sprite_detail;
    let lost = detail.lost((material.sprite_size / texels).log2());
    let of_grain = detail.amount * lost_grain(settings.grain.tiles * material.noise_size / texels, scale, settings);
    let of_amount = EROSION_SLOPE * DENSITY_DEVIATION * erosion * of_grain;
    let of_normal = TILT_DEVIATION * settings.grain.bump * of_grain;
    LostDetail { amount: lost.amount.hypot(of_amount), normal: lost.normal.hypot(of_normal) }
}

/// Error of noise that is interpolated between the texels of a target, relative to its deviation. `fineness`: texels of the
/// noise per texel of the target.
fn lost_noise(fineness: f32, octaves: u32) -> f32 {
    let weights = || (0..octaves as i32).map(|octave| (0.5_f32.powi(octave), fineness * 3.0_f32.powi(octave)));
    let total: f32 = weights().map(|(weight, _)| weight).sum();
    weights().map(|(weight, fine)| (weight / total * interpolation_error(fine)).powi(2)).sum::<f32>().sqrt()
}

/// The same of one octave.
fn interpolation_error(fineness: f32) -> f32 {
    (0.5 * fineness).min(1.0).powf(INTERPOLATION_POWER)
}

/// Fraction of the grain that a target loses, of its deviation. `fineness`: texels of the noise per texel of the target.
fn lost_grain(fineness: f32, scale: f32, settings: &Settings) -> f32 {
    let lost = |octave: i32| {
        let fine = fineness * 3.0_f32.powi(octave);
        let full = octave_fraction(fine / scale);
        let shown = octave_fraction(fine);
        0.5_f32.powi(octave) * (full - shown + shown * interpolation_error(fine))
    };
    (0..settings.grain_octaves() as i32).map(|octave| lost(octave).powi(2)).sum::<f32>().sqrt()
}
