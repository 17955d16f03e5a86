//! Sprites: bakes from metaballs, detail maps, six-way light maps, import, sheets of other tools, and checks.

pub mod bake;
pub mod detail;
mod height;
pub mod import_sprite;
pub mod lint;
mod opacity;
pub mod read;
pub mod six_way;
pub mod y_direction;
