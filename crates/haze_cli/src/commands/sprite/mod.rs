//! `haze sprite`: arguments and dispatch of its subcommands.

mod bake;
mod check;
mod export;
mod import;
mod light;
mod read;
mod recording_output;
mod simulate;
mod six_way;
mod volumes;

use clap::{Args, Subcommand};

use haze_export::output::Failures;

#[derive(Args)]
pub struct SpriteArguments {
    #[command(subcommand)]
    command: SpriteCommand,
}

#[derive(Subcommand)]
enum SpriteCommand {
    /// Bake every recipe to PNGs beside it: NAME.png, and for a sprite also NAME.detail.png with its depth and motion. Or
    /// the smoke of VDB files, also to NAME.heat.png if it is hot.
    Bake(bake::Arguments),
    /// Simulate smoke and fire, and bake the frames to NAME.png, NAME.detail.png and, if it burns, NAME.heat.png. Takes
    /// minutes.
    Simulate(simulate::Arguments),
    /// Report visible flaws: colors instead of normals, normals of wrong length, green that points down, opaque
    /// borders, premultiplied normals, a seam in the loop. Exits with 1 if there are any.
    Check(check::Arguments),
    /// Path-trace a sprite as a puff of steam, ash, … under a ring of lights, and write the result as one sheet.
    Light(light::Arguments),
    /// Write six-way maps as the two light maps that other tools use.
    Export(export::Arguments),
    /// Make a sprite from painted normals, heights, alpha or six-way light maps, given as one sheet or as numbered
    /// frames.
    Import(import::Arguments),
    /// Make a sprite from sheets of any origin: finds grid, contents, codes, sides and directions, says how sure each answer
    /// is, and mends what is missing.
    Read(read::Arguments),
}

pub fn run(arguments: &SpriteArguments) -> Result<(), Failures> {
    match &arguments.command {
        SpriteCommand::Bake(arguments) => bake::run(arguments),
        SpriteCommand::Simulate(arguments) => simulate::run(arguments),
        SpriteCommand::Export(arguments) => export::run(arguments).map_err(Failures::from),
        SpriteCommand::Check(arguments) => check::run(arguments),
        SpriteCommand::Light(arguments) => light::run(arguments).map_err(Failures::from),
        SpriteCommand::Import(arguments) => import::run(arguments).map_err(Failures::from),
        SpriteCommand::Read(arguments) => read::run(arguments).map_err(Failures::from),
    }
}
