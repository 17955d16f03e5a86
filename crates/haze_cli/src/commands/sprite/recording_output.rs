//! Files that a recording is baked to: flipbook, detail map, heat map and six-way maps.

use std::path::{Path, PathBuf};

use haze_author::simulation::Recording;
use haze_author::sprite::bake::SheetLayout;
use haze_core::error::Error;
use haze_export::output::{FileChecks, print_line};
use haze_export::progress::with_progress;
use haze_preset::write_baked_png;
use image::DynamicImage;

use super::six_way::SixWayArguments;
use crate::bake_job::{PaintedPng, check_not_painted};

/// Files of one recording, which may be written.
pub struct RecordingOutput<'a> {
    /// File that the recording is made from.
    path: &'a Path,
    image: PathBuf,
    /// Flipbook, detail map and, if there may be heat, heat map.
    outputs: Vec<PathBuf>,
    painted: PaintedPng,
}

impl<'a> RecordingOutput<'a> {
    /// Refuses files that cannot be written, or were painted.
    ///
    /// # Errors
    /// Names the file.
    pub fn new(
        path: &'a Path,
        image: PathBuf,
        may_have_heat: bool,
        six_way: &SixWayArguments,
        painted: PaintedPng,
        files: &mut FileChecks,
    ) -> Result<Self, Error> {
        let mut outputs = vec![image.clone(), image.with_extension("detail.png")];
        if may_have_heat {
            outputs.push(image.with_extension("heat.png"));
        }
        for output in outputs.iter().chain(&six_way.output(&image)) {
            files.check_output("output", output, "png")?;
            check_not_painted(output, painted)?;
        }
        Ok(Self { path, image, outputs, painted })
    }

    /// Bakes the images, and writes them with a line for each.
    ///
    /// # Errors
    /// If a file cannot be written, or was painted since.
    pub fn bake(&self, recording: &Recording, sheet: SheetLayout, six_way: &SixWayArguments) -> Result<(), Error> {
        let baked = with_progress(format!("haze: baking {}", self.path.display()), || recording.bake());
        // A PNG may have been painted during a long simulation.
        self.outputs.iter().try_for_each(|output| check_not_painted(output, self.painted))?;
        let images = [DynamicImage::from(baked.sprite.image), baked.sprite.detail.into()];
        for (image, output) in images.iter().chain(&baked.heat.map(DynamicImage::from)).zip(&self.outputs) {
            with_progress(format!("haze: writing {}", output.display()), || write_baked_png(output, image))?;
            print_line!("{}: {}x{}", output.display(), image.width(), image.height())?;
        }
        six_way.bake(self.path, &self.image, sheet.frame_count(), |medium, samples, progress| {
            recording.bake_six_way(medium, samples, progress)
        })
    }
}
