//! Ramps: bakes from gradients and formulas, fits to measured light, import of other programs' gradients, checks.

pub mod bake;
pub mod check;
mod colour;
pub mod fit;
mod formula;
mod ggr;
pub mod gradient;
pub mod import;
pub mod motif;
pub mod response;
pub mod template;
mod text;
