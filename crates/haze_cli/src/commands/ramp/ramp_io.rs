//! Reads and writes ramps and their recipes, for all ramp commands.

use std::path::Path;

use haze::FieldError;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::import_gradient::GRADIENT_ENDINGS;
use haze_core::assets::image::read_color_png;
use haze_core::error::Error;
use haze_preset::write_file;
use image::DynamicImage;

use haze_export::output::FileChecks;
use haze_export::recipe_files::has_extension;

/// Loads the image of a ramp: a PNG, or a recipe, which is baked and returned as well.
pub fn load_ramp_image(path: &Path) -> Result<(DynamicImage, Option<RampRecipe>), Error> {
    if has_extension(path, "json") {
        let recipe = RampRecipe::load(path)?;
        return Ok((recipe.bake()?, Some(recipe)));
    }
    refuse_gradient(path)?;
    Ok((read_color_png(path)?, None))
}

/// Refuses another program's gradient, and names the command that converts it.
pub fn refuse_gradient(path: &Path) -> Result<(), FieldError> {
    if GRADIENT_ENDINGS.iter().any(|ending| has_extension(path, ending)) {
        let problem = format!("{} is a gradient of another program", path.display());
        let expected = "a PNG or a *.ramp.json file; `haze ramp import` converts the gradient";
        return Err(FieldError::from_problem("ramp", problem, expected));
    }
    Ok(())
}

/// Returns true if a file name is that of a ramp recipe.
pub fn is_recipe(path: &Path) -> bool {
    has_extension(path, "json") && has_extension(Path::new(path.file_stem().unwrap_or_default()), "ramp")
}

/// Refuses a name that does not end in .ramp.json, and a file that cannot be written.
pub fn check_recipe_output(files: &mut FileChecks, output: &Path) -> Result<(), Error> {
    if !is_recipe(output) {
        return Err(FieldError::new("--output", output.display(), "a name that ends in .ramp.json").into());
    }
    files.check_output("--output", output, "json")
}

/// Writes a recipe as JSON.
pub fn write_recipe(output: &Path, recipe: &RampRecipe) -> Result<(), Error> {
    Ok(write_file(output, recipe.to_json().as_bytes())?)
}
