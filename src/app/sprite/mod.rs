//! `haze sprite`: what an artist does with a sprite besides baking it.

pub mod check;
pub mod import;
pub mod light;
