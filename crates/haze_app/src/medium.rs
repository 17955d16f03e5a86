//! What smoke is made of, and how finely it is path-traced, on the command line.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use clap::Args;
use clap::builder::PossibleValuesParser;
use glam::Vec3;
use haze::settings::validate;
use haze::{Error, FieldError, builtin};
use haze_author::path_trace::{MEDIA, Medium, PathTrace};
use haze_author::sprite::bake::SpriteRecipe;

use super::output::has_extension;
use super::progress::watched_as;

#[derive(Args)]
pub struct MediumArguments {
    /// What the smoke is made of.
    #[arg(long, value_parser = names(), default_value = "ash")]
    medium: String,
    #[command(flatten)]
    numbers: MediumNumbers,
}

/// What a medium is made of, number by number.
#[derive(Args)]
pub struct MediumNumbers {
    /// In place of the medium's: the share of light that is scattered, 0 to 1; one number, or red, green and blue with commas.
    #[arg(long, value_name = "SHARE", value_delimiter = ',', allow_hyphen_values = true)]
    albedo: Vec<f32>,
    /// In place of the medium's: mean cosine of the angle that light is scattered by, -0.95 back to 0.95 onwards.
    #[arg(long, value_name = "COSINE", allow_hyphen_values = true)]
    g: Option<f32>,
    /// In place of the medium's: extinction in the middle of the puff, for each half side of it, 0.1 to 100.
    #[arg(long, value_name = "EXTINCTION", allow_hyphen_values = true)]
    density: Option<f32>,
}

/// The names that media have.
pub fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(MEDIA.iter().map(|named| named.name))
}

/// The medium of a name.
pub fn named(name: &str) -> Medium {
    MEDIA.iter().find(|named| named.name == name).map_or(MEDIA[0].medium, |named| named.medium)
}

impl MediumNumbers {
    /// The name of the first that is given.
    pub fn given(&self) -> Option<&'static str> {
        let given =
            [("--albedo", !self.albedo.is_empty()), ("--g", self.g.is_some()), ("--density", self.density.is_some())];
        given.into_iter().find_map(|(name, is_given)| is_given.then_some(name))
    }

    /// The medium of a name with these in place of its own.
    ///
    /// # Errors
    /// Names the number that is out of range.
    pub fn of(&self, name: &str) -> Result<Medium, FieldError> {
        let mut medium = named(name);
        medium.albedo = match self.albedo[..] {
            [] => medium.albedo,
            [all] => Vec3::splat(all),
            [r, g, b] => Vec3::new(r, g, b),
            _ => {
                let given = format!("{} numbers", self.albedo.len());
                return Err(FieldError::new("--albedo", given, "one, or red, green and blue"));
            }
        };
        medium.g = self.g.unwrap_or(medium.g);
        medium.density = self.density.unwrap_or(medium.density);
        let of_option = |error: FieldError| FieldError { field: format!("--{}", error.field), ..error };
        validate(&medium, String::new).map_err(of_option)?;
        Ok(medium)
    }

    /// The medium's name, where nothing of it was changed.
    pub fn name_of<'a>(&self, name: &'a str) -> &'a str {
        if self.given().is_none() { name } else { "medium" }
    }
}

impl MediumArguments {
    /// # Errors
    /// As [`MediumNumbers::of`].
    pub fn medium(&self) -> Result<Medium, FieldError> {
        self.numbers.of(&self.medium)
    }

    /// As [`MediumNumbers::name_of`].
    pub fn name(&self) -> &str {
        self.numbers.name_of(&self.medium)
    }
}

#[derive(Args)]
pub struct PathTraceArguments {
    /// Pixels along a side of the puff.
    #[arg(long, value_parser = clap::value_parser!(u32).range(8..=256), default_value_t = Self::default().size)]
    size: u32,
    /// Paths for each pixel.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=65536), default_value_t = Self::default().samples)]
    samples: u32,
    /// Of the noise.
    #[arg(long, default_value_t = Self::default().seed)]
    seed: u32,
}

/// A few seconds of work.
impl Default for PathTraceArguments {
    fn default() -> Self {
        Self { size: 48, samples: 64, seed: 1 }
    }
}

impl PathTraceArguments {
    pub fn path_trace(&self) -> PathTrace {
        PathTrace { size: self.size, samples: self.samples, seed: self.seed }
    }

    /// Does the work, and says how much of it is done.
    pub fn watched<T>(&self, what: &str, work: impl FnOnce(&dyn Fn(u32) -> Result<(), Error>) -> T) -> T {
        let done = AtomicU32::new(0);
        let line = || format!("haze: tracing {what}, path {} of {}", done.load(Ordering::Relaxed) + 1, self.samples);
        watched_as(line, || {
            work(&|sample| {
                done.store(sample, Ordering::Relaxed);
                Ok(())
            })
        })
    }
}

/// A sprite's recipe: a file, or a built-in one by its name.
///
/// # Errors
/// As [`SpriteRecipe::load`]; for a name that is neither.
pub fn sprite_recipe(name: &Path) -> Result<SpriteRecipe, Error> {
    if has_extension(name, "json") {
        return SpriteRecipe::load(name);
    }
    let builtin = name.to_str().and_then(|name| builtin::find(builtin::SPRITES, name));
    let names: Vec<_> = builtin::SPRITES.iter().map(|sprite| sprite.name).collect();
    let expected = || format!("a *.sprite.json file, or one of {}", names.join(", "));
    SpriteRecipe::of_builtin(builtin.ok_or_else(|| FieldError::new("--sprite", name.display(), expected()))?)
}

/// The sprite that is traced if none is named.
pub fn usual_sprite() -> PathBuf {
    "billow".into()
}
