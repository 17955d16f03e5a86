//! Composition of one shader text from many files, with a map from its lines back to theirs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use haze_core::error::{PrepareError, one_line};

use super::sources::{File, IMPORT_COLUMN, Sources, import, is_inside};

/// A shader text without imports.
#[derive(Debug, Default)]
pub(crate) struct Composed {
    pub text: String,
    /// File from which the text was composed.
    pub path: PathBuf,
    /// Origin of each line.
    locations: Vec<Location>,
}

#[derive(Clone, Debug)]
struct Location {
    path: Arc<Path>,
    /// 1-based.
    line: usize,
}

impl Composed {
    /// Converts a byte position on a line to a column, all 1-based.
    pub fn column(&self, line: usize, byte: usize) -> usize {
        let text = self.text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
        text.char_indices().take_while(|(at, _)| at + 1 < byte).count() + 1
    }

    /// Creates an error for a line and column of the composed text, located in the file that contains it. Lines beyond
    /// the end count as the last line.
    pub fn error_at(&self, line: usize, column: usize, reason: &str) -> PrepareError {
        let index = line.clamp(1, self.locations.len().max(1)) - 1;
        let (path, line) = match self.locations.get(index) {
            Some(location) => (&*location.path, location.line),
            None => (&*self.path, 1),
        };
        PrepareError::Shader { path: path.into(), line, column, reason: one_line(reason) }
    }
}

impl Sources {
    /// Composes the file of a pass.
    pub(super) fn compose(&self, name: &str) -> Result<Composed, PrepareError> {
        match self.find(name) {
            Some(file) => self.compose_file(file),
            None => self.compose_text(""),
        }
    }

    /// Composes a text that has no file name.
    pub(super) fn compose_text(&self, text: &str) -> Result<Composed, PrepareError> {
        self.compose_file(&File::embedded("", text.to_owned()))
    }

    fn compose_file(&self, file: &File) -> Result<Composed, PrepareError> {
        let composed = Composed { text: String::new(), path: file.path.to_path_buf(), locations: Vec::new() };
        let mut composer = Composer { sources: self, composed, done: Vec::new(), open: Vec::new() };
        composer.append(file)?;
        Ok(composer.composed)
    }
}

struct Composer<'a> {
    sources: &'a Sources,
    composed: Composed,
    /// Files imported so far.
    done: Vec<&'a str>,
    /// Chain of files from the pass's own to the one that is being read.
    open: Vec<&'a str>,
}

impl<'a> Composer<'a> {
    fn append(&mut self, file: &'a File) -> Result<(), PrepareError> {
        self.open.push(&file.name);
        for (line, text) in (1..).zip(file.text.lines()) {
            let Some(import) = import(text) else {
                self.composed.text.push_str(text);
                self.composed.text.push('\n');
                self.composed.locations.push(Location { path: file.path.clone(), line });
                continue;
            };
            let refuse = |reason| Err(file.error_at(line, IMPORT_COLUMN, reason));
            if let Some(start) = self.open.iter().position(|open| *open == import) {
                let circle = [&self.open[start..], &[import]].concat().join(" → ");
                return refuse(format!("circular import: {circle}"));
            }
            if self.done.contains(&import) {
                continue;
            }
            let Some(imported) = self.sources.find(import) else {
                let expected = if is_inside(import) { "" } else { "; expected a .wgsl file inside the folder" };
                return refuse(format!("there is no shader file {import:?} to import{expected}"));
            };
            self.done.push(&imported.name);
            self.append(imported)?;
        }
        self.open.pop();
        Ok(())
    }
}
