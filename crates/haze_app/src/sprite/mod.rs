//! `haze sprite`: what an artist does with a sprite besides baking it.

pub mod check;
pub mod export;
pub mod import;
pub mod light;
pub mod six_way;
