//! Frame ranges, and the file names of frames.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::FieldError;

/// Most frames of one run.
const MAX_FRAMES: u32 = 100_000;

/// Most images along a side of a sheet.
const MAX_SHEET_SIDE: u32 = 64;

/// Parses `A..B`, both included.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_frames(text: &str) -> Result<RangeInclusive<u32>, String> {
    let frames = text.split_once("..").and_then(|(first, last)| Some(first.parse().ok()?..=last.parse().ok()?));
    let fits = |frames: &RangeInclusive<u32>| !frames.is_empty() && frames.end() - frames.start() < MAX_FRAMES;
    frames.filter(fits).ok_or_else(|| {
        format!("{text:?} is not a range of frames; expected A..B, at most {MAX_FRAMES} frames, for example 0..59")
    })
}

/// Parses frames per second.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_rate(text: &str) -> Result<f32, String> {
    let rate = text.parse().ok().filter(|rate| (0.001..=10_000.0).contains(rate));
    rate.ok_or_else(|| format!("{text:?} is not a frame rate; expected 0.001 to 10000 frames per second"))
}

/// Parses rows and columns of a sheet, `RxC`, as columns and rows.
///
/// # Errors
/// A line that says what is expected.
pub fn parse_sheet(text: &str) -> Result<UVec2, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=MAX_SHEET_SIDE).contains(side));
    let cells = text.split_once(['x', 'X']).and_then(|(rows, columns)| Some(UVec2::new(side(rows)?, side(columns)?)));
    cells.ok_or_else(|| {
        format!("{text:?} is not a sheet layout; expected ROWSxCOLUMNS, each 1 to {MAX_SHEET_SIDE}, for example 4x8")
    })
}

/// File names that contain the number of a frame.
pub struct FrameNames {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl FrameNames {
    /// Parses a name such as `f_%04d.png`: the number replaces `%04d`, padded with zeros to at least four digits.
    pub fn parse(path: &Path) -> Result<Self, FieldError> {
        let refuse = || {
            FieldError::new(
                "--output",
                path.display(),
                "a name with one place for the frame number, for example f_%04d.png",
            )
        };
        let name = path.file_name().and_then(|name| name.to_str()).ok_or_else(refuse)?;
        let (before, rest) = name.split_once('%').ok_or_else(refuse)?;
        let (digits, after) = rest.split_once('d').ok_or_else(refuse)?;
        let digits = match digits.strip_prefix('0') {
            None if digits.is_empty() => 0,
            Some(digits) => digits.parse().ok().filter(|digits| (1..=9).contains(digits)).ok_or_else(refuse)?,
            None => return Err(refuse()),
        };
        if after.contains('%') {
            return Err(refuse());
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { folder, before: before.into(), digits, after: after.into() })
    }

    /// File name of a frame.
    pub fn of(&self, frame: u32) -> PathBuf {
        let Self { folder, before, digits, after } = self;
        folder.join(format!("{before}{frame:0digits$}{after}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_names_contain_the_frame_number() {
        let name = |text: &str, frame| Some(FrameNames::parse(Path::new(text)).ok()?.of(frame));
        assert_eq!(name("a/f_%04d.png", 7), Some("a/f_0007.png".into()));
        assert_eq!(name("%d.png", 70_000), Some("70000.png".into()));
        assert_eq!(name("%02d.png", 123), Some("123.png".into()));
        for wrong in ["f.png", "f_%4d.png", "f_%s.png", "%d_%d.png", "f_%00d.png", "a%d/f.png", "f%"] {
            assert_eq!(name(wrong, 1), None, "{wrong}");
        }
    }

    #[test]
    fn frame_ranges_are_neither_empty_nor_endless() {
        assert_eq!(parse_frames("3..9"), Ok(3..=9));
        assert_eq!(parse_frames("3..3"), Ok(3..=3));
        for wrong in ["9..3", "3", "..", "-1..4", "0..100000", "a..b"] {
            assert!(parse_frames(wrong).is_err(), "{wrong}");
        }
    }
}
