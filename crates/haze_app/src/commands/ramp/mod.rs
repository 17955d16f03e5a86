//! `haze ramp`: arguments and dispatch of its subcommands, and what they share.

mod bake;
mod check;
mod fit;
mod import;
mod new;
mod ramp_image;
mod sheet;
mod show;
mod watch;

use std::path::Path;

use clap::{Args, Subcommand};
use haze::image::{read_colour_png, write_file};
use haze::{Error, FieldError};
use haze_author::ramp::RampRecipe;
use image::DynamicImage;

use crate::output::{Failures, FileChecks, has_extension};

#[derive(Args)]
pub struct RampArguments {
    #[command(subcommand)]
    command: RampCommand,
}

#[derive(Subcommand)]
enum RampCommand {
    /// Bake every recipe to a PNG beside it.
    Bake(bake::Arguments),
    /// Bake recipes again whenever they are saved, until Ctrl-C.
    Watch(watch::Arguments),
    /// Write a new recipe from a template, or a blank ramp to paint over.
    New(new::Arguments),
    /// Convert a PNG, or another program's gradient, to a recipe.
    Import(import::Arguments),
    /// Path-trace a puff of steam, ash, … under a ring of lights, and write ramps that are fitted to its brightness.
    Fit(fit::Arguments),
    /// Render a preset with every ramp of a folder, on one labelled sheet. Ramps that cannot be read are reported and
    /// left out; the command then exits with 1.
    Sheet(sheet::Arguments),
    /// Show a ramp and its luminance curve in the terminal, or write them as an image.
    Show(show::Arguments),
    /// Report visible flaws: banding, steps, seams, specular ramps that do not end in black, wrong colour spaces. Exits
    /// with 1 if there are any.
    Check(check::Arguments),
}

pub fn run(arguments: &RampArguments) -> Result<(), Failures> {
    match &arguments.command {
        RampCommand::Bake(arguments) => bake::run(arguments),
        RampCommand::Watch(arguments) => watch::run(arguments),
        RampCommand::New(arguments) => new::run(arguments).map_err(Failures::from),
        RampCommand::Fit(arguments) => fit::run(arguments).map_err(Failures::from),
        RampCommand::Import(arguments) => import::run(arguments).map_err(Failures::from),
        RampCommand::Sheet(arguments) => sheet::run(arguments),
        RampCommand::Show(arguments) => show::run(arguments).map_err(Failures::from),
        RampCommand::Check(arguments) => check::run(arguments),
    }
}

/// Loads the image of a ramp: a PNG, or a recipe, which is baked and returned as well.
fn load_ramp_image(path: &Path) -> Result<(DynamicImage, Option<RampRecipe>), Error> {
    if has_extension(path, "json") {
        let recipe = RampRecipe::load(path)?;
        return Ok((recipe.bake()?, Some(recipe)));
    }
    refuse_gradient(path)?;
    Ok((read_colour_png(path)?, None))
}

/// Refuses another program's gradient, and names the command that converts it.
fn refuse_gradient(path: &Path) -> Result<(), FieldError> {
    if ["ggr", "tres", "txt"].iter().any(|ending| has_extension(path, ending)) {
        let expected = "a PNG or a *.ramp.json file; convert this gradient with `haze ramp import`";
        return Err(FieldError::new("ramp", path.display(), expected));
    }
    Ok(())
}

/// Returns true if a file name is that of a ramp recipe.
fn is_recipe(path: &Path) -> bool {
    has_extension(path, "json") && has_extension(Path::new(path.file_stem().unwrap_or_default()), "ramp")
}

/// Refuses a name that does not end in .ramp.json, and a file that cannot be written.
fn check_recipe_output(files: &mut FileChecks, output: &Path) -> Result<(), Error> {
    if !is_recipe(output) {
        return Err(FieldError::new("--output", output.display(), "a name that ends in .ramp.json").into());
    }
    files.check_output("--output", output, "json")
}

fn write_recipe(output: &Path, recipe: &RampRecipe) -> Result<(), Error> {
    write_file(output, recipe.to_text().as_bytes())
}
