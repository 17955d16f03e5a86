//! Recipes, and the images that are baked from them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use clap::Args;
use haze::FieldError;
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::error::Error;
use haze_preset::{is_baked_png, write_baked_png};
use image::DynamicImage;

use haze_export::output::{Failures, FileChecks, print_line};
use haze_export::progress::{with_changing_progress, with_progress};
use haze_export::recipe_files::recipe_stem;

/// Kinds of recipes that a command takes.
pub struct RecipeKinds {
    /// Valid file names, for messages.
    expected: &'static str,
    /// Loader by kind, which is `ramp` for `fire.ramp.json`.
    load: fn(&str) -> Option<Load>,
}

type Load = fn(&Path) -> Result<Recipe, Error>;

pub const RAMPS: RecipeKinds = RecipeKinds {
    expected: "a *.ramp.json or *.motif.json file",
    load: |kind| match kind {
        "ramp" => Some(|path| Ok(Recipe::Ramp(RampRecipe::load(path)?))),
        "motif" => Some(|path| Ok(Recipe::Motif(MotifRecipe::load(path)?))),
        _ => None,
    },
};

pub const SPRITES: RecipeKinds = RecipeKinds {
    expected: "a *.sprite.json or *.noise.json file; `haze sprite simulate` takes *.sim.json",
    load: |kind| match kind {
        "sprite" => Some(|path| Ok(Recipe::Sprite(SpriteRecipe::load(path)?))),
        "noise" => Some(|path| Ok(Recipe::Noise(NoiseRecipe::load(path)?))),
        _ => None,
    },
};

impl RecipeKinds {
    /// Returns the loader for a file name.
    ///
    /// # Errors
    /// If the name is of none of these kinds.
    pub fn find(&self, path: &Path) -> Result<Load, Error> {
        let is_json = path.extension().is_some_and(|extension| extension == "json");
        let kind = recipe_stem(path).extension().filter(|_| is_json).and_then(OsStr::to_str);
        let refuse = || FieldError::new("recipe", path.display(), self.expected).into();
        kind.and_then(self.load).ok_or_else(refuse)
    }
}

pub enum Recipe {
    Ramp(RampRecipe),
    Motif(MotifRecipe),
    Sprite(SpriteRecipe),
    Noise(NoiseRecipe),
}

impl Recipe {
    /// Extensions of the images, instead of the recipe's `KIND.json`.
    fn extensions(&self) -> &'static [&'static str] {
        match self {
            Self::Sprite(_) => &["png", "detail.png"],
            _ => &["png"],
        }
    }

    /// Number of frames that are baked one by one.
    fn frame_count(&self) -> u32 {
        if let Self::Sprite(recipe) = self { recipe.frame_count() } else { 1 }
    }

    /// Bakes one image per extension. `progress` gets the number of finished frames.
    fn bake(&self, progress: impl Fn(u32)) -> Result<Vec<DynamicImage>, FieldError> {
        Ok(match self {
            Self::Ramp(recipe) => vec![recipe.bake()?],
            Self::Motif(recipe) => vec![recipe.bake()?],
            Self::Noise(recipe) => vec![recipe.bake()?.into()],
            Self::Sprite(recipe) => {
                let baked = recipe.bake(|frames| {
                    progress(frames);
                    Ok::<_, FieldError>(())
                })?;
                vec![baked.image.into(), baked.detail.into()]
            }
        })
    }
}

/// Treatment of a PNG beside a recipe that no bake has written, or that was changed since.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaintedPng {
    Keep,
    Replace,
}

/// Option of the commands that bake.
#[derive(Args)]
pub struct OverwriteArguments {
    /// Also replace PNGs that were painted: that no bake has written, or that were changed since.
    #[arg(long)]
    overwrite: bool,
}

impl OverwriteArguments {
    pub fn painted_png(&self) -> PaintedPng {
        if self.overwrite { PaintedPng::Replace } else { PaintedPng::Keep }
    }
}

/// Refuses to replace a PNG that was painted.
///
/// # Errors
/// Names the PNG and the ways to replace it.
pub fn check_not_painted(image: &Path, painted: PaintedPng) -> Result<(), Error> {
    if painted == PaintedPng::Replace || !image.exists() || is_baked_png(image) {
        return Ok(());
    }
    let problem = format!("{} was painted, or changed after it was baked, and is kept", image.display());
    let expected = "no such PNG, a recipe of another name, or `bake --overwrite`";
    Err(FieldError::from_problem("output", problem, expected).into())
}

/// A valid recipe, with the files that its images go to.
pub struct BakeJob<'a> {
    path: &'a Path,
    recipe: Recipe,
    outputs: Vec<PathBuf>,
    painted: PaintedPng,
}

impl<'a> BakeJob<'a> {
    pub fn load(
        path: &'a Path,
        kinds: &RecipeKinds,
        files: &mut FileChecks,
        painted: PaintedPng,
    ) -> Result<Self, Error> {
        let recipe = kinds.find(path)?(path)?;
        let output = |extension| path.with_file_name(recipe_stem(path).with_extension(extension));
        let outputs: Vec<_> = recipe.extensions().iter().map(output).collect();
        for output in &outputs {
            files.check_output("output", output, "png")?;
            check_not_painted(output, painted)?;
        }
        Ok(Self { path, recipe, outputs, painted })
    }

    /// Writes the images, and prints a line for each.
    pub fn bake(&self) -> Result<(), Error> {
        let path = self.path.display();
        let done = AtomicU32::new(0);
        let count = self.recipe.frame_count();
        let what = || match count {
            1 => format!("haze: baking {path}"),
            _ => format!("haze: baking {path}, frame {} of {count}", done.load(Ordering::Relaxed) + 1),
        };
        let images = with_changing_progress(what, || self.recipe.bake(|frames| done.store(frames, Ordering::Relaxed)))?;
        // A PNG may have been painted during a long bake.
        self.outputs.iter().try_for_each(|output| check_not_painted(output, self.painted))?;
        for (image, output) in images.iter().zip(&self.outputs) {
            with_progress(format!("haze: writing {}", output.display()), || write_baked_png(output, image))?;
            print_line!("{}: {}x{}", output.display(), image.width(), image.height())?;
        }
        Ok(())
    }
}

/// Bakes all recipes if every recipe is valid.
pub fn bake_all(recipes: &[PathBuf], kinds: &RecipeKinds, painted: PaintedPng) -> Result<(), Failures> {
    let mut files = FileChecks::for_inputs(recipes);
    let (jobs, failures) = Failures::of_each(recipes, |path| BakeJob::load(path, kinds, &mut files, painted));
    failures.into_result()?;
    jobs.iter().try_for_each(BakeJob::bake).map_err(Failures::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recipe_kind_is_baked_by_one_command() {
        for recipe in haze_export::recipe_files::recipe_paths(Path::new("a/fire.png")) {
            let is_known = [&RAMPS, &SPRITES].map(|kinds| kinds.find(&recipe).is_ok());
            // `haze sprite simulate` bakes those.
            let is_simulation = recipe.ends_with("fire.sim.json");
            assert!(is_known.contains(&true) != is_simulation, "{}", recipe.display());
        }
    }
}
