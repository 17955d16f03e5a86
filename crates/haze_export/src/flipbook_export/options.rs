//! Choices of a flipbook.

use glam::UVec2;
use haze::FieldError;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_preset::CompressionEffort;

use super::{cut_smoke, sheets};
use crate::backend::Backend;
use crate::engine::Engine;
use crate::image_export::{ExportProgress, Frames, check_cells};
use crate::image_format::{Alpha, Emission};
use crate::memory_check::{BYTES_PER_PIXEL, check_memory};

/// Choices of a flipbook.
#[derive(Clone, Copy, Debug)]
pub struct FlipbookOptions {
    /// Engine that reads the flipbook.
    pub engine: Engine,
    /// Rows (`x`) and columns (`y`).
    pub cells: UVec2,
    /// Color of `color.png`. `None`: premultiplied if it contains fire in one of the frames, because straight color has no glow where
    /// opacity is low; straight otherwise.
    pub alpha: Option<Alpha>,
    /// Light of fire in `color.png`.
    pub emission: Emission,
    /// Frames after the last that fade into the first ones, so that the flipbook loops. 0: none.
    pub loop_fade: u32,
    /// True for sheets of six-way light maps.
    pub has_six_way: bool,
    /// Of the sheets' files.
    pub effort: CompressionEffort,
}

impl FlipbookOptions {
    /// Checks the choices before anything is rendered or written.
    ///
    /// # Errors
    /// [`Error::Field`] for a fade that is longer than the flipbook, for sheets with too few cells or too many pixels, and for separate
    /// emission if no system burns; [`AssetError::Io`](haze_core::error::AssetError::Io) for rows of frames that do not fit into memory.
    pub fn check(&self, shot: &Shot, frames: &Frames) -> Result<(), Error> {
        let count = frames.count();
        let fade = self.loop_fade;
        if fade >= count {
            let expected = format!("less than the number of frames, {count}");
            return Err(FieldError::new("--loop", fade, expected).into());
        }
        if frames.range.end().checked_add(fade).is_none() {
            let problem = format!("{fade} frames after {} are beyond the last frame", frames.range.end());
            return Err(FieldError::from_problem("--loop", problem, format!("at most frame {}", u32::MAX)).into());
        }
        check_cells(shot.size, frames, self.cells)?;
        let columns = self.cells.y;
        let burns = frames.burns(shot, count + fade);
        if self.emission == Emission::Separate && !burns {
            let problem = "separate, but no system burns in these frames";
            return Err(FieldError::from_problem("--emission", problem, "contained").into());
        }
        let frame = sheets::frame_bytes_per_pixel(burns, self.has_six_way) + BYTES_PER_PIXEL;
        // Half as much again allows for the allocator's overhead.
        let row = sheets::row_bytes_per_pixel(burns, self.has_six_way) * 3 / 2;
        check_memory("--sheet", shot.size * UVec2::new(columns, 1), row + frame.div_ceil(u64::from(columns)))
    }

    /// Widens the field of view until it holds the smoke of all frames.
    ///
    /// # Errors
    /// [`Error::Field`] if none does, and if keyframes set it; errors of rendering; [`AssetError::Io`](haze_core::error::AssetError::Io) if it was stopped.
    pub async fn fit(
        &self,
        backend: &Backend,
        shot: &mut Shot,
        frames: &Frames,
        progress: &ExportProgress<'_>,
    ) -> Result<(), Error> {
        cut_smoke::fit(backend, shot, frames, frames.count().saturating_add(self.loop_fade), progress).await
    }
}
