//! Sequences of files with one file per frame. `#` in the file name stands for the digits of the frame number.

use std::io::{Error as IoError, ErrorKind};
use std::path::{Path, PathBuf};

use haze_core::error::AssetError;

use crate::directory;

/// Maximum number of folder entries that are examined.
const MAX_FOLDER_ENTRIES: usize = 100_000;

/// Maximum number of frames.
const MAX_FRAMES: usize = 10_000;

/// File name pattern like `smoke_####.ply`: frame numbers are zero-padded to the number of `#` and may have more
/// digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Sequence {
    /// Parses the pattern of a path. `None` if the file name has no `#` or more than one run of `#`.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let start = name.find('#')?;
        let digits = name[start..].bytes().take_while(|byte| *byte == b'#').count();
        let after = &name[start + digits..];
        let folder = path.parent().unwrap_or(Path::new("")).into();
        (!after.contains('#')).then(|| Self { folder, before: name[..start].into(), digits, after: after.into() })
    }

    /// Returns the frame number of a file name that matches the pattern.
    fn number(&self, name: &str) -> Option<u32> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
        let is_padded = digits.len() == self.digits || digits.len() > self.digits && !digits.starts_with('0');
        digits.parse().ok().filter(|_| is_number && is_padded)
    }

    /// Returns the path of a frame; the file need not exist.
    fn file(&self, number: u32) -> PathBuf {
        self.folder.join(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }

    /// Lists the existing frames in order.
    fn frames(&self) -> Result<Vec<(u32, PathBuf)>, IoError> {
        let names = directory::names(&self.folder)?.take(MAX_FOLDER_ENTRIES);
        let mut frames: Vec<_> = names.filter_map(|name| Some((self.number(&name)?, self.folder.join(name)))).collect();
        frames.sort();
        Ok(frames)
    }
}

/// Lists the files of a path with their frame numbers. A path without `#` is frame 0.
pub fn frame_files(path: &Path) -> Result<Vec<(u32, PathBuf)>, AssetError> {
    let Some(sequence) = Sequence::of(path) else { return Ok(vec![(0, path.into())]) };
    let io = |error| AssetError::Io { path: path.into(), error };
    let frames = sequence.frames().map_err(io)?;
    if frames.is_empty() {
        let reason = "no such files; expected names with digits in place of #";
        return Err(io(IoError::new(ErrorKind::NotFound, reason)));
    }
    if frames.len() > MAX_FRAMES {
        let reason = format!("{} files; expected at most {MAX_FRAMES} frames", frames.len());
        return Err(io(IoError::new(ErrorKind::InvalidData, reason)));
    }
    Ok(frames)
}

/// True if the file, or at least one frame of the sequence, exists. Also true if the path cannot be examined: reading
/// it then reports the reason.
pub fn exists(path: &Path) -> bool {
    match Sequence::of(path) {
        Some(sequence) => sequence.frames().is_ok_and(|frames| !frames.is_empty()),
        None => directory::is_taken(path),
    }
}

/// Returns the paths to watch for changes: every existing file of the path, and the next frame.
pub fn watched_paths(path: &Path) -> Vec<PathBuf> {
    let Some(sequence) = Sequence::of(path) else { return vec![path.into()] };
    let frames = sequence.frames().unwrap_or_default();
    let next = frames.last().map_or(1, |(last, _)| last.saturating_add(1));
    frames.into_iter().take(MAX_FRAMES).map(|(_, file)| file).chain([sequence.file(next)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_numbers_are_parsed_in_place_of_the_hash_signs() {
        let sequence = Sequence::of(Path::new("sim/smoke_####.ply")).unwrap();
        for (name, number) in [
            ("smoke_0001.ply", Some(1)),
            ("smoke_12345.ply", Some(12345)),
            ("smoke_00001.ply", None),
            ("smoke_001.ply", None),
            ("smoke_+001.ply", None),
            ("smoke_0001.csv", None),
            ("smoke_.ply", None),
            ("smoke_99999999999.ply", None),
        ] {
            assert_eq!(sequence.number(name), number, "{name}");
        }
        assert_eq!(sequence.file(7), Path::new("sim/smoke_0007.ply"));
        assert_eq!(Sequence::of(Path::new("#.csv")).unwrap().number("120.csv"), Some(120));
        assert!(["a.ply", "a_#_#.ply", "#/a.ply"].iter().all(|path| Sequence::of(Path::new(path)).is_none()));
    }

    #[test]
    fn existing_frames_are_listed_in_order_and_the_next_one_is_watched() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let pattern = path("s##.csv");
        assert!(!exists(&pattern) && watched_paths(&pattern) == [path("s01.csv")]);
        let error = frame_files(&pattern).unwrap_err().to_string();
        assert!(error.ends_with("s##.csv: no such files; expected names with digits in place of #"), "{error}");
        for name in ["s100.csv", "s09.csv", "s10.csv", "s1.csv", "other.csv"] {
            std::fs::write(path(name), "").unwrap();
        }
        let numbers: Vec<_> = frame_files(&pattern).unwrap().into_iter().map(|(number, _)| number).collect();
        assert_eq!(numbers, [9, 10, 100]);
        assert!(exists(&pattern) && watched_paths(&pattern).last() == Some(&path("s101.csv")));
        assert!(exists(&path("s1.csv")) && !exists(&path("s2.csv")));
    }
}
