//! `haze sprite`: the subcommands other than `bake`, and the six-way maps of `bake`.

pub mod check;
pub mod export;
pub mod import;
pub mod light;
pub mod six_way;
