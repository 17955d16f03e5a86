//! Ramps: bakes from gradients and formulas, fits to measured light, import of other programs' gradients, checks.

mod blend_space;
mod color_tables;
mod css;
pub mod export_gradient;
pub mod fit_stops;
mod gimp;
mod godot;
pub mod gradient;
mod gradient_text;
mod grd;
pub mod import_gradient;
pub mod lint;
pub mod motif;
mod paint;
mod photoshop_descriptor;
mod place_formula;
mod ramp_recipe;
pub mod response;
mod source_gradient;
mod svg;
pub mod template;

pub use ramp_recipe::{Blend, Curve, Gradient, HexColor, RECIPE_VERSION, RampRecipe, RampRow, RampStop};
