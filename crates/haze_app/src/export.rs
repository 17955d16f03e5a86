//! Many pictures of a shot: a sequence, a flipbook, a GIF, a labelled sheet. For the command line and for the window.

use std::io::{Error as IoError, ErrorKind};
use std::ops::RangeInclusive;
use std::path::Path;

use glam::UVec2;
use haze::picture::{Effort, write_file, write_png};
use haze::{Error, FieldError};
use haze_demo::develop::develop;
use haze_demo::shot::Shot;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbImage, imageops};

use super::frames::FrameNames;
use super::interrupt;
use super::memory::check_memory;
use super::options::Backend;
use super::progress::watched;
use super::sheet::Sheet;

/// A stretch of time. Frame 0 is at the preset's.
pub struct Frames {
    pub range: RangeInclusive<u32>,
    /// Frames in a second.
    pub rate: f32,
}

/// Who waits for the work.
pub enum Watch<'a> {
    /// Someone at a terminal, who can press Ctrl-C.
    Terminal,
    /// Is told before every picture how many of how many are done; false stops the work.
    Caller(&'a dyn Fn(u32, u32) -> bool),
}

impl Watch<'_> {
    /// Looks forward to Ctrl-C, and stops what is begun from now on when it comes.
    pub fn terminal() -> Self {
        interrupt::catch();
        Self::Terminal
    }

    /// Renders a picture; none when the work is to stop.
    fn render(&self, done: u32, count: u32, backend: &Backend, shot: &Shot) -> Result<Option<RgbImage>, Error> {
        let picture = match self {
            Self::Terminal if interrupt::is_asked() => return Ok(None),
            Self::Terminal => watched(format!("haze: picture {} of {count}", done + 1), || backend.render(shot))?,
            Self::Caller(go_on) if !go_on(done, count) => return Ok(None),
            Self::Caller(_) => backend.render(shot)?,
        };
        Ok(Some(develop(&picture, shot)))
    }
}

impl Frames {
    fn count(&self) -> u32 {
        self.range.end() - self.range.start() + 1
    }

    /// Renders every frame, and hands it on with its number. `unfinished` says what is there when it is stopped after so many.
    fn render(
        &self,
        backend: &Backend,
        shot: &Shot,
        watch: &Watch<'_>,
        mut take: impl FnMut(u32, RgbImage) -> Result<(), Error>,
        unfinished: impl Fn(u32) -> Error,
    ) -> Result<(), Error> {
        for (done, frame) in (0..).zip(self.range.clone()) {
            let mut shot = shot.clone();
            shot.preset.time += frame as f32 / self.rate;
            let picture = watch.render(done, self.count(), backend, &shot)?.ok_or_else(|| unfinished(done))?;
            take(frame, picture)?;
        }
        Ok(())
    }
}

fn stopped(path: &Path, what: String) -> Error {
    Error::Io { path: path.into(), error: IoError::new(ErrorKind::Interrupted, format!("stopped: {what}")) }
}

/// Nothing is written of what is one file.
fn unfinished(path: &Path, done: u32, count: u32) -> Error {
    stopped(path, format!("not written, {done} of {count} pictures were done"))
}

/// Writes every frame to a file of its own. Stopped, it leaves those that are done.
pub fn sequence(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    names: &FrameNames,
    effort: Effort,
    watch: &Watch<'_>,
) -> Result<(), Error> {
    let write = |frame, picture: RgbImage| write_png(&names.of(frame), &picture.into(), effort);
    let (first, last) = (*frames.range.start(), *frames.range.end());
    frames.render(backend, shot, watch, write, |done| {
        stopped(
            &names.of(first + done),
            format!("not written; this sequence is partial, {done} of {} frames up to {last}", frames.count()),
        )
    })
}

/// Most pixels along a side of a flipbook.
const MOST_PIXELS: u32 = 32_768;

/// Refuses a flipbook that has no room for its frames, or that there is none for.
pub fn check_flipbook(size: UVec2, frames: &Frames, cells: UVec2) -> Result<(), Error> {
    let (rows, columns) = (cells.x, cells.y);
    let count = frames.count();
    if count > cells.element_product() {
        let expected = format!("room for {count} frames");
        return Err(FieldError::new("--sheet", format!("{rows}x{columns}"), expected).into());
    }
    let size = size * UVec2::new(columns, rows);
    if size.max_element() > MOST_PIXELS {
        let expected = format!("at most {MOST_PIXELS} pixels along a side, not {}x{}", size.x, size.y);
        return Err(FieldError::new("--sheet", format!("{rows}x{columns}"), expected).into());
    }
    check_memory("--sheet", size)
}

/// Renders all frames onto one sheet of `cells` rows and columns. `path` is where it is to go.
pub fn flipbook(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    cells: UVec2,
    path: &Path,
    watch: &Watch<'_>,
) -> Result<RgbImage, Error> {
    let columns = cells.y;
    let size = shot.size * UVec2::new(columns, cells.x);
    let mut sheet = RgbImage::new(size.x, size.y);
    let mut index = 0;
    let place = |_, picture| {
        let corner = UVec2::new(index % columns, index / columns) * shot.size;
        imageops::replace(&mut sheet, &picture, i64::from(corner.x), i64::from(corner.y));
        index += 1;
        Ok(())
    };
    frames.render(backend, shot, watch, place, |done| unfinished(path, done, frames.count()))?;
    Ok(sheet)
}

/// Frames in a second: those of a GIF last whole hundredths of one, and programs make longer those that last less than two.
pub const MOST_GIF_RATE: f32 = 50.0;

/// Writes all frames into one picture that moves, over and over.
pub fn gif(backend: &Backend, shot: &Shot, frames: &Frames, path: &Path, watch: &Watch<'_>) -> Result<(), Error> {
    let failed = |error| Error::Image { path: path.into(), reason: format!("{error}") };
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new_with_speed(&mut bytes, 10);
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let mut index = 0;
    // What is rounded off is not lost: the whole is as long as it should be.
    let end = |index: u32| (index as f32 * 100.0 / frames.rate).round() as u32;
    let encode = |_, picture: RgbImage| {
        let delay = Delay::from_numer_denom_ms(10 * (end(index + 1) - end(index)), 1);
        index += 1;
        let picture = DynamicImage::from(picture).into_rgba8();
        encoder.encode_frame(Frame::from_parts(picture, 0, 0, delay)).map_err(failed)
    };
    frames.render(backend, shot, watch, encode, |done| unfinished(path, done, frames.count()))?;
    drop(encoder);
    write_file(path, &bytes)
}

/// Most pictures of a labelled sheet.
pub const MOST_CELLS: usize = 64;

/// Renders shots with their labels onto one sheet. All are of one size; `path` is where it is to go.
pub fn sheet(
    backend: &Backend,
    cells: &[(String, Shot)],
    columns: u32,
    path: &Path,
    watch: &Watch<'_>,
) -> Result<Sheet, Error> {
    let count = cells.len() as u32;
    let size = cells.first().map_or(UVec2::ONE, |(_, shot)| shot.size);
    let mut sheet = Sheet::new(size, columns, count);
    for (index, (label, shot)) in (0..).zip(cells) {
        let picture = watch.render(index, count, backend, shot)?.ok_or_else(|| unfinished(path, index, count))?;
        sheet.place(index, label, &picture);
    }
    Ok(sheet)
}

/// Columns of a sheet that is about as wide as high.
pub fn columns(count: usize) -> u32 {
    (1..).find(|side| side * side >= count as u32).unwrap_or(1)
}
