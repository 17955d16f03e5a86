//! Where shaders come from: those that are embedded, or files of a folder in their place.

use std::borrow::Cow;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::embedded::SOURCES;
use super::words::unclosed;
use crate::assets::{builtin, file};
use crate::error::{Error, one_line};

/// Largest file that is read, bytes: the longest of haze's own has some ten thousand.
const MAX_BYTES: u64 = 1 << 20;
/// Most files, imported ones and all. A chain of imports is followed no deeper.
const MAX_FILES: usize = 256;

const IMPORT: &str = "#import ";
/// Where the name begins on the line of an import.
pub(super) const IMPORT_COLUMN: usize = IMPORT.len() + 1;

/// The shaders of a [`Context`](crate::Context): haze's own, or an author's in place of them. A clone is the same sources.
#[derive(Clone, Debug)]
pub struct Sources {
    files: Arc<[File]>,
    /// Where files would be that are imported, and are not there.
    missing: Arc<[PathBuf]>,
}

#[derive(Debug)]
pub(super) struct File {
    /// As imports have it.
    pub name: Cow<'static, str>,
    /// As messages have it.
    pub path: Arc<Path>,
    pub text: Cow<'static, str>,
    is_embedded: bool,
}

impl Sources {
    /// The shaders that haze is built with.
    pub fn embedded() -> Self {
        let files = SOURCES.iter().map(|&(name, text)| File::embedded(name, text)).collect();
        Self { files, missing: Arc::default() }
    }

    /// Reads a folder like haze's own `shaders/`: every file that it has takes the place of the embedded one of that name, so
    /// an author keeps only those that differ. Files of other names are read where one of these imports them, by their path
    /// inside the folder, with `/`. Nothing is compiled yet.
    ///
    /// UTF-8, with or without a byte order mark; lines end in LF or CRLF. At most 1 MiB a file, 256 files.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder, or a file in it, cannot be read, or if no file in it has the name of an embedded one:
    /// it would change nothing, and is another folder than was meant. [`Error::Shader`] for a file that is not UTF-8.
    pub fn from_folder(folder: impl AsRef<Path>) -> Result<Self, Error> {
        let folder = folder.as_ref();
        let io = |error| Error::Io { path: folder.into(), error };
        let refuse = |found| {
            let passes: Vec<_> = SOURCES.iter().map(|(name, _)| *name).filter(|name| !name.contains('/')).collect();
            let reason = format!("{found}; expected {} or a file of lib/ in it", passes.join(", "));
            Err(io(io::Error::new(ErrorKind::InvalidData, reason)))
        };
        if !std::fs::metadata(folder).map_err(io)?.is_dir() {
            return refuse("not a folder");
        }
        let mut files = Vec::new();
        for &(name, text) in SOURCES {
            files.push(File::read(folder, name)?.unwrap_or_else(|| File::embedded(name, text)));
        }
        if files.iter().all(|file| file.is_embedded) {
            return refuse("a folder without any of haze's shaders");
        }
        let (mut next, mut missing) = (0, Vec::new());
        while let Some(file) = files.get(next) {
            let mut imported = Vec::new();
            for (line, name) in imports(&file.text) {
                let is_known = |files: &[File]| files.iter().any(|file| file.name == name);
                // One that is not there is named where the text is composed.
                if !is_inside(name) || is_known(&files) || is_known(&imported) {
                    continue;
                }
                if files.len() + imported.len() == MAX_FILES {
                    return Err(file.mistake(line, IMPORT_COLUMN, format!("more than {MAX_FILES} files")));
                }
                match File::read(folder, name)? {
                    Some(file) => imported.push(file),
                    None => missing.push(folder.join(name)),
                }
            }
            files.append(&mut imported);
            next += 1;
        }
        Ok(Self { files: files.into(), missing: missing.into() })
    }

    /// What is to be watched: the files that were read, none of those that are embedded, and where those would be that are
    /// imported and were not there.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let read = self.files.iter().filter(|file| !file.is_embedded).map(|file| &*file.path);
        read.chain(self.missing.iter().map(PathBuf::as_path))
    }

    /// A bracket that an author left open.
    pub(super) fn unclosed(&self) -> Option<Error> {
        let own = self.files.iter().filter(|file| !file.is_embedded);
        own.filter_map(|file| Some((file, unclosed(&file.text)?)))
            .map(|(file, (line, column, bracket))| file.mistake(line, column, format!("`{bracket}` is never closed")))
            .next()
    }

    pub(super) fn find(&self, name: &str) -> Option<&File> {
        self.files.iter().find(|file| file.name == name)
    }
}

impl File {
    pub fn embedded(name: &'static str, text: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), path: builtin::path(name).into(), text: text.into(), is_embedded: true }
    }

    /// A file of the folder; `None` if it is not there.
    fn read(folder: &Path, name: &str) -> Result<Option<Self>, Error> {
        let path: Arc<Path> = folder.join(name).into();
        let bytes = match file::read(&path, "WGSL file", MAX_BYTES) {
            Err(Error::Io { error, .. }) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read?,
        };
        let text = match String::from_utf8(bytes) {
            Ok(text) => text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text),
            Err(error) => {
                let good = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
                let (line, column) = end_of(&good);
                let reason = "not a text; expected UTF-8".to_owned();
                return Err(Error::Shader { path: path.to_path_buf(), line, column, reason });
            }
        };
        Ok(Some(Self { name: name.to_owned().into(), path, text: text.into(), is_embedded: false }))
    }

    /// A mistake in this file.
    pub fn mistake(&self, line: usize, column: usize, reason: String) -> Error {
        Error::Shader { path: self.path.to_path_buf(), line, column, reason: one_line(reason) }
    }
}

/// Line and column of what follows a text.
fn end_of(text: &str) -> (usize, usize) {
    let last = text.rsplit('\n').next().unwrap_or_default();
    (text.matches('\n').count() + 1, last.chars().count() + 1)
}

/// True for a path of a shader that cannot lead out of the folder.
pub(super) fn is_inside(name: &str) -> bool {
    name.ends_with(".wgsl")
        && !name.contains(char::is_control)
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// The file that a line imports.
pub(super) fn import(line: &str) -> Option<&str> {
    Some(line.strip_prefix(IMPORT)?.trim().trim_matches('"'))
}

/// The imports of a text, with their lines.
fn imports(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter_map(|(line, text)| Some((line, import(text)?)))
}
