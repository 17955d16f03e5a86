//! Sprites: bakes from metaballs, detail maps, six-way light maps, import and checks.

pub mod bake;
pub mod detail;
mod height;
pub mod import_sprite;
pub mod lint;
mod opacity;
pub mod six_way;
pub mod y_direction;
