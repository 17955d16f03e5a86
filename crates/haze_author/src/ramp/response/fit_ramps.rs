//! Fits diffuse ramps to the path-traced light of a puff.

use glam::Vec3;
use haze_core::formula::color::luminance;
use haze_core::formula::lighting::backlight_weight;

use super::normal_equations::{NormalEquations, knots};
use super::traced_puff::{Puff, Texel};
use crate::ramp::blend_space::srgb_from_linear;
use crate::ramp::ramp_recipe::{Blend, Curve, HexColor, RampRecipe, RampRow, RampStop};

/// Number of free parameters of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FitShape {
    /// Number of stops per row, at least 2.
    pub stops: u32,
    /// Number of rows along the amount axis; 1 for a ramp of one axis.
    pub rows: u32,
    /// True to fit a separate ramp for light from behind.
    pub backlight: bool,
}

/// Few enough stops for an artist to edit.
impl Default for FitShape {
    fn default() -> Self {
        Self { stops: 9, rows: 5, backlight: true }
    }
}

/// Fitted ramps, normalised so that the largest channel of all stops is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedRamps {
    /// Ramp for light from the viewer's side, or from all sides without a backlight ramp.
    pub diffuse: RampRecipe,
    /// Ramp for light from behind.
    pub backlight: Option<RampRecipe>,
    /// Factor that makes the smoke as bright as the medium relative to white paper: `diffuse.intensity`.
    pub exposure: f32,
}

/// Weight of a light's mean brightness relative to its pixels.
pub(super) const BRIGHTNESS: f32 = 30.0;
/// Weight of the smoothness term (second difference of stops), relative to the mean diagonal of the normal equations.
/// Stops that no pixel looks up then continue their neighbours.
pub(super) const STIFFNESS: f64 = 0.02;
/// Number of solver iterations. Doubling it changes one stop in ten, by 1 of 255.
pub(super) const STEPS: u32 = 400;

impl Puff {
    /// Fits ramps by least squares over every lookup of the renderer. Each light is weighted by its inverse brightness,
    /// so relative errors of dark and bright sides count alike.
    pub fn fit(&self, shape: FitShape) -> FittedRamps {
        let FitShape { stops, rows, backlight } = shape;
        let stops = stops.max(2) as usize;
        let rows = rows.max(1) as usize;
        let ramps = if backlight { 2 } else { 1 };
        let position = |ramp: usize, row: usize, stop: usize| (ramp * rows + row) * stops + stop;
        let terms = |texel: &Texel, light: Vec3| {
            let at = texel.coordinate(light);
            let against = backlight_weight(light, Vec3::Z);
            let of_ramp = if backlight { [1.0 - against, against] } else { [1.0, 0.0] };
            let mut terms = Vec::with_capacity(8);
            for (ramp, of_ramp) in of_ramp.into_iter().enumerate().take(ramps) {
                for (row, of_row) in knots(at.y, rows) {
                    for (stop, of_stop) in knots(at.x, stops) {
                        terms.push((position(ramp, row, stop), of_ramp * of_row * of_stop * texel.coverage));
                    }
                }
            }
            terms
        };
        let mut equations = NormalEquations::new(ramps * rows * stops);
        let count = self.texels.len().max(1) as f32;
        for (&light, truth) in self.lights.iter().zip(&self.traced.light) {
            let whole: Vec3 = truth.texels.iter().sum();
            let weight = 1.0 / (luminance(whole) / count).powi(2).max(1.0e-12);
            let mut sums = vec![0.0; ramps * rows * stops];
            for texel in &self.texels {
                let terms = terms(texel, light);
                equations.add(&terms, truth.texels[texel.index], weight / count);
                terms.iter().for_each(|&(position, fraction)| sums[position] += fraction / count);
            }
            let sums: Vec<_> = sums.into_iter().enumerate().collect();
            equations.add(&sums, whole / count, BRIGHTNESS * weight);
        }
        let stiffness = (equations.mean_square() * STIFFNESS) as f32;
        (0..ramps).for_each(|ramp| equations.smooth(position(ramp, 0, 0), stops, rows, stiffness));
        let values = equations.solve(STEPS);
        let exposure = values.iter().map(|value| value.max_element()).fold(f32::MIN_POSITIVE, f32::max);
        let recipe = |ramp: usize| recipe(&values[position(ramp, 0, 0)..][..rows * stops], stops, exposure);
        FittedRamps { diffuse: recipe(0), backlight: backlight.then(|| recipe(1)), exposure }
    }
}

/// Converts solved values to a recipe that interpolates linearly in linear light, along rows and between rows.
pub(super) fn recipe(values: &[Vec3], stops: usize, exposure: f32) -> RampRecipe {
    let rows = values.len() / stops;
    let fraction = |index: usize, count: usize| if count > 1 { index as f32 / (count - 1) as f32 } else { 0.0 };
    let stop = |(index, &value): (usize, &Vec3)| {
        let code = (value / exposure).to_array().map(srgb_from_linear);
        let color = HexColor::from_srgb(Vec3::from(code));
        RampStop { curve: Curve::Linear, ..RampStop::new(fraction(index, stops), color) }
    };
    let row = |(index, values): (usize, &[Vec3])| RampRow {
        at: fraction(index, rows),
        curve: Curve::Linear,
        stops: values.iter().enumerate().map(stop).collect(),
    };
    RampRecipe {
        width: 128,
        height: if rows > 1 { 64 } else { 1 },
        blend: Blend::Linear,
        rows: values.chunks(stops).enumerate().map(row).collect(),
        ..RampRecipe::default()
    }
}
