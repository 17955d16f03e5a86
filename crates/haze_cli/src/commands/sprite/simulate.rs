//! `haze sprite simulate`: simulates smoke and fire, and bakes the frames to sprites.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use clap::Args;
use haze::FieldError;
use haze_author::simulation::{Recording, SimRecipe, Simulation};
use haze_core::error::{AssetError, Error};
use haze_export::interrupt;
use haze_export::output::{Failures, FileChecks, OutputFolder, print_line};
use haze_export::progress::with_changing_progress;
use haze_export::recipe_files::image_path;
use haze_preset::write_file;

use super::recording_output::RecordingOutput;
use super::six_way::SixWayArguments;
use crate::bake_job::OverwriteArguments;

/// Time between two checkpoints, for programs that are ended without a signal.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(120);

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
    interrupt::catch();
    jobs.iter().try_for_each(|job| job.run(&arguments.six_way)).map_err(Failures::from)
}

/// A valid recipe, with the files that its images and moments go to.
struct Job<'a> {
    path: &'a Path,
    recipe: SimRecipe,
    output: RecordingOutput<'a>,
    /// File from which a stopped simulation goes on.
    checkpoint: PathBuf,
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
        let volumes = vdb.as_ref().map(|folder| (folder.as_path(), name.clone()));
        let checkpoint = path.with_file_name(format!("{name}.checkpoint"));
        let job = Self { path, recipe, output, checkpoint, volumes };
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
        self.output.bake(&recording, self.recipe.sheet, six_way)?;
        match std::fs::remove_file(&self.checkpoint) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(AssetError::Io { path: self.checkpoint.clone(), error }.into())
            }
            _ => Ok(()),
        }
    }

    fn simulate(&self) -> Result<Recording, Error> {
        let path = self.path.display();
        let count = self.recipe.moment_count();
        let mut simulation = self.resumed()?;
        let before = simulation.finished_moments();
        let done = AtomicU32::new(before);
        let started = Instant::now();
        let what = || {
            let done = done.load(Ordering::Relaxed);
            let frame = (done + 1).min(count);
            // The first frames are faster than the others, because little smoke has been born.
            let left = match done - before {
                0 => String::new(),
                new => {
                    let seconds = started.elapsed().as_secs_f32() / new as f32 * (count - done) as f32;
                    format!(", about {seconds:.0} s left")
                }
            };
            format!("haze: simulating {path}, frame {frame} of {count}{left}")
        };
        with_changing_progress(what, || {
            let mut written = Instant::now();
            while simulation.finished_moments() < count {
                if interrupt::is_requested() || written.elapsed() > CHECKPOINT_INTERVAL {
                    write_file(&self.checkpoint, &simulation.to_checkpoint())?;
                    written = Instant::now();
                    let done = simulation.finished_moments();
                    let kept = format!("{done} of {count} frames are in {}", self.checkpoint.display());
                    interrupt::check(&path.to_string(), &format!("{kept}, and the same command goes on"))?;
                }
                let Some(moment) = simulation.advance() else { continue };
                if let Some(file) = self.volume_file(moment.number) {
                    write_file(&file, &moment.to_vdb())?;
                }
                done.store(moment.number, Ordering::Relaxed);
            }
            // The bake may be stopped as well.
            if started.elapsed() > CHECKPOINT_INTERVAL {
                write_file(&self.checkpoint, &simulation.to_checkpoint())?;
            }
            Ok::<_, Error>(())
        })?;
        Ok(simulation.into_recording())
    }

    /// Returns the simulation as its checkpoint has it, or a new one.
    fn resumed(&self) -> Result<Simulation<'_>, Error> {
        let checkpoint = &self.checkpoint;
        let file = checkpoint.display();
        let found = match std::fs::read(checkpoint) {
            Ok(bytes) => Simulation::resume(&self.recipe, &bytes).map_err(|problem| {
                let expected = "the file that this command wrote, or none: then the simulation starts anew";
                FieldError::from_problem("checkpoint", format!("{file}: {problem}"), expected)
            })?,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Simulation::new(&self.recipe)?),
            Err(error) => return Err(AssetError::Io { path: checkpoint.clone(), error }.into()),
        };
        let Some(simulation) = found else {
            print_line!("{file}: of another recipe; starts anew")?;
            return Ok(Simulation::new(&self.recipe)?);
        };
        let done = simulation.finished_moments();
        let missing = (1..=done).filter_map(|moment| self.volume_file(moment)).find(|file| !file.exists());
        if let Some(missing) = missing {
            print_line!("{file}: {} is not there; starts anew", missing.display())?;
            return Ok(Simulation::new(&self.recipe)?);
        }
        print_line!("{file}: goes on after {done} of {} frames", self.recipe.moment_count())?;
        Ok(simulation)
    }
}
