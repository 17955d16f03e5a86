//! `haze ramp` and `haze sprite`; `bake`: pictures from their recipes.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haze::noise::NoiseRecipe;
use haze::picture::{Effort, write_png};
use haze::ramp::bake::RampRecipe;
use haze::ramp::motif::MotifRecipe;
use haze::sprite::bake::SpriteRecipe;
use haze::{Error, FieldError};
use image::DynamicImage;

use super::output::{Failures, Files, say};
use super::progress::watched;
use super::ramp;

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
    /// Write a recipe to begin with.
    New(ramp::new::Arguments),
    /// Write the recipe of a picture, or of another program's gradient.
    Import(ramp::import::Arguments),
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
        /// `*.sprite.json` and `*.noise.json` files.
        #[arg(required = true)]
        recipes: Vec<PathBuf>,
    },
}

pub fn run_ramp(arguments: &RampArguments) -> Result<(), Failures> {
    let recipes = match &arguments.command {
        RampCommand::Bake { recipes } => recipes,
        RampCommand::New(arguments) => return ramp::new::run(arguments).map_err(Failures::from),
        RampCommand::Import(arguments) => return ramp::import::run(arguments).map_err(Failures::from),
        RampCommand::Show(arguments) => return ramp::show::run(arguments).map_err(Failures::from),
        RampCommand::Check(arguments) => return ramp::check::run(arguments),
    };
    let load = |path: &Path, kind: &str| match kind {
        "ramp" => Some(RampRecipe::load(path).map(Recipe::Ramp)),
        "motif" => Some(MotifRecipe::load(path).map(Recipe::Motif)),
        _ => None,
    };
    run(recipes, "a *.ramp.json or *.motif.json file", load)
}

pub fn run_sprite(arguments: &SpriteArguments) -> Result<(), Failures> {
    let SpriteCommand::Bake { recipes } = &arguments.command;
    let load = |path: &Path, kind: &str| match kind {
        "sprite" => Some(SpriteRecipe::load(path).map(Recipe::Sprite)),
        "noise" => Some(NoiseRecipe::load(path).map(Recipe::Noise)),
        _ => None,
    };
    run(recipes, "a *.sprite.json or *.noise.json file", load)
}

enum Recipe {
    Ramp(RampRecipe),
    Motif(MotifRecipe),
    Sprite(SpriteRecipe),
    Noise(NoiseRecipe),
}

impl Recipe {
    /// Extensions of the pictures, in place of the recipe's.
    fn extensions(&self) -> &'static [&'static str] {
        match self {
            Self::Sprite(_) => &["png", "detail.png"],
            _ => &["png"],
        }
    }

    /// As many pictures as extensions.
    fn bake(&self) -> Result<Vec<DynamicImage>, FieldError> {
        Ok(match self {
            Self::Ramp(recipe) => vec![recipe.bake()?],
            Self::Motif(recipe) => vec![recipe.bake()?],
            Self::Noise(recipe) => vec![recipe.bake()?.into()],
            Self::Sprite(recipe) => {
                let baked = recipe.bake()?;
                vec![baked.picture.into(), baked.detail.into()]
            }
        })
    }
}

/// Bakes recipes if all are good. `load` knows kinds: `ramp` of `fire.ramp.json`.
fn run(
    recipes: &[PathBuf],
    expected: &str,
    load: impl Fn(&Path, &str) -> Option<Result<Recipe, Error>>,
) -> Result<(), Failures> {
    let mut files = Files::read(recipes);
    let (jobs, failures) = Failures::of_each(recipes, |path| {
        let refuse = || Error::from(FieldError::new("recipe", path.display(), expected));
        let is_json = path.extension().is_some_and(|extension| extension == "json");
        // `fire.ramp`, of `fire.ramp.json`.
        let name = Path::new(path.file_stem().filter(|_| is_json).unwrap_or_default());
        let kind = name.extension().and_then(OsStr::to_str).unwrap_or_default();
        let recipe = load(path, kind).ok_or_else(refuse)??;
        let output = |extension| path.with_file_name(name.with_extension(extension));
        let outputs: Vec<_> = recipe.extensions().iter().map(output).collect();
        outputs.iter().try_for_each(|output| files.write("output", output, "png"))?;
        Ok((path, recipe, outputs))
    });
    failures.into_result()?;
    for (path, recipe, outputs) in jobs {
        let pictures = watched(format!("haze: baking {}", path.display()), || recipe.bake()).map_err(Error::from)?;
        for (picture, output) in pictures.iter().zip(&outputs) {
            watched(format!("haze: writing {}", output.display()), || write_png(output, picture, Effort::Small))?;
            say!("{}: {}x{}", output.display(), picture.width(), picture.height())?;
        }
    }
    Ok(())
}
