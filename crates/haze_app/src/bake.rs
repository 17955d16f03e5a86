//! Arguments and dispatch of `haze ramp` and `haze sprite`, and their subcommand `bake`, which makes images from
//! recipes.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::output::{Failures, Files};
use super::recipe::{Job, Kinds, RAMPS, SPRITES};
use super::{ramp, sprite};

#[derive(Args)]
pub struct RampArguments {
    #[command(subcommand)]
    command: RampCommand,
}

#[derive(Subcommand)]
enum RampCommand {
    /// Bake every recipe to a PNG beside it.
    Bake {
        /// `*.ramp.json` and `*.motif.json` files.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
    },
    /// Bake recipes again whenever they are saved, until Ctrl-C.
    Watch(ramp::watch::Arguments),
    /// Write a new recipe from a template, or a blank ramp to paint over.
    New(ramp::new::Arguments),
    /// Convert a PNG, or another program's gradient, to a recipe.
    Import(ramp::import::Arguments),
    /// Path-trace a puff of steam, ash, … under a ring of lights, and write ramps that are fitted to its brightness.
    Fit(ramp::fit::Arguments),
    /// Render a preset with every ramp of a folder, on one labelled sheet. Ramps that cannot be read are reported and
    /// left out; the command then exits with 1.
    Sheet(ramp::sheet::Arguments),
    /// Show a ramp and its luminance curve in the terminal, or write them as an image.
    Show(ramp::show::Arguments),
    /// Report visible flaws: banding, steps, seams, specular ramps that do not end in black, wrong colour spaces. Exits
    /// with 1 if there are any.
    Check(ramp::check::Arguments),
}

#[derive(Args)]
pub struct SpriteArguments {
    #[command(subcommand)]
    command: SpriteCommand,
}

#[derive(Subcommand)]
enum SpriteCommand {
    /// Bake every recipe to PNGs beside it: NAME.png, and for a sprite also NAME.detail.png with its depth and motion.
    Bake {
        /// `*.sprite.json` and `*.noise.json` files; with --six-way also names of built-in sprites.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
        #[command(flatten)]
        six_way: sprite::six_way::Arguments,
    },
    /// Report visible flaws: colours instead of normals, normals of wrong length, green that points down, opaque
    /// borders, premultiplied normals, a seam in the loop. Exits with 1 if there are any.
    Check(sprite::check::Arguments),
    /// Path-trace a sprite as a puff of steam, ash, … under a ring of lights, and write the result as one sheet.
    Light(sprite::light::Arguments),
    /// Write six-way maps as the two light maps that other tools use.
    Export(sprite::export::Arguments),
    /// Make a sprite from painted normals, heights, alpha or six-way light maps, given as one sheet or as numbered
    /// frames.
    Import(sprite::import::Arguments),
}

pub fn run_ramp(arguments: &RampArguments) -> Result<(), Failures> {
    match &arguments.command {
        RampCommand::Bake { recipes } => run(recipes, &RAMPS),
        RampCommand::Watch(arguments) => ramp::watch::run(arguments),
        RampCommand::New(arguments) => ramp::new::run(arguments).map_err(Failures::from),
        RampCommand::Fit(arguments) => ramp::fit::run(arguments).map_err(Failures::from),
        RampCommand::Import(arguments) => ramp::import::run(arguments).map_err(Failures::from),
        RampCommand::Sheet(arguments) => ramp::sheet::run(arguments),
        RampCommand::Show(arguments) => ramp::show::run(arguments).map_err(Failures::from),
        RampCommand::Check(arguments) => ramp::check::run(arguments),
    }
}

pub fn run_sprite(arguments: &SpriteArguments) -> Result<(), Failures> {
    match &arguments.command {
        SpriteCommand::Bake { recipes, six_way } => {
            six_way.check(recipes)?;
            run(&six_way.files(recipes), &SPRITES)?;
            six_way.run(recipes).map_err(Failures::from)
        }
        SpriteCommand::Export(arguments) => sprite::export::run(arguments).map_err(Failures::from),
        SpriteCommand::Check(arguments) => sprite::check::run(arguments),
        SpriteCommand::Light(arguments) => sprite::light::run(arguments).map_err(Failures::from),
        SpriteCommand::Import(arguments) => sprite::import::run(arguments).map_err(Failures::from),
    }
}

/// Bakes all recipes if every one of them is valid.
fn run(recipes: &[PathBuf], kinds: &Kinds) -> Result<(), Failures> {
    let mut files = Files::read(recipes);
    let (jobs, failures) = Failures::of_each(recipes, |path| Job::load(path, kinds, &mut files));
    failures.into_result()?;
    jobs.iter().try_for_each(Job::bake).map_err(Failures::from)
}
