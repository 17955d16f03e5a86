//! Subcommands of the program, one file each under the name of the subcommand.

pub mod debug_views;
pub mod export;
pub mod info;
pub mod preset;
pub mod ramp;
pub mod render;
pub mod sheet;
pub mod sprite;
pub mod techniques;
