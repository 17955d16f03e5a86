//! A preset while it is worked on.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};

use haze::preset::{PictureFolders, Preset};
use haze::{Error, FieldError, builtin};

use super::history::History;
use super::pictures::copy_beside;
use super::recipes::{GradientStep, Recipes, Work, name_of};
use crate::inputs::pictures_of;
use crate::tweak::platform::assets::caches_of;
use crate::tweak::platform::files::{self, Stamp};

/// A preset, where it came from, and how it got to be what it is.
pub struct Document {
    /// What panels change.
    pub preset: Preset,
    /// What panels change of ramps; they are written as soon as a step is done.
    pub recipes: Recipes,
    history: History<Work>,
    /// What is being done to stops, for the name of that step.
    gradient_step: Option<GradientStep>,
    /// A file, or the name of a built-in preset.
    path: PathBuf,
    /// What is in the file, if it is known.
    saved: Option<Preset>,
    /// The text of the file as it was read or written last.
    text: String,
    /// The file when its text was that; none where it has to be read to know.
    stamp: Option<Stamp>,
    /// What is being written over it elsewhere, as long as it is.
    writing: Weak<String>,
}

/// A document as it is to be saved: all that it takes to write it, on any thread.
pub struct Saving {
    preset: Preset,
    text: Arc<String>,
    /// Where its pictures are, and where it goes.
    from: PathBuf,
    path: PathBuf,
}

impl Saving {
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file, and the pictures that the preset names where it goes into another folder.
    pub fn write(&self) -> Result<(), Error> {
        let folder = |path: &Path| path.parent().unwrap_or(Path::new("")).to_path_buf();
        copy_beside(&self.preset, &folder(&self.from), &folder(&self.path))?;
        files::write(&self.path, self.text.as_bytes())
    }
}

/// How the file is, compared with what was read from it or written to it last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnDisk {
    /// It is the same.
    Same,
    /// Another program has written it.
    Changed,
    /// It is not there.
    Gone,
}

impl Document {
    /// Opens a file, or a built-in preset by name.
    pub fn open(name_or_path: &Path) -> Result<Self, Error> {
        // Before it is read: written in between, it is found to have changed.
        let stamp = Stamp::of(name_or_path);
        let (preset, text) = files::read_preset(name_or_path)?;
        let recipes = Recipes::default();
        let history = History::new((preset.clone(), recipes.clone()));
        let (saved, path) = (Some(preset.clone()), name_or_path.into());
        Ok(Self { saved, preset, recipes, history, gradient_step: None, path, text, stamp, writing: Weak::new() })
    }

    /// What was being done to a preset when the program was ended. The file that it came from need not be there any more.
    pub fn recovered(preset: Preset, name_or_path: &Path) -> Self {
        let mut document = Self::open(name_or_path).unwrap_or_else(|_| Self {
            recipes: Recipes::default(),
            history: History::new((preset.clone(), Recipes::default())),
            gradient_step: None,
            preset: preset.clone(),
            path: name_or_path.into(),
            saved: None,
            text: String::new(),
            stamp: None,
            writing: Weak::new(),
        });
        document.put(preset, "recover");
        document
    }

    /// The file, or the name of the built-in preset: where pictures are looked for.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The files that its picture is made from, of which some may be missing: what is to be watched.
    pub fn files(&self, folders: &PictureFolders) -> Vec<PathBuf> {
        let own = (!self.is_built_in()).then(|| self.path.clone());
        let pictures = pictures_of(folders, &self.preset);
        own.into_iter().chain(pictures).chain(caches_of(folders, &self.preset)).collect()
    }

    /// Whether it has no file yet.
    pub fn is_built_in(&self) -> bool {
        self.path.to_str().and_then(|name| builtin::find(builtin::PRESETS, name)).is_some()
    }

    /// The preset as it is in the file, if it is there: what marks and resets go by.
    pub fn saved(&self) -> Option<&Preset> {
        self.saved.as_ref()
    }

    /// Whether something would be lost without saving.
    pub fn is_dirty(&self) -> bool {
        self.saved.as_ref() != Some(&self.preset)
    }

    /// Begins to save it: [`Saving::write`] does the work, and [`Document::finish_saving`] has to be told of its end.
    pub fn begin_saving(&mut self) -> Result<Saving, Error> {
        if self.is_built_in() {
            let expected = "another name: this preset is built in";
            return Err(FieldError::new("save", self.path.display(), expected).into());
        }
        self.begin_saving_as(&self.path.clone())
    }

    /// What it is called: as its file, or as the built-in preset.
    pub fn title(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Begins to write another file, which is the document's once it is there.
    pub fn begin_saving_as(&mut self, path: &Path) -> Result<Saving, Error> {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
            return Err(FieldError::new("save as", path.display(), "a name that ends in .json").into());
        }
        self.preset.validate()?;
        let text = Arc::new(self.preset.to_text(&self.text));
        self.writing = Arc::downgrade(&text);
        Ok(Saving { preset: self.preset.clone(), text, from: self.path.clone(), path: path.into() })
    }

    /// Being written, it has not come to its end yet.
    pub fn is_being_saved(&self) -> bool {
        self.writing.strong_count() > 0
    }

    /// What was begun has come to its end; of another document, that is nothing to this one.
    pub fn finish_saving(&mut self, saving: Saving, is_written: bool) {
        let Saving { preset, text, path, .. } = saving;
        if is_written && Weak::as_ptr(&self.writing) == Arc::as_ptr(&text) {
            // The next look reads it: another program may have been quicker than a stamp could be taken.
            (self.text, self.stamp, self.saved, self.path) = (text.to_string(), None, Some(preset), path);
        }
    }

    /// Reads the file again; what was changed is one step back.
    pub fn revert(&mut self) -> Result<(), Error> {
        let Self { preset, text, stamp, .. } = Self::open(&self.path)?;
        (self.text, self.stamp, self.saved) = (text, stamp, Some(preset.clone()));
        self.put(preset, "revert");
        Ok(())
    }

    /// Whether another program has written the file. What is saved here does not count.
    pub fn on_disk(&mut self) -> OnDisk {
        if self.is_built_in() {
            return OnDisk::Same;
        }
        let Some(stamp) = Stamp::of(&self.path) else { return OnDisk::Gone };
        if self.stamp == Some(stamp) {
            return OnDisk::Same;
        }
        match files::read_text(&self.path) {
            Ok(text) if text == self.text || self.writing.upgrade().is_some_and(|writing| *writing == text) => {
                self.stamp = Some(stamp);
                OnDisk::Same
            }
            _ => OnDisk::Changed,
        }
    }

    /// Leaves the file as another program has written it, and goes on with what is here, which is not saved then.
    pub fn keep_mine(&mut self) {
        (self.stamp, self.saved) = (Stamp::of(&self.path), None);
    }

    /// The preset as a text, to be pasted elsewhere.
    pub fn to_text(&self) -> String {
        self.preset.to_text("")
    }

    /// Makes it the preset of a text, in one step; what is no preset changes nothing.
    pub fn paste(&mut self, text: &str) -> Result<(), Error> {
        self.put(Preset::parse(Path::new("pasted text"), text)?, "paste");
        Ok(())
    }

    fn put(&mut self, preset: Preset, name: &str) {
        self.track(false);
        self.preset = preset;
        self.history.track(&self.work(), false, |_, _| name.into());
    }

    /// Sees what panels have changed; once a frame, as [`History::track`].
    pub fn track(&mut self, is_held: bool) {
        // Nothing is copied while nothing changes.
        let (preset, recipes) = self.history.settled();
        if *preset == self.preset && *recipes == self.recipes {
            self.history.rest();
            self.gradient_step = None;
        } else {
            let step = self.gradient_step.as_ref();
            let work = (self.preset.clone(), self.recipes.clone());
            self.history.track(&work, is_held, |before, after| name_of(before, after, step));
        }
    }

    /// Says what is being done to the stops of a ramp.
    pub fn name_gradient_step(&mut self, ramp: &str, step: &'static str) {
        self.gradient_step = Some((ramp.into(), step));
    }

    fn work(&self) -> Work {
        (self.preset.clone(), self.recipes.clone())
    }

    /// Takes back a step, and gives its name.
    pub fn undo(&mut self) -> Option<&str> {
        let mut work = self.work();
        let name = self.history.undo(&mut work);
        (self.preset, self.recipes) = work;
        name
    }

    /// Does the last step that was undone again, and gives its name.
    pub fn redo(&mut self) -> Option<&str> {
        let mut work = self.work();
        let name = self.history.redo(&mut work);
        (self.preset, self.recipes) = work;
        name
    }

    /// For the names of what there is to undo and redo.
    pub fn history(&self) -> &History<Work> {
        &self.history
    }
}

#[cfg(test)]
mod tests;
