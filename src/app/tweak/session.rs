//! What is edited and how it is looked at: all that is worth keeping when a device is lost.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::demo::shot::Shot;
use haze::preset::{MaterialNames, Preset, Tooltips};
use haze::settings::ShadeTree;
use haze::{Error, MaterialAssets};

use super::compare::Compare;
use super::document::difference::{changed_fields, copy_field};
use super::document::document::Document;
use super::messages::Messages;
use super::playback::Playback;
use super::referee::Referee;
use super::search::Search;
use super::show::Show;

pub struct Session {
    /// What is edited; panels change its preset directly.
    pub document: Document,
    pub playback: Playback,
    pub show: Show,
    pub compare: Compare,
    pub referee: Referee,
    pub search: Search,
    pub messages: Messages,
    pub tooltips: Tooltips,
    /// What the stages of the shading are.
    pub stages: Tooltips,
    /// A picture of the window is wanted here; then it closes.
    pub screenshot: Option<PathBuf>,
    pictures: Pictures,
    changed: Changed,
}

/// The pictures of all systems, as last loaded well.
struct Pictures {
    names: Vec<MaterialNames>,
    loaded: Vec<MaterialAssets>,
}

/// Paths of the fields that differ from the preset on disk, and the two that they were found between.
struct Changed {
    paths: HashSet<String>,
    saved: Preset,
    preset: Preset,
}

impl Session {
    /// Opens a built-in preset by name, or a file.
    pub fn open(source: &Path) -> Result<Self, Error> {
        let document = Document::open(source)?;
        let preset = &document.preset;
        let loaded = preset.load_materials(source)?;
        Ok(Self {
            playback: Playback::at(preset.time),
            show: Show::default(),
            compare: Compare::default(),
            referee: Referee::default(),
            search: Search::default(),
            messages: Messages::default(),
            tooltips: Tooltips::of::<Preset>(),
            stages: Tooltips::of::<ShadeTree>(),
            screenshot: None,
            pictures: Pictures { names: names(preset), loaded },
            changed: Changed { paths: HashSet::new(), saved: preset.clone(), preset: preset.clone() },
            document,
        })
    }

    /// What is to be seen now.
    pub fn shot(&self, size: UVec2) -> Shot {
        let mut preset = self.document.preset.clone();
        preset.time = self.playback.time;
        Shot { preset, size, shade_tree: self.show.stage, materials: self.pictures.loaded.clone() }
    }

    /// The preset as it is on disk; as it is here where that is not known.
    pub fn saved(&self) -> &Preset {
        self.document.saved().unwrap_or(&self.document.preset)
    }

    /// Paths of the fields that differ from the preset on disk.
    pub fn changed(&self) -> &HashSet<String> {
        &self.changed.paths
    }

    /// Sets a field, a group or a list back to what is on disk.
    pub fn set_back(&mut self, path: &str) {
        let saved = self.saved().clone();
        copy_field(&saved, &mut self.document.preset, path);
    }

    /// Takes note of what the panels changed. `is_held`: a control is still being moved, or typed into.
    pub fn track(&mut self, is_held: bool) {
        self.document.track(is_held);
        let (saved, preset) = (self.saved(), &self.document.preset);
        if (&self.changed.saved, &self.changed.preset) != (saved, preset) {
            let paths = changed_fields(saved, preset).into_iter().collect();
            self.changed = Changed { paths, saved: saved.clone(), preset: preset.clone() };
        }
        if names(&self.document.preset) != self.pictures.names {
            self.load_pictures();
        }
    }

    pub fn undo(&mut self) {
        if let Some(name) = self.document.undo() {
            self.messages.say("undo", format!("undone: {name}"));
        }
    }

    pub fn redo(&mut self) {
        if let Some(name) = self.document.redo() {
            self.messages.say("undo", format!("done again: {name}"));
        }
    }

    /// Reads the pictures that the preset names; those of before stay where they cannot be had.
    pub fn load_pictures(&mut self) {
        self.pictures.names = names(&self.document.preset);
        match self.document.preset.load_materials(self.document.path()) {
            Ok(loaded) => {
                self.pictures.loaded = loaded;
                self.messages.withdraw("pictures");
            }
            Err(error) => self.messages.complain("pictures", error),
        }
    }
}

fn names(preset: &Preset) -> Vec<MaterialNames> {
    preset.systems.iter().map(|system| system.material.clone()).collect()
}
