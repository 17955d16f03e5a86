//! `haze sprite bake --six-way`: bakes sprites under light from six sides.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use clap::Args;
use haze::FieldError;
use haze_author::path_trace::Medium;
use haze_author::sprite::six_way::BakedSixWay;
use haze_core::error::Error;
use haze_export::interrupt;
use haze_export::options::whole_number;
use haze_export::output::{FileChecks, print_line};
use haze_export::progress::with_changing_progress;
use haze_export::recipe_files::{image_path, six_way_path};
use haze_export::sprite_by_name::sprite_recipe;
use haze_preset::{builtin, write_baked_png};

use crate::bake_job::{PaintedPng, check_not_painted};
use crate::medium_options::{MediumNumbers, medium_names};

#[derive(Args)]
pub struct SixWayArguments {
    /// Also path-trace the sprites, filled with this medium, to NAME.six_way.png for `lighting: six_way`. Takes some
    /// minutes.
    #[arg(long, value_name = "MEDIUM", value_parser = medium_names(), num_args = 0..=1, default_missing_value = "ash")]
    six_way: Option<String>,
    #[command(flatten)]
    numbers: MediumNumbers,
    /// With --six-way: paths per pixel. The noise falls with their square root.
    #[arg(long, default_value_t = 64, allow_hyphen_values = true)]
    #[arg(value_parser = whole_number(1..=65536))]
    samples: u32,
}

impl SixWayArguments {
    /// Refuses bad options and outputs before anything is baked.
    ///
    /// # Errors
    /// Names the option or the file.
    pub fn check(&self, recipes: &[PathBuf], painted: PaintedPng) -> Result<(), Error> {
        self.check_options()?;
        let mut files = FileChecks::for_inputs(recipes);
        sprites(recipes).map(image_path).filter_map(|image| self.output(&image)).try_for_each(|output| {
            files.check_output("output", &output, "png")?;
            check_not_painted(&output, painted)
        })
    }

    /// Refuses options that are not valid, or have no effect.
    ///
    /// # Errors
    /// Names the option.
    pub fn check_options(&self) -> Result<(), Error> {
        match (&self.six_way, self.numbers.first_given()) {
            (Some(name), _) => self.numbers.medium_of(name).map(drop).map_err(Error::from),
            (None, None) => Ok(()),
            (None, Some(option)) => {
                let problem = "has no effect without --six-way";
                Err(FieldError::from_problem(option, problem, "--six-way as well").into())
            }
        }
    }

    /// Returns the file of the maps of a sprite, if they were asked for.
    pub fn output(&self, image: &Path) -> Option<PathBuf> {
        self.six_way.is_some().then(|| six_way_path(image))
    }

    /// Returns the recipes that are baked without light: with --six-way all but built-in sprites, which have no file.
    pub fn recipe_files(&self, recipes: &[PathBuf]) -> Vec<PathBuf> {
        let is_file = |path: &&PathBuf| self.six_way.is_none() || !is_builtin(path);
        recipes.iter().filter(is_file).cloned().collect()
    }

    /// Bakes the maps of every sprite recipe, if they were asked for.
    ///
    /// # Errors
    /// As [`sprite_recipe`], and if a file cannot be written.
    pub fn bake_all(&self, recipes: &[PathBuf]) -> Result<(), Error> {
        if self.six_way.is_none() {
            return Ok(());
        }
        sprites(recipes).try_for_each(|path| {
            let recipe = sprite_recipe(path)?;
            self.bake(path, &image_path(path), recipe.frame_count(), |medium, samples, progress| {
                recipe.bake_six_way(medium, samples, progress)
            })
        })
    }

    /// Bakes the maps of one sprite of `frames` frames, if they were asked for. `path` is its recipe, and `image` its
    /// flipbook. `bake` gets the medium, the paths per pixel, and a function to call with the frame and the number of
    /// finished paths.
    ///
    /// # Errors
    /// Those of `bake`, and if the file cannot be written.
    pub fn bake(
        &self,
        path: &Path,
        image: &Path,
        frames: u32,
        bake: impl FnOnce(&Medium, u32, &dyn Fn(u32, u32) -> Result<(), Error>) -> Result<BakedSixWay, Error>,
    ) -> Result<(), Error> {
        let Some(name) = &self.six_way else { return Ok(()) };
        let medium = self.numbers.medium_of(name)?;
        let done = [const { AtomicU32::new(0) }; 2];
        let what = || {
            let [frame, sample] = done.each_ref().map(|count| count.load(Ordering::Relaxed) + 1);
            let samples = self.samples;
            format!("haze: tracing {}, frame {frame} of {frames}, path {sample} of {samples}", path.display())
        };
        let baked = with_changing_progress(what, || {
            bake(&medium, self.samples, &|frame, sample| {
                done.iter().zip([frame, sample]).for_each(|(count, now)| count.store(now, Ordering::Relaxed));
                interrupt::check(&path.display().to_string(), "the six-way maps are not written")
            })
        })?;
        let BakedSixWay { image: maps, intensity, color, anisotropy } = baked;
        let output = six_way_path(image);
        print_line!("{}: {}x{}", output.display(), maps.width(), maps.height())?;
        write_baked_png(&output, &maps.into())?;
        print_line!(
            "  to look like {}: lighting six_way, diffuse.intensity {intensity:.2}, six_way_anisotropy {anisotropy:.2}, \
             six_way_color {:.3},{:.3},{:.3}",
            self.numbers.label_of(name),
            color.x,
            color.y,
            color.z,
        )
    }
}

/// Returns the sprite recipes; noise has no six-way maps.
fn sprites(recipes: &[PathBuf]) -> impl Iterator<Item = &Path> {
    let is_sprite = |path: &&Path| is_builtin(path) || path.to_string_lossy().ends_with(".sprite.json");
    recipes.iter().map(PathBuf::as_path).filter(is_sprite)
}

fn is_builtin(path: &Path) -> bool {
    path.to_str().is_some_and(|name| builtin::find(builtin::SPRITES, name).is_some())
}
