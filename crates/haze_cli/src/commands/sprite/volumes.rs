//! `haze sprite bake smoke_####.vdb`: bakes smoke of other tools to sprites.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use clap::Args;
use glam::UVec2;
use haze::FieldError;
use haze_author::simulation::{FrameLoop, View, VolumeOptions, VolumeRecording, VolumeSequence};
use haze_author::sprite::bake::SheetLayout;
use haze_core::error::Error;
use haze_core::settings::validate;
use haze_export::options::{choices, number, whole_number};
use haze_export::output::{Failures, FileChecks, print_error, print_line};
use haze_export::progress::with_changing_progress;
use haze_export::recipe_files::has_extension;
use haze_preset::UpAxis;

use super::recording_output::RecordingOutput;
use super::six_way::SixWayArguments;
use crate::bake_job::PaintedPng;

#[derive(Args)]
#[command(next_help_heading = "Options for VDB files")]
pub struct VolumeArguments {
    /// Grid of the smoke. Default: density.
    #[arg(long, value_name = "NAME")]
    grid: Option<String>,
    /// Axis that points up. Default: by the program that wrote the file, else y.
    #[arg(long, value_parser = choices::<UpAxis>())]
    up: Option<UpAxis>,
    /// Most cells along a side of the box around the smoke, 16 to 192. Default: 192.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole_number(16..=192))]
    resolution: Option<u32>,
    /// Frames per second, for velocities per second. Default: 24.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number(0.01..=1000.0))]
    fps: Option<f32>,
    /// Width and height of one frame, pixels. Default: 128.
    #[arg(long, value_name = "PIXELS", allow_hyphen_values = true, value_parser = whole_number(8..=512))]
    size: Option<u32>,
    /// Frames per row of the sheet. Default: for all frames of the files, at most 64.
    #[arg(long, requires = "rows", allow_hyphen_values = true, value_parser = whole_number(1..=16))]
    columns: Option<u32>,
    /// Rows of frames of the sheet.
    #[arg(long, requires = "columns", allow_hyphen_values = true, value_parser = whole_number(1..=16))]
    rows: Option<u32>,
    /// End of the flipbook: it plays once, or its last frames blend into its first ones. Default: once.
    #[arg(long = "loop", value_parser = choices::<FrameLoop>())]
    frame_loop: Option<FrameLoop>,
    /// Extinction of the densest smoke per half side of a frame. Larger values are more opaque. Default: 12.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number(0.1..=200.0))]
    extinction: Option<f32>,
    /// Density of gas by its heat: makes flames visible that have no smoke. Default: 0.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = number(0.0..=10.0))]
    flame: Option<f32>,
}

/// True for a VDB file, or a sequence of them.
pub fn is_volume(path: &Path) -> bool {
    has_extension(path, "vdb")
}

impl VolumeArguments {
    /// Refuses options without VDB files.
    ///
    /// # Errors
    /// Names the first option.
    pub fn check_unused(&self) -> Result<(), Error> {
        let given = [
            ("--grid", self.grid.is_some()),
            ("--up", self.up.is_some()),
            ("--resolution", self.resolution.is_some()),
            ("--fps", self.fps.is_some()),
            ("--size", self.size.is_some()),
            ("--columns", self.columns.is_some()),
            ("--loop", self.frame_loop.is_some()),
            ("--extinction", self.extinction.is_some()),
            ("--flame", self.flame.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => {
                let problem = "has no effect on a recipe";
                Err(FieldError::from_problem(option, problem, "a .vdb file, or the field of the recipe").into())
            }
            None => Ok(()),
        }
    }

    fn options(&self, sequence: &VolumeSequence) -> Result<VolumeOptions, FieldError> {
        let frame_loop = self.frame_loop.unwrap_or_default();
        let cells = sequence.default_grid(frame_loop);
        let cells = UVec2::new(self.columns.unwrap_or(cells.x), self.rows.unwrap_or(cells.y));
        let default = VolumeOptions::default();
        let size = self.size.unwrap_or(default.sheet.size);
        let sheet = SheetLayout { size, columns: cells.x, rows: cells.y, ..default.sheet };
        validate(&sheet, String::new)?;
        let extinction = self.extinction.unwrap_or(default.view.extinction);
        let flame = self.flame.unwrap_or(default.view.flame);
        Ok(VolumeOptions {
            density: self.grid.clone().unwrap_or(default.density),
            up: self.up,
            resolution: self.resolution.unwrap_or(default.resolution),
            fps: self.fps.unwrap_or(default.fps),
            sheet,
            frame_loop,
            view: View { extinction, flame, ..default.view },
        })
    }
}

/// Files that were found, with those that the images go to.
pub struct VolumeJob<'a> {
    path: &'a Path,
    sequence: VolumeSequence,
    options: VolumeOptions,
    steps: u32,
    output: RecordingOutput<'a>,
}

/// Finds the files of all paths, and checks the outputs.
///
/// # Errors
/// Those of every path: no files, more frames on the sheet than there are, an output that cannot be written.
pub fn find_all<'a>(
    paths: &'a [PathBuf],
    volumes: &VolumeArguments,
    six_way: &SixWayArguments,
    painted: PaintedPng,
) -> Result<Vec<VolumeJob<'a>>, Failures> {
    let find = |path: &'a PathBuf| Ok((path, VolumeSequence::find(path)?));
    let (sequences, failures) = Failures::of_each(paths, find);
    failures.into_result()?;
    let mut files = FileChecks::for_inputs(sequences.iter().flat_map(|(_, sequence)| sequence.files()));
    let (jobs, failures) = Failures::of_each(sequences, |(path, sequence)| {
        let options = volumes.options(&sequence)?;
        let steps = sequence.step_count(&options)?;
        let output = RecordingOutput::new(path, image_path(path), true, six_way, painted, &mut files)?;
        Ok(VolumeJob { path, sequence, options, steps, output })
    });
    failures.into_result()?;
    Ok(jobs)
}

/// Returns the path of the image: `smoke.png` for `smoke_####.vdb`.
fn image_path(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().replace('#', "");
    let name = stem.trim_matches(['_', '-', '.', ' ']);
    path.with_file_name(format!("{}.png", if name.is_empty() { "smoke" } else { name }))
}

impl VolumeJob<'_> {
    /// Reads the files, and writes the images with a line for each.
    ///
    /// # Errors
    /// Names a file that cannot be read or written.
    pub fn run(&self, six_way: &SixWayArguments) -> Result<(), Error> {
        let path = self.path.display();
        if let Some(missing) = self.sequence.missing() {
            print_error(format_args!("{path}: frames are missing, and the ones before them stay: {missing}"));
        }
        let done = AtomicU32::new(0);
        let steps = self.steps;
        let what =
            || format!("haze: reading {path}, step {} of {steps}", (done.load(Ordering::Relaxed) + 1).min(steps));
        let VolumeRecording { recording, notes } = with_changing_progress(what, || {
            self.sequence.record(&self.options, |step| {
                done.store(step, Ordering::Relaxed);
                Ok::<_, Error>(())
            })
        })?;
        for note in notes {
            print_line!("{path}: {note}")?;
        }
        self.output.bake(&recording, self.options.sheet, six_way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_have_the_name_of_the_sequence() {
        for (path, image) in [
            ("a/smoke_####.vdb", "a/smoke.png"),
            ("smoke.####.vdb", "smoke.png"),
            ("####.vdb", "smoke.png"),
            ("my.fire.vdb", "my.fire.png"),
        ] {
            assert_eq!(image_path(Path::new(path)), Path::new(image));
        }
    }
}
