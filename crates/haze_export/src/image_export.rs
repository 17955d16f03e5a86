//! Renders many images of a shot: a sequence, a flipbook, a GIF, a labelled sheet. Used by the command line and the
//! tweaker. Asynchronous for pages; elsewhere nothing here waits, so that `block_on` runs through.

use std::io::{Error as IoError, ErrorKind};
use std::ops::RangeInclusive;
use std::path::Path;

use glam::UVec2;
use haze::FieldError;
use haze_core::error::{AssetError, Error};
#[cfg(not(target_arch = "wasm32"))]
use haze_core::settings::BlendMode;
use haze_demo::shot::Shot;
#[cfg(not(target_arch = "wasm32"))]
use haze_preset::AnimatedPreset;
use haze_preset::{CompressionEffort, Preset, write_file, write_png};
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame};

use super::backend::Backend;
use super::contact_sheet::ContactSheet;
use super::frame_range::FrameNames;
use super::image_format::{self, Alpha, Background, BitDepth, ImageFormat};
use super::interrupt;
use super::memory_check::{BYTES_PER_PIXEL, check_memory};
#[cfg(not(target_arch = "wasm32"))]
use super::progress::with_progress;

/// Range of frames. Frame 0 is at the preset's time.
pub struct Frames {
    /// First and last frame.
    pub range: RangeInclusive<u32>,
    /// Frames per second.
    pub rate: f32,
    /// Format of the files.
    pub format: ImageFormat,
}

/// Receiver of the progress, which can stop the work.
pub enum ExportProgress<'a> {
    /// A terminal, where Ctrl-C stops the work.
    Terminal,
    /// A callback that gets the numbers of finished and of all images before each image; it returns false to stop the
    /// work.
    Callback(&'a dyn Fn(u32, u32) -> bool),
}

impl ExportProgress<'_> {
    /// Catches Ctrl-C from now on; it then stops the work after the current image.
    pub fn terminal() -> Self {
        interrupt::catch();
        Self::Terminal
    }

    /// Returns false if the work is to stop.
    pub fn goes_on(&self, done: u32, count: u32) -> bool {
        match self {
            Self::Terminal => !interrupt::is_requested(),
            Self::Callback(go_on) => go_on(done, count),
        }
    }

    /// Renders an image; `None` if the work is to stop.
    async fn render(
        &self,
        done: u32,
        count: u32,
        backend: &Backend,
        shot: &Shot,
        format: ImageFormat,
    ) -> Result<Option<DynamicImage>, Error> {
        if !self.goes_on(done, count) {
            return Ok(None);
        }
        let draw = async |shot: &Shot| backend.render_async(shot).await;
        Ok(Some(self.show(image_label(done, count), format.render(shot, draw)).await?))
    }

    /// Does the work of an image, and shows `what` meanwhile. On a terminal, the work must not wait for anything else.
    #[cfg(not(target_arch = "wasm32"))]
    pub async fn show<T>(&self, what: String, work: impl Future<Output = T>) -> T {
        match self {
            Self::Terminal => with_progress(what, || pollster::block_on(work)),
            Self::Callback(_) => work.await,
        }
    }

    /// A page has no terminal.
    #[cfg(target_arch = "wasm32")]
    async fn show<T>(&self, _: String, work: impl Future<Output = T>) -> T {
        work.await
    }
}

impl Frames {
    /// Number of frames.
    pub fn count(&self) -> u32 {
        self.range.end() - self.range.start() + 1
    }

    /// Returns the shot at the time of a frame, with the values that its settings have then.
    pub fn shot(&self, shot: &Shot, frame: u32) -> Shot {
        Self::shot_at(shot, self.time(shot, f64::from(frame)))
    }

    /// Returns the shot at the time halfway between a frame and the next, with the values that its settings have then.
    pub fn shot_halfway(&self, shot: &Shot, frame: u32) -> Shot {
        Self::shot_at(shot, self.time(shot, f64::from(frame) + 0.5))
    }

    fn shot_at(shot: &Shot, time: f64) -> Shot {
        let mut shot = shot.clone();
        shot.preset = shot.preset.evaluate(time);
        shot
    }

    /// Returns the error of a sequence that was stopped after so many frames.
    pub fn stopped_sequence(&self, names: &FrameNames, done: u32) -> Error {
        let what = format!("not written; this sequence is partial, {done} of {} frames are written", self.count());
        stopped(&names.of(self.range.start() + done), what)
    }

    /// True if a system burns in one of the first `count` frames, counted beyond the range too.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn burns(&self, shot: &Shot, count: u32) -> bool {
        let mut animated = AnimatedPreset::new(&shot.preset);
        (0..count).any(|index| burns(animated.evaluate(self.time(shot, f64::from(self.range.start() + index)))))
    }

    /// `frame`: its number, or one between two.
    fn time(&self, shot: &Shot, frame: f64) -> f64 {
        shot.preset.time + frame / f64::from(self.rate)
    }

    /// Renders every frame and passes it to `take` with its number. `stopped` makes the error of a run that was stopped
    /// after so many frames.
    async fn render(
        &self,
        backend: &Backend,
        shot: &Shot,
        progress: &ExportProgress<'_>,
        mut take: impl FnMut(u32, DynamicImage) -> Result<(), Error>,
        stopped: impl Fn(u32) -> Error,
    ) -> Result<(), Error> {
        let format = self.format.resolved(shot);
        for (done, frame) in (0..).zip(self.range.clone()) {
            let shot = self.shot(shot, frame);
            let image = progress.render(done, self.count(), backend, &shot, format).await?;
            let image = image.ok_or_else(|| stopped(done))?;
            take(frame, image)?;
        }
        Ok(())
    }
}

/// True if a system burns.
pub fn burns(preset: &Preset) -> bool {
    preset.systems.iter().any(|system| system.settings.burns())
}

/// True if a system adds its light and hides nothing.
#[cfg(not(target_arch = "wasm32"))]
pub fn is_additive(preset: &Preset) -> bool {
    preset.systems.iter().any(|system| system.settings.blend_mode == BlendMode::Additive)
}

/// Text of the progress of one image of many.
pub fn image_label(done: u32, count: u32) -> String {
    format!("haze: image {} of {count}", done + 1)
}

/// Error of work that was stopped.
pub fn stopped(path: &Path, what: String) -> Error {
    Error::from(AssetError::Io {
        path: path.into(),
        error: IoError::new(ErrorKind::Interrupted, format!("stopped: {what}")),
    })
}

/// Error of a single output file, which is not written if the work is stopped.
pub fn stopped_before_writing(path: &Path, done: u32, count: u32) -> Error {
    stopped(path, format!("not written; {done} of {count} images were rendered"))
}

/// Writes every frame to its own file. If it is stopped, the files written so far stay.
pub async fn write_sequence(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    names: &FrameNames,
    effort: CompressionEffort,
    progress: &ExportProgress<'_>,
) -> Result<(), Error> {
    let write = |frame, image: DynamicImage| Ok(write_png(&names.of(frame), &image, effort)?);
    frames.render(backend, shot, progress, write, |done| frames.stopped_sequence(names, done)).await
}

/// Most pixels along a side of a flipbook.
const MAX_FLIPBOOK_SIDE: u32 = 32_768;

/// Refuses a flipbook that has too few cells for its frames, or that is too large for an image or for the memory.
pub fn check_flipbook(size: UVec2, frames: &Frames, cells: UVec2) -> Result<(), Error> {
    check_cells(size, frames, cells)?;
    check_memory("--sheet", size * UVec2::new(cells.y, cells.x), BYTES_PER_PIXEL)
}

/// The same, without a check of the memory.
pub fn check_cells(size: UVec2, frames: &Frames, cells: UVec2) -> Result<(), Error> {
    let rows = cells.x;
    let columns = cells.y;
    let count = frames.count();
    if count > cells.element_product() {
        let expected = format!("at least {count} cells, one for each frame");
        return Err(FieldError::new("--sheet", format!("{rows}x{columns}"), expected).into());
    }
    let size = size * UVec2::new(columns, rows);
    if size.max_element() > MAX_FLIPBOOK_SIDE {
        let problem = format!("{rows}x{columns} cells make a sheet of {}x{} pixels", size.x, size.y);
        let expected = format!("at most {MAX_FLIPBOOK_SIDE} along a side");
        return Err(FieldError::from_problem("--sheet", problem, expected).into());
    }
    Ok(())
}

/// Renders all frames onto one sheet of `cells.x` rows and `cells.y` columns. `path` is the output file, for errors.
pub async fn render_flipbook(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    cells: UVec2,
    path: &Path,
    progress: &ExportProgress<'_>,
) -> Result<DynamicImage, Error> {
    let columns = cells.y;
    let size = shot.size * UVec2::new(columns, cells.x);
    let mut sheet = frames.format.blank(shot, size);
    let mut index = 0;
    let place = |_, image: DynamicImage| {
        let corner = UVec2::new(index % columns, index / columns) * shot.size;
        image_format::place(&mut sheet, &image, corner);
        index += 1;
        Ok(())
    };
    let stopped = |done| stopped_before_writing(path, done, frames.count());
    frames.render(backend, shot, progress, place, stopped).await?;
    Ok(sheet)
}

/// Frames per second if none are given.
pub const USUAL_RATE: f32 = 60.0;

/// Highest frame rate of a GIF. GIF delays are whole hundredths of a second, and viewers lengthen delays below two
/// hundredths.
pub const MAX_GIF_RATE: f32 = 50.0;

/// Writes all frames into one animated GIF that loops for ever.
pub async fn write_gif(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    path: &Path,
    progress: &ExportProgress<'_>,
) -> Result<(), Error> {
    let failed = |error| Error::from(AssetError::Image { path: path.into(), reason: format!("{error}") });
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new_with_speed(&mut bytes, 10);
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let mut index = 0;
    // Delays are differences of rounded end times, so that rounding does not change the total duration.
    let end = |index: u32| (index as f32 * 100.0 / frames.rate).round() as u32;
    let encode = |_, image: DynamicImage| {
        let delay = Delay::from_numer_denom_ms(10 * (end(index + 1) - end(index)), 1);
        index += 1;
        encoder.encode_frame(Frame::from_parts(image.into_rgba8(), 0, 0, delay)).map_err(failed)
    };
    let stopped = |done| stopped_before_writing(path, done, frames.count());
    frames.render(backend, shot, progress, encode, stopped).await?;
    drop(encoder);
    Ok(write_file(path, &bytes)?)
}

/// Images on labelled sheets, and frames of a GIF, which has no partial opacity.
pub const SCENE: ImageFormat =
    ImageFormat { background: Background::Scene, alpha: Alpha::Straight, bits: BitDepth::Eight };

/// Most images on a labelled sheet.
pub const MAX_SHEET_CELLS: usize = 64;

/// Renders shots with their labels onto one sheet. All shots have one size; `path` is the output file, for errors.
pub async fn render_sheet(
    backend: &Backend,
    cells: &[(String, Shot)],
    columns: u32,
    path: &Path,
    progress: &ExportProgress<'_>,
) -> Result<ContactSheet, Error> {
    let count = cells.len() as u32;
    let size = cells.first().map_or(UVec2::ONE, |(_, shot)| shot.size);
    let mut sheet = ContactSheet::new(size, columns, count);
    for (index, (label, shot)) in (0..).zip(cells) {
        let image = progress.render(index, count, backend, shot, SCENE).await?;
        let image = image.ok_or_else(|| stopped_before_writing(path, index, count))?;
        sheet.place(index, label, &image.into_rgb8());
    }
    Ok(sheet)
}

/// Number of columns of a sheet that is about square.
pub fn column_count(count: usize) -> u32 {
    (1..).find(|side| side * side >= count as u32).unwrap_or(1)
}
