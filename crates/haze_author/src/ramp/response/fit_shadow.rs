//! Fits a shadow ramp to the path-traced light of many puffs.

use glam::{Vec2, Vec3};
use haze_core::formula::color::luminance;

use super::fit_ramps::{BRIGHTNESS, STEPS, STIFFNESS, recipe};
use super::normal_equations::{NormalEquations, knots};
use crate::ramp::ramp_recipe::RampRecipe;

/// Number of free parameters of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowShape {
    /// Number of stops per row, at least 2: from no smoke in front of the light to endless smoke.
    pub stops: u32,
    /// Number of rows: from a light on the viewer's side to a light behind the smoke.
    pub rows: u32,
}

impl Default for ShadowShape {
    fn default() -> Self {
        Self { stops: 9, rows: 5 }
    }
}

/// Smoke under one light, pixel by pixel: as drawn without shadow, and as it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadedLight {
    /// Light of the smoke without shadow, as bright as it should be where no smoke is in front of the light.
    pub unshaded: Vec<Vec3>,
    /// Lookup positions in the shadow ramp.
    pub positions: Vec<Vec2>,
    /// Path-traced light.
    pub truth: Vec<Vec3>,
}

/// Weight of white in the first column, relative to the mean diagonal of the normal equations.
const FULL_LIGHT: f64 = 100.0;

/// Fits a ramp by least squares. Each light is weighted by its inverse brightness, so relative errors of dark and bright
/// lights count alike. Returns the ramp, and its value in full light relative to its brightest: smoke of a bright medium is
/// brighter among other smoke than alone.
pub fn fit_shadow_ramp(lights: &[ShadedLight], shape: ShadowShape) -> (RampRecipe, f32) {
    let stops = shape.stops.max(2) as usize;
    let rows = shape.rows.max(1) as usize;
    let position = |row: usize, stop: usize| row * stops + stop;
    // The smoke's own color multiplies the ramp, so the channels have matrices of their own.
    let channels = [0, 1, 2].map(|channel| {
        let mut equations = NormalEquations::new(rows * stops);
        for light in lights {
            let count = light.truth.len().max(1) as f32;
            let whole: Vec3 = light.truth.iter().sum::<Vec3>() / count;
            let weight = 1.0 / luminance(whole).powi(2).max(1.0e-12);
            let mut sums = vec![0.0; rows * stops];
            for ((unshaded, at), truth) in light.unshaded.iter().zip(&light.positions).zip(&light.truth) {
                let mut terms = Vec::with_capacity(4);
                for (row, of_row) in knots(at.y, rows) {
                    for (stop, of_stop) in knots(at.x, stops) {
                        terms.push((position(row, stop), of_row * of_stop * unshaded[channel]));
                    }
                }
                equations.add(&terms, Vec3::splat(truth[channel]), weight / count);
                terms.iter().for_each(|&(position, fraction)| sums[position] += fraction / count);
            }
            let sums: Vec<_> = sums.into_iter().enumerate().collect();
            equations.add(&sums, Vec3::splat(whole[channel]), BRIGHTNESS * weight);
        }
        let square = equations.mean_square();
        for row in 0..rows {
            equations.add(&[(position(row, 0), 1.0)], Vec3::ONE, (square * FULL_LIGHT) as f32);
        }
        equations.smooth(0, stops, rows, (square * STIFFNESS) as f32);
        equations.solve(STEPS)
    });
    let [red, green, blue] = channels;
    let values = red.iter().zip(&green).zip(&blue).map(|((r, g), b)| Vec3::new(r.x, g.x, b.x));
    let values: Vec<_> = values.collect();
    let brightest = values.iter().map(|value| value.max_element()).fold(1.0, f32::max);
    (recipe(&values, stops, brightest), 1.0 / brightest)
}
