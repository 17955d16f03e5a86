//! `haze export`: looks and images in the forms that engines read.

mod flipbook;
mod material;

use clap::{Args, Subcommand};
use haze_core::error::Error;

#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write the light of a system for an engine: its ramps as textures, and the formula as source code with the preset's
    /// numbers.
    Material(material::Arguments),
    /// Render frames onto sheets for an engine: color with alpha, normals, motion vectors, fire, and six-way light.
    Flipbook(flipbook::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<(), Error> {
    match &arguments.command {
        Command::Material(arguments) => material::run(arguments),
        Command::Flipbook(arguments) => flipbook::run(arguments),
    }
}
