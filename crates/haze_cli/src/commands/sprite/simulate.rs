//! `haze sprite simulate`: simulates smoke and fire, and bakes the frames to sprites.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use clap::Args;
use haze::FieldError;
use haze_author::simulation::{Recording, SimRecipe};
use haze_core::error::Error;
use haze_export::output::{Failures, FileChecks, OutputFolder, print_line};
use haze_export::progress::with_changing_progress;
use haze_export::recipe_files::image_path;
use haze_preset::write_file;

use super::recording_output::RecordingOutput;
use super::six_way::SixWayArguments;
use crate::bake_job::OverwriteArguments;

#[derive(Args)]
pub struct Arguments {
    /// `*.sim.json` files.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    /// Simulate on half the grid with a quarter of the frames, to NAME_preview.png and so on. Takes seconds.
    #[arg(long)]
    preview: bool,
    /// Also write the smoke of every moment to FOLDER/NAME_####.vdb, for other tools: density, temperature if it burns,
    /// and vel. Lengths in widths of the box, times in seconds, y up.
    #[arg(long, value_name = "FOLDER")]
    vdb: Option<PathBuf>,
    #[command(flatten)]
    six_way: SixWayArguments,
    #[command(flatten)]
    overwrite: OverwriteArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    arguments.six_way.check_options()?;
    let mut files = FileChecks::for_inputs(&arguments.recipes);
    let _made = arguments.vdb.as_ref().map(|folder| OutputFolder::make("--vdb", folder)).transpose()?;
    let (jobs, failures) = Failures::of_each(&arguments.recipes, |path| Job::load(path, arguments, &mut files));
    failures.into_result()?;
    jobs.iter().try_for_each(|job| job.run(&arguments.six_way)).map_err(Failures::from)
}

/// A valid recipe, with the files that its images and moments go to.
struct Job<'a> {
    path: &'a Path,
    recipe: SimRecipe,
    output: RecordingOutput<'a>,
    /// Folder of the VDB files, and their names before the number.
    volumes: Option<(&'a Path, String)>,
}

impl<'a> Job<'a> {
    fn load(path: &'a PathBuf, arguments: &'a Arguments, files: &mut FileChecks) -> Result<Self, Error> {
        let Arguments { preview, vdb, six_way, overwrite, .. } = arguments;
        if !path.to_string_lossy().ends_with(".sim.json") {
            return Err(FieldError::new("recipe", path.display(), "a *.sim.json file").into());
        }
        let recipe = SimRecipe::load(path)?;
        let mut image = image_path(path);
        let mut name = image.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if *preview {
            name += "_preview";
            image = image.with_file_name(format!("{name}.png"));
        }
        let recipe = if *preview { recipe.preview() } else { recipe };
        let output = RecordingOutput::new(path, image, recipe.burns(), six_way, overwrite.painted_png(), files)?;
        let volumes = vdb.as_ref().map(|folder| (folder.as_path(), name));
        let job = Self { path, recipe, output, volumes };
        for moment in 1..=job.recipe.moment_count() {
            job.volume_file(moment).map_or(Ok(()), |file| files.check_output("--vdb", &file, "vdb"))?;
        }
        Ok(job)
    }

    /// Returns the VDB file of a moment, if they were asked for.
    fn volume_file(&self, moment: u32) -> Option<PathBuf> {
        self.volumes.as_ref().map(|(folder, name)| folder.join(format!("{name}_{moment:04}.vdb")))
    }

    /// Simulates, and writes the images with a line for each.
    fn run(&self, six_way: &SixWayArguments) -> Result<(), Error> {
        let recording = self.simulate()?;
        if let Some((folder, name)) = &self.volumes {
            let files = folder.join(format!("{name}_####.vdb"));
            let rate = 1.0 / self.recipe.seconds_per_frame();
            print_line!("{}: {} frames, {rate} per second", files.display(), self.recipe.moment_count())?;
        }
        self.output.bake(&recording, self.recipe.sheet, six_way)
    }

    fn simulate(&self) -> Result<Recording, Error> {
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
            let progress = |frames| {
                done.store(frames, Ordering::Relaxed);
                Ok::<_, Error>(())
            };
            self.recipe.simulate_moments(progress, |moment| {
                let file = self.volume_file(moment.number);
                file.map_or(Ok(()), |file| write_file(&file, &moment.to_vdb()).map_err(Error::from))
            })
        })
    }
}
