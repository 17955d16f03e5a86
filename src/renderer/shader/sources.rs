//! Shader sources: the embedded files, or files of a folder that replace them.

use std::borrow::Cow;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use haze_core::assets::bounded_read;
use haze_core::error::{AssetError, PrepareError, builtin_path, one_line};

use super::embedded::SOURCES;
use super::naga_messages::find_unclosed_bracket;

/// Maximum size of a file, bytes. The longest of haze's own has about 10,000.
const MAX_BYTES: u64 = 1 << 20;
/// Maximum number of files, including imported ones. It also limits the depth of import chains.
const MAX_FILES: usize = 256;

const IMPORT: &str = "#import ";
/// Column of the file name on an import line, 1-based.
pub(super) const IMPORT_COLUMN: usize = IMPORT.len() + 1;

/// Shader sources of a [`Context`](crate::Context): haze's own, or custom files that replace some sources. A clone
/// shares the same sources.
#[derive(Clone, Debug)]
pub struct Sources {
    files: Arc<[File]>,
    /// Paths of imported files that do not exist.
    missing: Arc<[PathBuf]>,
}

#[derive(Debug)]
pub(super) struct File {
    /// Name that imports use.
    pub name: Cow<'static, str>,
    /// Path that messages show.
    pub path: Arc<Path>,
    pub text: Cow<'static, str>,
    is_embedded: bool,
}

impl Sources {
    /// Returns the embedded shaders.
    pub fn embedded() -> Self {
        let files = SOURCES.iter().map(|&(name, text)| File::embedded(name, text)).collect();
        Self { files, missing: Arc::default() }
    }

    /// Reads a folder that is laid out like haze's own `shaders/`. Each of its files replaces the embedded file of the
    /// same name, so the folder needs only the files that differ. Files with other names are read if one of these files
    /// imports them, by their path inside the folder, with `/`. Nothing is compiled yet.
    ///
    /// Files are UTF-8, with or without a byte order mark; lines end in LF or CRLF. Limits: 1 MiB per file, 256 files.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the folder or a file in it cannot be read, or if no file in it has the name of an embedded one:
    /// such a folder would change nothing and is probably the wrong one. [`AssetError::Text`] for a file that is not UTF-8,
    /// or for more than 256 files.
    pub fn from_folder(folder: impl AsRef<Path>) -> Result<Self, AssetError> {
        let folder = folder.as_ref();
        let io = |error| AssetError::Io { path: folder.into(), error };
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
        let mut next = 0;
        let mut missing = Vec::new();
        while let Some(file) = files.get(next) {
            let mut imported = Vec::new();
            for (line, name) in imports(&file.text) {
                let is_known = |files: &[File]| files.iter().any(|file| file.name == name);
                // Composition reports missing files.
                if !is_inside(name) || is_known(&files) || is_known(&imported) {
                    continue;
                }
                if files.len() + imported.len() == MAX_FILES {
                    let path = file.path.to_path_buf();
                    let reason = format!("more than {MAX_FILES} files");
                    return Err(AssetError::Text { path, line, column: IMPORT_COLUMN, reason });
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

    /// Returns the paths to watch for changes: the files that were read (not the embedded ones), and the paths of
    /// imported files that do not exist.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let read = self.files.iter().filter(|file| !file.is_embedded).map(|file| &*file.path);
        read.chain(self.missing.iter().map(PathBuf::as_path))
    }

    /// Returns an error for the first custom file that leaves a bracket open.
    pub(super) fn find_unclosed_bracket(&self) -> Option<PrepareError> {
        let own = self.files.iter().filter(|file| !file.is_embedded);
        own.filter_map(|file| Some((file, find_unclosed_bracket(&file.text)?)))
            .map(|(file, (line, column, bracket))| file.error_at(line, column, format!("`{bracket}` is never closed")))
            .next()
    }

    pub(super) fn find(&self, name: &str) -> Option<&File> {
        self.files.iter().find(|file| file.name == name)
    }
}

impl File {
    pub fn embedded(name: &'static str, text: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), path: builtin_path(name).into(), text: text.into(), is_embedded: true }
    }

    /// Reads a file of the folder; `None` if it does not exist.
    fn read(folder: &Path, name: &str) -> Result<Option<Self>, AssetError> {
        let path: Arc<Path> = folder.join(name).into();
        let bytes = match bounded_read::read(&path, "WGSL file", MAX_BYTES) {
            Err(AssetError::Io { error, .. }) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read?,
        };
        let text = match String::from_utf8(bytes) {
            Ok(text) => text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text),
            Err(error) => {
                let good = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
                let (line, column) = end_of(&good);
                let reason = "not a text file; expected UTF-8".to_owned();
                return Err(AssetError::Text { path: path.to_path_buf(), line, column, reason });
            }
        };
        Ok(Some(Self { name: name.to_owned().into(), path, text: text.into(), is_embedded: false }))
    }

    /// Creates an error in this file.
    pub fn error_at(&self, line: usize, column: usize, reason: String) -> PrepareError {
        PrepareError::Shader { path: self.path.to_path_buf(), line, column, reason: one_line(reason) }
    }
}

/// Returns line and column of the position behind a text, 1-based.
fn end_of(text: &str) -> (usize, usize) {
    let last = text.rsplit('\n').next().unwrap_or_default();
    (text.matches('\n').count() + 1, last.chars().count() + 1)
}

/// Returns true for the path of a shader file that cannot lead out of the folder.
pub(super) fn is_inside(name: &str) -> bool {
    name.ends_with(".wgsl")
        && !name.contains(char::is_control)
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// Returns the file that a line imports; `None` for any other line.
pub(super) fn import(line: &str) -> Option<&str> {
    Some(line.strip_prefix(IMPORT)?.trim().trim_matches('"'))
}

/// Returns the imports of a text, with their 1-based lines.
fn imports(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter_map(|(line, text)| Some((line, import(text)?)))
}
