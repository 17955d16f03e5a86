//! Shared code of the gradient importers.

use glam::{Vec3, Vec4};

use super::blend_space::srgb_from_linear;
use super::fit_stops::RampFit;
use super::ramp_recipe::{Blend, RampRecipe, RampRow, RampStop};

/// A parse error: the 1-based line, and what is wrong and expected.
pub struct GradientParseError {
    pub line: usize,
    pub reason: String,
}

/// Builds the recipe of a one-row ramp. Its error is that of rounding colors to 8 bits: half a step.
pub fn one_row_fit(blend: Blend, stops: Vec<RampStop>) -> RampFit {
    let rows = vec![RampRow { stops, ..RampRow::default() }];
    RampFit { recipe: RampRecipe { blend, rows, ..RampRecipe::default() }, error: 0.5 }
}

/// Composites an sRGB code over black, in linear light.
pub fn composite_over_black(code: Vec4) -> Vec3 {
    let code = code.clamp(Vec4::ZERO, Vec4::ONE);
    if code.w >= 1.0 {
        return code.truncate();
    }
    (Blend::Srgb.linear(code.truncate()) * code.w).map(srgb_from_linear)
}

/// Parses finite numbers separated by commas or white space; `None` if one is malformed.
pub fn parse_numbers(text: &str) -> Option<Vec<f32>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f32| number.is_finite())).collect()
}
