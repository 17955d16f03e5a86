//! `haze sprite simulate`: simulates smoke and fire, and bakes the frames to sprites.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use clap::Args;
use haze::FieldError;
use haze_author::simulation::{SimRecipe, Simulation};
use haze_core::error::Error;
use haze_export::output::{Failures, FileChecks, print_line};
use haze_export::progress::{with_changing_progress, with_progress};
use haze_export::recipe_files::image_path;
use haze_preset::write_baked_png;
use image::DynamicImage;

use super::six_way::SixWayArguments;
use crate::bake_job::{OverwriteArguments, PaintedPng, check_not_painted};

#[derive(Args)]
pub struct Arguments {
    /// `*.sim.json` files.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    /// Simulate on half the grid with a quarter of the frames, to NAME_preview.png and so on. Takes seconds.
    #[arg(long)]
    preview: bool,
    #[command(flatten)]
    six_way: SixWayArguments,
    #[command(flatten)]
    overwrite: OverwriteArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    let Arguments { recipes, preview, six_way, overwrite } = arguments;
    six_way.check_options()?;
    let mut files = FileChecks::for_inputs(recipes);
    let load = |path| Job::load(path, *preview, six_way, overwrite.painted_png(), &mut files);
    let (jobs, failures) = Failures::of_each(recipes, load);
    failures.into_result()?;
    jobs.iter().try_for_each(|job| job.run(six_way)).map_err(Failures::from)
}

/// A valid recipe, with the files that its images go to.
struct Job<'a> {
    path: &'a Path,
    recipe: SimRecipe,
    image: PathBuf,
    outputs: Vec<PathBuf>,
    painted: PaintedPng,
}

impl<'a> Job<'a> {
    fn load(
        path: &'a PathBuf,
        preview: bool,
        six_way: &SixWayArguments,
        painted: PaintedPng,
        files: &mut FileChecks,
    ) -> Result<Self, Error> {
        if !path.to_string_lossy().ends_with(".sim.json") {
            return Err(FieldError::new("recipe", path.display(), "a *.sim.json file").into());
        }
        let recipe = SimRecipe::load(path)?;
        let mut image = image_path(path);
        if preview {
            let name = image.file_stem().unwrap_or_default().to_string_lossy();
            image = image.with_file_name(format!("{name}_preview.png"));
        }
        let recipe = if preview { recipe.preview() } else { recipe };
        let mut outputs = vec![image.clone(), image.with_extension("detail.png")];
        if recipe.burns() {
            outputs.push(image.with_extension("heat.png"));
        }
        for output in outputs.iter().chain(&six_way.output(&image)) {
            files.check_output("output", output, "png")?;
            check_not_painted(output, painted)?;
        }
        Ok(Self { path, recipe, image, outputs, painted })
    }

    /// Simulates, and writes the images with a line for each.
    fn run(&self, six_way: &SixWayArguments) -> Result<(), Error> {
        let simulation = self.simulate()?;
        let baked = with_progress(format!("haze: baking {}", self.path.display()), || simulation.bake());
        // A PNG may have been painted during a long simulation.
        self.outputs.iter().try_for_each(|output| check_not_painted(output, self.painted))?;
        let images = [DynamicImage::from(baked.sprite.image), baked.sprite.detail.into()];
        for (image, output) in images.iter().chain(&baked.heat.map(DynamicImage::from)).zip(&self.outputs) {
            with_progress(format!("haze: writing {}", output.display()), || write_baked_png(output, image))?;
            print_line!("{}: {}x{}", output.display(), image.width(), image.height())?;
        }
        let frames = self.recipe.sheet.frame_count();
        six_way.bake(self.path, &self.image, frames, |medium, samples, progress| {
            simulation.bake_six_way(medium, samples, progress)
        })
    }

    fn simulate(&self) -> Result<Simulation, Error> {
        let path = self.path.display();
        let count = self.recipe.moment_count();
        let done = AtomicU32::new(0);
        let started = Instant::now();
        let what = || {
            let done = done.load(Ordering::Relaxed);
            let frame = (done + 1).min(count);
            // The first frames are faster than the others, because little smoke has been born.
            let left = match done {
                0 => String::new(),
                _ => format!(
                    ", about {:.0} s left",
                    started.elapsed().as_secs_f32() / done as f32 * (count - done) as f32
                ),
            };
            format!("haze: simulating {path}, frame {frame} of {count}{left}")
        };
        with_changing_progress(what, || {
            self.recipe.simulate(|frames| {
                done.store(frames, Ordering::Relaxed);
                Ok::<_, Error>(())
            })
        })
    }
}
