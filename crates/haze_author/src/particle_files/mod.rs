//! Particles that a simulation has left in files: CSV or PLY, one file or one a frame, as Blender and Houdini write them.
//!
//! All frames are read at once and kept, 40 bytes a particle: any time can be had in any order and at once, a window that is
//! scrubbed waits for no disk, and a broken frame is found before the first picture. [`Limits`] says how much that may be.

mod columns;
mod csv;
mod evaluate;
mod frame;
mod mistake;
mod ply;
mod preset;
mod role;

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

use haze::assets::file;
use haze::error::Error;

pub use frame::{CacheFrame, CachedParticle, Given};
pub use mistake::Mistake;
pub use preset::{MAX_CACHE_BYTES, check_caches, emission, load_caches, particles};

/// Largest file of a frame, bytes.
pub const MAX_FILE_BYTES: u64 = 256 << 20;

/// Most that is read.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Particles of one frame.
    pub particles: usize,
    /// Bytes in memory, of all frames.
    pub bytes: u64,
}

/// The frames of a simulation. A clone is the same frames in the same memory.
#[derive(Clone, Debug)]
pub struct Cache(Arc<[(u32, CacheFrame)]>);

/// What there is between two frames.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// The frame at this time or before it.
    pub before: &'a CacheFrame,
    /// The one that follows, if there is one.
    pub after: Option<&'a CacheFrame>,
    /// How much of the way to it has passed, 0 to 1.
    pub share: f32,
}

impl Cache {
    /// Reads a file, or the files that the `#` of a path's name stand for: digits of the frame's number.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Json`] with line and column for CSV, ASCII PLY and headers, and [`Error::Image`] for the rest, with
    /// vertex and byte in binary PLY.
    pub fn load(path: &Path, limits: Limits) -> Result<Self, Error> {
        let (mut frames, mut bytes) = (Vec::new(), 0);
        for (number, file) in haze::preset::frame_files(path)? {
            let content = file::read(&file, "CSV or PLY file", MAX_FILE_BYTES)?;
            let frame = parse(&file, &content, limits.particles).map_err(|mistake| mistake.of(&file))?;
            bytes += frame.bytes();
            if bytes > limits.bytes {
                let [found, most] = [bytes, limits.bytes].map(|bytes| bytes.div_ceil(1 << 20));
                let reason = format!("{found} MiB of particles up to this frame; expected at most {most} MiB");
                return Err(Error::Image { path: file, reason });
            }
            frames.push((number, frame));
        }
        Ok(Self(frames.into()))
    }

    /// The frames in their order, with their numbers.
    pub fn frames(&self) -> &[(u32, CacheFrame)] {
        &self.0
    }

    /// Most particles of one frame.
    pub fn most(&self) -> usize {
        self.0.iter().map(|(_, frame)| frame.particles().len()).max().unwrap_or_default()
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(|(_, frame)| frame.bytes()).sum()
    }

    /// Frames from the first to the last, those between them that are missing too.
    pub fn length(&self) -> u32 {
        self.0.last().map_or(1, |(last, _)| last - self.first() + 1)
    }

    /// What there is at a time, in frames from the first one on; the last stays. Nothing before the first.
    pub fn around(&self, frame: f64) -> Option<Around<'_>> {
        let number = frame + f64::from(self.first());
        let next = self.0.partition_point(|(at, _)| f64::from(*at) <= number);
        let (start, before) = self.0.get(next.checked_sub(1)?)?;
        let Some((end, after)) = self.0.get(next) else {
            return Some(Around { before, after: None, share: 0.0 });
        };
        let share = ((number - f64::from(*start)) / f64::from(end - start)) as f32;
        Some(Around { before, after: Some(after), share })
    }

    /// True if both are the very same frames.
    pub fn shares(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// The same of every system.
    pub fn all_shared(some: &[Option<Self>], others: &[Option<Self>]) -> bool {
        let shares = |(one, other): (&Option<Self>, &Option<Self>)| match (one, other) {
            (Some(one), Some(other)) => one.shares(other),
            (None, None) => true,
            _ => false,
        };
        some.len() == others.len() && some.iter().zip(others).all(shares)
    }

    fn first(&self) -> u32 {
        self.0.first().map_or(0, |(first, _)| *first)
    }
}

/// Reads one frame. The path's ending tells what it is: that and no more is looked at.
///
/// # Errors
/// What is wrong with it, and where.
pub fn parse(path: &Path, content: &[u8], most: usize) -> Result<CacheFrame, Mistake> {
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case(OsStr::new("ply")) => ply::read(content, most),
        _ => csv::read(content, most),
    }
}

#[cfg(test)]
mod tests;
