//! What the readers of other programs' gradients share.

use glam::{Vec3, Vec4};

use super::bake::{Blend, RampRecipe, RampRow, RampStop};
use super::colour::srgb_from_linear;
use super::fit::Fit;

/// What is wrong with a line, from 1 on, and what would be right.
pub struct Mistake {
    pub line: usize,
    pub reason: String,
}

/// The recipe of a strip. Stops of other programs are as good as their rounding.
pub fn strip(blend: Blend, stops: Vec<RampStop>) -> Fit {
    let rows = vec![RampRow { stops, ..RampRow::default() }];
    Fit { recipe: RampRecipe { blend, rows, ..RampRecipe::default() }, error: 0.5 }
}

/// Code over black: as much less light as is transparent.
pub fn opaque(code: Vec4) -> Vec3 {
    let code = code.clamp(Vec4::ZERO, Vec4::ONE);
    if code.w >= 1.0 {
        return code.truncate();
    }
    (Blend::Srgb.linear(code.truncate()) * code.w).map(srgb_from_linear)
}

/// Finite numbers with commas or white space between them.
pub fn numbers(text: &str) -> Option<Vec<f32>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok().filter(|number: &f32| number.is_finite())).collect()
}
