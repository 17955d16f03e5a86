//! Options for the medium that smoke is made of, and for the quality of its path tracing.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use clap::Args;
use clap::builder::PossibleValuesParser;
use glam::Vec3;
use haze::FieldError;
use haze_author::path_trace::{MEDIA, Medium, PathTrace};
use haze_core::error::Error;

use haze_export::options::{number, parse_seed, whole_number};
use haze_export::progress::with_changing_progress;
use haze_export::sprite_by_name::default_sprite;

#[derive(Args)]
pub struct MediumArguments {
    /// Medium that the smoke is made of.
    #[arg(long, value_parser = medium_names(), default_value = "ash")]
    medium: String,
    #[command(flatten)]
    numbers: MediumNumbers,
}

/// Single parameters of a medium.
#[derive(Args)]
pub struct MediumNumbers {
    /// Fraction of light that is scattered, 0 to 1, instead of the medium's; one number, or red, green and blue separated
    /// by commas.
    #[arg(long, value_name = "FRACTION", value_delimiter = ',', allow_hyphen_values = true)]
    #[arg(value_parser = number(Medium::ALBEDO_RANGE))]
    albedo: Vec<f32>,
    /// Mean cosine of the scattering angle, -0.95 (backward) to 0.95 (forward), instead of the medium's.
    #[arg(long, value_name = "COSINE", allow_hyphen_values = true, value_parser = number(Medium::ANISOTROPY_RANGE))]
    g: Option<f32>,
    /// Extinction in the middle of the puff, per half side of it, 0.1 to 100, instead of the medium's.
    #[arg(long, value_name = "EXTINCTION", allow_hyphen_values = true, value_parser = number(Medium::DENSITY_RANGE))]
    density: Option<f32>,
}

/// Medium and sprite of path-traced puffs, and the quality of the path trace.
#[derive(Args)]
pub struct PuffArguments {
    #[command(flatten)]
    pub medium: MediumArguments,
    /// Sprite that shapes the smoke: a `*.sprite.json` file, or the name of a built-in sprite.
    #[arg(long, default_value_os_t = default_sprite())]
    pub sprite: PathBuf,
    #[command(flatten)]
    pub quality: PathTraceArguments,
}

/// Parser of the names of media.
pub fn medium_names() -> PossibleValuesParser {
    PossibleValuesParser::new(MEDIA.iter().map(|named| named.name))
}

/// Returns the medium of this name.
pub fn medium_by_name(name: &str) -> Medium {
    MEDIA.iter().find(|named| named.name == name).map_or(MEDIA[0].medium, |named| named.medium)
}

impl MediumNumbers {
    /// Returns the first option that is given.
    pub fn first_given(&self) -> Option<&'static str> {
        let given =
            [("--albedo", !self.albedo.is_empty()), ("--g", self.g.is_some()), ("--density", self.density.is_some())];
        given.into_iter().find_map(|(name, is_given)| is_given.then_some(name))
    }

    /// Returns the medium of this name with the given numbers instead of its own.
    ///
    /// # Errors
    /// If --albedo has neither one number nor three.
    pub fn medium_of(&self, name: &str) -> Result<Medium, FieldError> {
        let mut medium = medium_by_name(name);
        medium.albedo = match self.albedo[..] {
            [] => medium.albedo,
            [all] => Vec3::splat(all),
            [r, g, b] => Vec3::new(r, g, b),
            _ => {
                let problem = format!("{} numbers are given", self.albedo.len());
                let expected = "one number, or three: red, green and blue";
                return Err(FieldError::from_problem("--albedo", problem, expected));
            }
        };
        medium.anisotropy = self.g.unwrap_or(medium.anisotropy);
        medium.density = self.density.unwrap_or(medium.density);
        Ok(medium)
    }

    /// Returns the medium's name, or `medium` if a number of it was changed.
    pub fn label_of<'a>(&self, name: &'a str) -> &'a str {
        if self.first_given().is_none() { name } else { "medium" }
    }
}

impl MediumArguments {
    /// # Errors
    /// As [`MediumNumbers::medium_of`].
    pub fn medium(&self) -> Result<Medium, FieldError> {
        self.numbers.medium_of(&self.medium)
    }

    /// As [`MediumNumbers::label_of`].
    pub fn name(&self) -> &str {
        self.numbers.label_of(&self.medium)
    }
}

#[derive(Args)]
pub struct PathTraceArguments {
    /// Pixels along a side of the puff.
    #[arg(long, default_value_t = Self::default().size, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(8..=256))]
    size: u32,
    /// Paths per pixel.
    #[arg(long, default_value_t = Self::default().samples, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=65536))]
    samples: u32,
    /// Seed of the noise.
    #[arg(long, default_value_t = Self::default().seed, allow_hyphen_values = true)]
    #[arg(value_parser = parse_seed)]
    seed: u32,
}

/// Quality that takes a few seconds.
impl Default for PathTraceArguments {
    fn default() -> Self {
        Self { size: 48, samples: 64, seed: 1 }
    }
}

impl PathTraceArguments {
    pub fn path_trace(&self) -> PathTrace {
        PathTrace { size: self.size, samples: self.samples, seed: self.seed }
    }

    /// Does the work, and shows the progress on a terminal.
    pub fn with_progress<T>(&self, what: &str, work: impl FnOnce(&dyn Fn(u32) -> Result<(), Error>) -> T) -> T {
        let done = AtomicU32::new(0);
        let line = || format!("haze: tracing {what}, path {} of {}", done.load(Ordering::Relaxed) + 1, self.samples);
        with_changing_progress(line, || {
            work(&|sample| {
                done.store(sample, Ordering::Relaxed);
                Ok(())
            })
        })
    }
}
