//! `haze ramp`: what an artist does with a ramp besides baking it.

pub mod check;
pub mod fit;
pub mod import;
pub mod new;
pub mod sheet;
pub mod show;
mod strip;
pub mod watch;

use std::path::Path;

use haze::picture::{read_colour_png, write_file};
use haze::{Error, FieldError};
use haze_author::ramp::bake::RampRecipe;
use image::DynamicImage;

use super::output::{Files, has_extension};

/// A ramp's picture: a PNG, or what a recipe bakes, with the recipe.
fn picture_of(path: &Path) -> Result<(DynamicImage, Option<RampRecipe>), Error> {
    if has_extension(path, "json") {
        let recipe = RampRecipe::load(path)?;
        return Ok((recipe.bake()?, Some(recipe)));
    }
    refuse_gradient(path)?;
    Ok((read_colour_png(path)?, None))
}

/// Says what to do with another program's gradient.
fn refuse_gradient(path: &Path) -> Result<(), FieldError> {
    if ["ggr", "tres", "txt"].iter().any(|ending| has_extension(path, ending)) {
        let expected = "a PNG or a *.ramp.json file: `haze ramp import` makes one of another program's gradient";
        return Err(FieldError::new("ramp", path.display(), expected));
    }
    Ok(())
}

/// Whether a file is a ramp's recipe, by its name.
fn is_recipe(path: &Path) -> bool {
    has_extension(path, "json") && has_extension(Path::new(path.file_stem().unwrap_or_default()), "ramp")
}

/// Refuses a name that recipes do not have, and a file that cannot be written.
fn check_output(files: &mut Files, output: &Path) -> Result<(), Error> {
    if !is_recipe(output) {
        return Err(FieldError::new("--output", output.display(), "a name that ends in .ramp.json").into());
    }
    files.write("--output", output, "json")
}

fn write_recipe(output: &Path, recipe: &RampRecipe) -> Result<(), Error> {
    write_file(output, recipe.to_text().as_bytes())
}
