//! Frames of a simulation in memory, loaded from one file or one file per frame.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use haze_core::assets::bounded_read;
use haze_core::error::AssetError;

use super::file_frame::{ColumnUse, FileFrame, Scales, UnknownScale};
use super::parse_error::ParseError;
use super::particle_frame::ParticleFrame;
use super::{csv_reader, ply};

/// Size limit of one file, bytes.
pub const MAX_FILE_BYTES: u64 = 256 << 20;

/// Limits of a load.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Maximum number of particles in one frame.
    pub particles: usize,
    /// Maximum size of all frames in memory, bytes.
    pub bytes: u64,
}

/// Frames of a simulation, sorted by frame number. A clone shares the memory.
#[derive(Clone, Debug)]
pub struct ParticleFrames {
    frames: Arc<[(u32, ParticleFrame)]>,
    /// Use of the columns of each file that differs from the files before it.
    columns: Arc<[(PathBuf, ColumnUse)]>,
}

/// The two frames around a time, and the position between them.
#[derive(Clone, Copy, Debug)]
pub struct FramePair<'a> {
    /// The frame at this time or before it.
    pub before: &'a ParticleFrame,
    /// The next frame, if there is one.
    pub after: Option<&'a ParticleFrame>,
    /// Fraction of the interval to the next frame that has passed, 0 to 1.
    pub fraction: f32,
}

impl ParticleFrames {
    /// Loads one file, or a sequence if the file name contains `#` instead of the frame number's digits.
    ///
    /// # Errors
    /// [`AssetError::Io`]; [`AssetError::Text`] with line and column for CSV, ASCII PLY and PLY headers; [`AssetError::Image`] for
    /// everything else, with vertex and byte offset for binary PLY.
    pub fn load(path: &Path, limits: Limits) -> Result<Self, AssetError> {
        let mut files = Vec::new();
        let mut frames = Vec::new();
        let mut bytes = 0;
        for (number, file) in haze_preset::frame_files(path)? {
            let content = bounded_read::read(&file, "CSV or PLY file", MAX_FILE_BYTES)?;
            let frame = read(&file, &content, limits.particles).map_err(|error| error.into_error(&file))?;
            bytes += frame.frame.bytes();
            if bytes > limits.bytes {
                let [found, limit] = [bytes, limits.bytes].map(|bytes| bytes.div_ceil(1 << 20));
                let reason = format!("{found} MiB of particles up to this frame; expected at most {limit} MiB");
                return Err(AssetError::Image { path: file, reason });
            }
            files.push((number, file));
            frames.push(frame);
        }
        let scales = Scales::of_frames(&frames).map_err(|UnknownScale { frame, reason }| {
            let file = files.get(frame).map(|(_, file)| file.clone());
            AssetError::Image { path: file.unwrap_or_else(|| path.into()), reason }
        })?;
        let mut columns: Vec<(PathBuf, ColumnUse)> = Vec::new();
        for ((_, file), frame) in files.iter().zip(&frames) {
            let column_use = scales.column_use(&frame.columns);
            if !columns.iter().any(|(_, known)| *known == column_use) {
                columns.push((file.clone(), column_use));
            }
        }
        let frames = files.iter().zip(frames).map(|((number, _), frame)| (*number, frame.decode(&scales)));
        Ok(Self { frames: frames.collect(), columns: columns.into() })
    }

    /// Returns the use of the columns, with the first file that has them so.
    pub fn columns(&self) -> &[(PathBuf, ColumnUse)] {
        &self.columns
    }

    /// Returns the frames in order, with their numbers.
    pub fn frames(&self) -> &[(u32, ParticleFrame)] {
        &self.frames
    }

    /// Returns the largest number of particles in one frame.
    pub fn max_particles(&self) -> usize {
        self.frames.iter().map(|(_, frame)| frame.particles().len()).max().unwrap_or_default()
    }

    /// Returns the size in memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.frames.iter().map(|(_, frame)| frame.bytes()).sum()
    }

    /// Returns the number of frames from the first to the last, including missing ones between them.
    pub fn frame_count(&self) -> u32 {
        self.frames.last().map_or(1, |(last, _)| last - self.first() + 1)
    }

    /// Returns the frames around a time, in frames since the first. `None` before the first frame; after the last
    /// frame, the last one with nothing after it.
    pub fn frames_around(&self, frame: f64) -> Option<FramePair<'_>> {
        let number = frame + f64::from(self.first());
        let next = self.frames.partition_point(|(at, _)| f64::from(*at) <= number);
        let (start, before) = self.frames.get(next.checked_sub(1)?)?;
        let Some((end, after)) = self.frames.get(next) else {
            return Some(FramePair { before, after: None, fraction: 0.0 });
        };
        let fraction = ((number - f64::from(*start)) / f64::from(end - start)) as f32;
        Some(FramePair { before, after: Some(after), fraction })
    }

    /// True if both share the same memory.
    pub fn shares_memory(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.frames, &other.frames)
    }

    /// True if both lists share the same memory in every entry.
    pub fn share_all_memory(some: &[Option<Self>], others: &[Option<Self>]) -> bool {
        let shares_memory = |(one, other): (&Option<Self>, &Option<Self>)| match (one, other) {
            (Some(one), Some(other)) => one.shares_memory(other),
            (None, None) => true,
            _ => false,
        };
        some.len() == others.len() && some.iter().zip(others).all(shares_memory)
    }

    fn first(&self) -> u32 {
        self.frames.first().map_or(0, |(first, _)| *first)
    }
}

/// Parses a simulation of one frame. The format follows from the path's extension: PLY for `.ply`, otherwise CSV. The path is not
/// opened.
///
/// # Errors
/// A [`ParseError`] with the position, if the content is malformed.
pub fn parse(path: &Path, content: &[u8], max_particles: usize) -> Result<ParticleFrame, ParseError> {
    let frame = read(path, content, max_particles)?;
    let scales = Scales::of_frames(std::slice::from_ref(&frame));
    let scales = scales.map_err(|UnknownScale { reason, .. }| ParseError::WholeFile(reason))?;
    Ok(frame.decode(&scales))
}

fn read(path: &Path, content: &[u8], max_particles: usize) -> Result<FileFrame, ParseError> {
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case(OsStr::new("ply")) => ply::read(content, max_particles),
        _ => csv_reader::read(content, max_particles),
    }
}
