//! Edited preset: its file, its undo history, its recovery after a crash, and the files that belong to it.

pub mod copied_assets;
pub mod display_names;
pub mod history;
pub mod keyframes;
pub mod light_defaults;
pub mod light_roles;
pub mod loaded_backdrop;
pub mod loaded_materials;
pub mod loaded_particles;
pub mod preset_diff;
pub mod ramp_edits;
pub mod recipe_steps;
pub mod recovery;
pub mod simulation_edit;
pub mod sprite_edits;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};

use haze::FieldError;
use haze_core::error::Error;
use haze_export::inputs::{backdrop_file_paths, image_paths};
use haze_preset::{AssetFolders, Preset, builtin};

use crate::platform::asset_loading::particle_file_paths;
use crate::platform::file_io::{self, Stamp};
use copied_assets::{copy_assets, copy_backdrop};
use history::History;
use recipe_steps::{GradientStep, Recipes, Work, step_name_of_work};

/// Preset with its file and its undo history.
pub struct Document {
    /// Edited preset; panels change it directly.
    pub preset: Preset,
    /// Edited recipes. They are written as soon as a step is complete.
    pub recipes: Recipes,
    history: History<Work>,
    /// Edit of gradient stops in progress, for the name of its step.
    gradient_step: Option<GradientStep>,
    /// Path of a file, or name of a built-in preset.
    path: PathBuf,
    /// Content of the file, if it is known.
    saved: Option<Preset>,
    /// Text of the file when it was last read or written.
    text: String,
    /// Stamp of the file with that text; `None` if the file must be read to compare.
    stamp: Option<Stamp>,
    /// Text that another thread is writing to the file, while it does so.
    writing: Weak<String>,
}

/// Snapshot of a document to be saved. Any thread can write it.
pub struct Saving {
    preset: Preset,
    text: Arc<String>,
    /// Source file, which tells where the images are, and target file.
    from: PathBuf,
    path: PathBuf,
    /// Folders of scene and sky, in addition to the source's.
    backdrop_folders: Vec<PathBuf>,
}

impl Saving {
    /// Copies scene and sky from these folders too.
    pub fn with_backdrop_folders(self, backdrop_folders: Vec<PathBuf>) -> Self {
        Self { backdrop_folders, ..self }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file. If it goes to another folder, the images that the preset names are copied there.
    pub fn write(&self) -> Result<(), Error> {
        let folder = |path: &Path| path.parent().unwrap_or(Path::new("")).to_path_buf();
        let target = folder(&self.path);
        copy_assets(&self.preset, &folder(&self.from), &target)?;
        let folders = AssetFolders::for_preset_file(&self.from).with_shared(self.backdrop_folders.clone());
        copy_backdrop(&self.preset, &folders, &target)?;
        file_io::write(&self.path, self.text.as_bytes())
    }
}

/// State of the file, compared with the text that was last read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnDisk {
    /// It has the same text.
    Same,
    /// Another program has written it.
    Changed,
    /// It does not exist.
    Gone,
}

impl Document {
    /// Opens a file, or a built-in preset by name.
    pub fn open(name_or_path: &Path) -> Result<Self, Error> {
        // The stamp is taken before the file is read, so that a write in between counts as a change.
        let stamp = Stamp::of(name_or_path);
        let (preset, text) = file_io::read_preset(name_or_path)?;
        let recipes = Recipes::default();
        let history = History::new((preset.clone(), recipes.clone()));
        let saved = Some(preset.clone());
        let path = name_or_path.into();
        Ok(Self { saved, preset, recipes, history, gradient_step: None, path, text, stamp, writing: Weak::new() })
    }

    /// Returns the document for recovered work. Its original file need not exist any more.
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
        document.put(preset, "Recover");
        document
    }

    /// Returns the file, or the name of the built-in preset. Images are looked up relative to it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the files that the image depends on, for watching. Some may be missing.
    pub fn files(&self, folders: &AssetFolders) -> Vec<PathBuf> {
        let own = (!self.is_built_in()).then(|| self.path.clone());
        let images = image_paths(folders, &self.preset);
        let backdrop = backdrop_file_paths(folders, &self.preset);
        own.into_iter().chain(images).chain(particle_file_paths(folders, &self.preset)).chain(backdrop).collect()
    }

    /// Returns true if the document is a built-in preset, without a file.
    pub fn is_built_in(&self) -> bool {
        self.path.to_str().and_then(|name| builtin::find(builtin::PRESETS, name)).is_some()
    }

    /// Returns the preset in the file, if it is known. Marks and resets refer to it.
    pub fn saved(&self) -> Option<&Preset> {
        self.saved.as_ref()
    }

    /// Returns true if there are unsaved changes.
    pub fn is_dirty(&self) -> bool {
        self.saved.as_ref() != Some(&self.preset)
    }

    /// Begins to save. [`Saving::write`] does the work, and [`Document::finish_saving`] must follow.
    pub fn begin_saving(&mut self) -> Result<Saving, Error> {
        if self.is_built_in() {
            let problem = format!("{} is a built-in preset", self.path.display());
            return Err(FieldError::from_problem("save", problem, "another name").into());
        }
        self.begin_saving_as(&self.path.clone())
    }

    /// Returns the title: the name of the file or of the built-in preset.
    pub fn title(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Returns the name of the file, or of the built-in preset, for questions.
    pub fn file_name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Begins to save to another file, which becomes the document's file once it is written.
    pub fn begin_saving_as(&mut self, path: &Path) -> Result<Saving, Error> {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
            return Err(FieldError::new("save as", path.display(), "a name that ends in .json").into());
        }
        self.preset.validate()?;
        let text = Arc::new(self.preset.to_json(&self.text));
        self.writing = Arc::downgrade(&text);
        Ok(Saving {
            preset: self.preset.clone(),
            text,
            from: self.path.clone(),
            path: path.into(),
            backdrop_folders: Vec::new(),
        })
    }

    /// Returns true while a save is in progress.
    pub fn is_being_saved(&self) -> bool {
        self.writing.strong_count() > 0
    }

    /// Ends a save. A save that belongs to another document is ignored.
    pub fn finish_saving(&mut self, saving: Saving, is_written: bool) {
        let Saving { preset, text, path, .. } = saving;
        if is_written && Weak::as_ptr(&self.writing) == Arc::as_ptr(&text) {
            // The stamp is left open, so that the next check reads the file: another program may have written it
            // meanwhile.
            self.text = text.to_string();
            self.stamp = None;
            self.saved = Some(preset);
            self.path = path;
        }
    }

    /// Reads the file again, as a step that can be undone.
    pub fn revert(&mut self) -> Result<(), Error> {
        let Self { preset, text, stamp, .. } = Self::open(&self.path)?;
        self.text = text;
        self.stamp = stamp;
        self.saved = Some(preset.clone());
        self.put(preset, "Revert");
        Ok(())
    }

    /// Compares the file with the text that was last read or written. A save by this process is no change.
    pub fn on_disk(&mut self) -> OnDisk {
        if self.is_built_in() {
            return OnDisk::Same;
        }
        let Some(stamp) = Stamp::of(&self.path) else { return OnDisk::Gone };
        if self.stamp == Some(stamp) {
            return OnDisk::Same;
        }
        match file_io::read_text(&self.path) {
            Ok(text) if text == self.text || self.writing.upgrade().is_some_and(|writing| *writing == text) => {
                self.stamp = Some(stamp);
                OnDisk::Same
            }
            _ => OnDisk::Changed,
        }
    }

    /// Keeps the edited version without touching the file. The document then has unsaved changes.
    pub fn keep_mine(&mut self) {
        self.stamp = Stamp::of(&self.path);
        self.saved = None;
    }

    /// Returns the preset as text for the clipboard.
    pub fn to_json(&self) -> String {
        self.preset.to_json("")
    }

    /// Replaces the preset by that of a text, as one step. An invalid text changes nothing.
    pub fn paste(&mut self, text: &str) -> Result<(), Error> {
        self.put(Preset::parse(Path::new("pasted text"), text)?, "Paste");
        Ok(())
    }

    fn put(&mut self, preset: Preset, name: &str) {
        self.track(false);
        self.preset = preset;
        self.history.track(&self.work(), false, |_, _| name.into());
    }

    /// Records changes that panels made, like [`History::track`]. Call once a frame.
    pub fn track(&mut self, is_held: bool) {
        // Nothing is cloned while nothing changes.
        let (preset, recipes) = self.history.settled();
        if *preset == self.preset && *recipes == self.recipes {
            self.history.rest();
            self.gradient_step = None;
        } else {
            let step = self.gradient_step.as_ref();
            let work = (self.preset.clone(), self.recipes.clone());
            self.history.track(&work, is_held, |before, after| step_name_of_work(before, after, step));
        }
    }

    /// Names the edit of gradient stops that is in progress.
    pub fn name_gradient_step(&mut self, ramp: &str, step: &'static str) {
        self.gradient_step = Some((ramp.into(), step));
    }

    fn work(&self) -> Work {
        (self.preset.clone(), self.recipes.clone())
    }

    /// Undoes a step and returns its name.
    pub fn undo(&mut self) -> Option<&str> {
        let mut work = self.work();
        let name = self.history.undo(&mut work);
        (self.preset, self.recipes) = work;
        name
    }

    /// Redoes the step that was last undone and returns its name.
    pub fn redo(&mut self) -> Option<&str> {
        let mut work = self.work();
        let name = self.history.redo(&mut work);
        (self.preset, self.recipes) = work;
        name
    }

    /// Returns the history, for the names of its steps.
    pub fn history(&self) -> &History<Work> {
        &self.history
    }
}

#[cfg(test)]
mod tests;
