//! `haze ramp` and `haze sprite`; `bake`: pictures from their recipes.

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
    /// Write the PNG beside every recipe.
    Bake {
        /// `*.ramp.json` and `*.motif.json` files.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
    },
    /// Write the PNG beside a recipe whenever it is saved, until Ctrl-C.
    Watch(ramp::watch::Arguments),
    /// Write a recipe to begin with.
    New(ramp::new::Arguments),
    /// Write the recipe of a picture, or of another program's gradient.
    Import(ramp::import::Arguments),
    /// Path-trace a puff of steam, ash, … under a ring of lights, and write the ramps that answer light as it does.
    Fit(ramp::fit::Arguments),
    /// Render a preset under every ramp of a folder, on one labelled sheet. Those that cannot be read are told and left out, and it
    /// exits with 1.
    Sheet(ramp::sheet::Arguments),
    /// Show a ramp in the terminal, with its curve, or as a picture.
    Show(ramp::show::Arguments),
    /// Say what would show: banding, steps, seams, specular ramps that are not black at their ends, colour spaces. Exits with 1
    /// if there is anything.
    Check(ramp::check::Arguments),
}

#[derive(Args)]
pub struct SpriteArguments {
    #[command(subcommand)]
    command: SpriteCommand,
}

#[derive(Subcommand)]
enum SpriteCommand {
    /// Write the PNGs beside every recipe: NAME.png, and NAME.detail.png with a sprite's depth and motion.
    Bake {
        /// `*.sprite.json` and `*.noise.json` files; with --six-way built-in sprites by their names, too.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
        #[command(flatten)]
        six_way: sprite::six_way::Arguments,
    },
    /// Say what would show: colours in place of normals, their length, green that points down, borders, premultiplied normals, the
    /// seam of the loop. Exits with 1 if there is anything.
    Check(sprite::check::Arguments),
    /// Path-trace a sprite as a puff of steam, ash, … under a ring of lights, on one sheet: what it truly looks like.
    Light(sprite::light::Arguments),
    /// Write six-way maps as the two light maps that other tools have.
    Export(sprite::export::Arguments),
    /// Make a sprite of normals painted elsewhere, heights, alpha alone or six-way light maps; of a sheet or of numbered frames.
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

/// Bakes recipes if all are good.
fn run(recipes: &[PathBuf], kinds: &Kinds) -> Result<(), Failures> {
    let mut files = Files::read(recipes);
    let (jobs, failures) = Failures::of_each(recipes, |path| Job::load(path, kinds, &mut files));
    failures.into_result()?;
    jobs.iter().try_for_each(Job::bake).map_err(Failures::from)
}
