//! Subcommands of the program, one file each under the name of the subcommand.

pub mod export;
pub mod info;
pub mod preset;
pub mod ramp;
pub mod render;
pub mod shade_tree;
pub mod sheet;
pub mod sprite;
pub mod techniques;
