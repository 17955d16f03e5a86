//! Density of a sprite's image, as the shadow of smoke needs it.

use crate::formula::density_grid::mean_optical_depth;
use crate::formula::grain::eroded;

/// Largest alpha whose optical depth is counted: that of an alpha of 1 is infinite. 0.98 is 3.9.
const MAX_ALPHA: f32 = 0.98;

/// Smallest extent of a sprite's density, as a fraction of the sprite's.
const MIN_REACH: f32 = 0.25;

/// Density of a sprite, over all its frames: the parameters of [`mean_optical_depth`], and its extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpriteDensity {
    /// Mean alpha of the texels, 0 to 1.
    pub mean_alpha: f32,
    /// Alpha in the middle of a sprite of this mean, 0 to 1.
    pub peak_alpha: f32,
    /// Fraction of its alpha that remains at an erosion of 1.
    pub eroded_fraction: f32,
    /// Radius of the bump that spreads as far as the sprite's optical depth does, as a fraction of half the sprite's side.
    pub reach: f32,
}

impl SpriteDensity {
    /// Measures frames below each other. `side`: of a frame, texels.
    pub fn new(side: u32, texels: &[[u8; 4]]) -> Self {
        let mut counts = [0_u32; 256];
        let mut total = 0_u32;
        for [.., alpha] in texels {
            counts[usize::from(*alpha)] += 1;
            total += 1;
        }
        let mean = |of_alpha: fn(f32) -> f32| {
            let alphas = (0_u8..=255).map(|code| f32::from(code) / 255.0);
            let sum: f64 = counts.iter().zip(alphas).map(|(&n, alpha)| f64::from(n) * f64::from(of_alpha(alpha))).sum();
            (sum / f64::from(total.max(1))) as f32
        };
        let mean_alpha = mean(|alpha| alpha);
        let opaque = mean(|alpha| -(1.0 - alpha.min(MAX_ALPHA)).ln());
        // The depth at amount 1 grows with the peak: bisects.
        let mut low = 0.0;
        let mut high = MAX_ALPHA;
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if mean_optical_depth(1.0, mean_alpha, middle) < opaque {
                low = middle;
            } else {
                high = middle;
            }
        }
        let eroded_fraction = mean(|alpha| eroded(alpha, 0.0, 1.0)) / mean_alpha.max(1.0e-6);
        Self { mean_alpha, peak_alpha: 0.5 * (low + high), eroded_fraction, reach: reach(side, texels) }
    }
}

/// Standard deviation of the optical depth from the sprites' centers, along an axis, over that of a bump of radius 1.
fn reach(side: u32, texels: &[[u8; 4]]) -> f32 {
    let mut total = 0.0_f64;
    let mut squares = 0.0_f64;
    for (texel, [.., alpha]) in (0..).zip(texels) {
        let depth = -(1.0 - (f32::from(*alpha) / 255.0).min(MAX_ALPHA)).ln();
        let position = [texel % side, texel / side % side].map(|at| (at as f32 + 0.5) / side as f32 * 2.0 - 1.0);
        total += f64::from(depth);
        squares += f64::from(depth * (position[0] * position[0] + position[1] * position[1]) * 0.5);
    }
    // Variance of the bump 15/16·(1 - q²)².
    const BUMP: f64 = 1.0 / 7.0;
    let reach = (squares / total.max(1.0e-6) / BUMP).sqrt() as f32;
    reach.clamp(MIN_REACH, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::{Sprite, SpriteLayout};
    use super::*;
    use crate::assets::noise::NoiseVolume;
    use crate::formula::grain::kept_fraction;

    #[test]
    fn reach_is_that_of_a_bump_with_the_same_spread() {
        const SIDE: u32 = 32;
        for radius in [0.4_f32, 0.7, 1.0] {
            let texel = |index: u32| {
                let at = [index % SIDE, index / SIDE].map(|at| (at as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0);
                let bump = at.map(|x| (1.0 - (x / radius).powi(2)).max(0.0).powi(2));
                [128, 128, 255, (40.0 * bump[0] * bump[1]).round() as u8]
            };
            let sprite = Sprite::with_levels(SIDE, 1, (0..SIDE * SIDE).map(texel).collect());
            let reach = sprite.density().reach;
            assert!((reach / radius - 1.0).abs() < 0.03, "{radius}: {reach}");
        }
    }

    #[test]
    fn erosion_by_noise_keeps_the_share_that_is_computed() {
        for (name, columns) in [("puff", 4), ("wisp", 4), ("strands", 2)] {
            let layout = SpriteLayout { columns, rows: 2, y_down: false };
            let sprite = Sprite::load(format!("../../sprites/{name}.png").as_ref(), layout).unwrap();
            let noise = NoiseVolume::load("../../sprites/fbm.png".as_ref()).unwrap();
            let SpriteDensity { eroded_fraction, .. } = *sprite.density();
            let alphas: Vec<_> =
                sprite.level_bytes(0).iter().skip(3).step_by(4).map(|a| f32::from(*a) / 255.0).collect();
            let densities: Vec<_> = noise.bytes().iter().skip(3).step_by(4).map(|a| f32::from(*a) / 255.0).collect();
            for erosion in [0.3, 0.6, 0.9] {
                // Any alpha may meet any density.
                let met = alphas.iter().zip(densities.iter().cycle().step_by(7));
                let kept: f32 = met.map(|(alpha, density)| eroded(*alpha, density - 0.5, erosion)).sum();
                let kept = kept / alphas.iter().sum::<f32>();
                let computed = kept_fraction(eroded_fraction, erosion);
                assert!((kept - computed).abs() < 0.03, "{name} at {erosion}: {kept}, computed {computed}");
            }
        }
    }

    #[test]
    fn depth_of_a_sprite_is_exact_for_faint_and_for_opaque_smoke() {
        let alphas = [0, 40, 128, 200, 255, 90, 10, 0, 0];
        let sprite = Sprite::with_levels(3, 1, alphas.map(|alpha| [128, 128, 255, alpha]).to_vec());
        let SpriteDensity { mean_alpha, peak_alpha, .. } = *sprite.density();
        let exact = |amount: f32| {
            let depth = |code: u8| -(1.0 - amount * (f32::from(code) / 255.0).min(0.98)).ln();
            alphas.into_iter().map(depth).sum::<f32>() / 9.0
        };
        for (amount, tolerance) in [(0.01, 0.03), (0.3, 0.1), (0.7, 0.1), (1.0, 1e-3)] {
            let depth = mean_optical_depth(amount, mean_alpha, peak_alpha);
            assert!((depth / exact(amount) - 1.0).abs() < tolerance, "{amount}: {depth}, expected {}", exact(amount));
        }
        let clear = SpriteDensity::new(1, &[[0; 4]]);
        assert!(mean_optical_depth(1.0, clear.mean_alpha, clear.peak_alpha).abs() < 1e-9);
    }
}
