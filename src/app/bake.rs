//! `haze ramp bake` and `haze sprite bake`: pictures from their recipes.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haze::noise::NoiseRecipe;
use haze::picture::{Effort, write_png};
use haze::ramp::bake::RampRecipe;
use haze::ramp::motif::MotifRecipe;
use haze::sprite::bake::SpriteRecipe;
use haze::{Error, FieldError};
use image::DynamicImage;

use super::output::{check_target, say};

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
        /// `*.sprite.json` and `*.noise.json` files.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
    },
}

pub fn run_ramp(arguments: &RampArguments) -> Result<(), Error> {
    let RampCommand::Bake { recipes } = &arguments.command;
    for recipe in recipes {
        let picture = if let Some(output) = output_of(recipe, ".ramp.json") {
            (output, RampRecipe::load(recipe)?.bake()?)
        } else if let Some(output) = output_of(recipe, ".motif.json") {
            (output, MotifRecipe::load(recipe)?.bake()?)
        } else {
            let expected = "a *.ramp.json or *.motif.json file";
            return Err(FieldError::new("recipe", recipe.display(), expected).into());
        };
        write(&picture.0, &picture.1)?;
    }
    Ok(())
}

pub fn run_sprite(arguments: &SpriteArguments) -> Result<(), Error> {
    let SpriteCommand::Bake { recipes } = &arguments.command;
    for recipe in recipes {
        if let Some(output) = output_of(recipe, ".sprite.json") {
            let detail = output.with_extension("detail.png");
            check_target(&output)?;
            check_target(&detail)?;
            let baked = SpriteRecipe::load(recipe)?.bake()?;
            write(&output, &baked.picture.into())?;
            write(&detail, &baked.detail.into())?;
        } else if let Some(output) = output_of(recipe, ".noise.json") {
            write(&output, &NoiseRecipe::load(recipe)?.bake()?.into())?;
        } else {
            let expected = "a *.sprite.json or *.noise.json file";
            return Err(FieldError::new("recipe", recipe.display(), expected).into());
        }
    }
    Ok(())
}

fn output_of(recipe: &Path, kind: &str) -> Option<PathBuf> {
    let name = recipe.file_name()?.to_str()?.strip_suffix(kind).filter(|name| !name.is_empty())?;
    Some(recipe.with_file_name(format!("{name}.png")))
}

fn write(output: &Path, picture: &DynamicImage) -> Result<(), Error> {
    check_target(output)?;
    write_png(output, picture, Effort::Small)?;
    say!("{}: {}x{}", output.display(), picture.width(), picture.height())
}
