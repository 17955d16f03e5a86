//! What is edited and how it is looked at: all that is worth keeping when a device is lost.

use std::path::{Path, PathBuf};

use glam::UVec2;
use haze::demo::shot::Shot;
use haze::preset::{Preset, Tooltips};
use haze::{Error, MaterialAssets};

use super::compare::Compare;
use super::document::{History, step_name};
use super::messages::Messages;
use super::playback::Playback;
use super::search::Search;
use super::show::Show;

pub struct Session {
    /// What is edited; panels change it directly.
    pub preset: Preset,
    /// As it is on disk.
    pub saved: Preset,
    /// A built-in preset's name, or a file.
    pub source: PathBuf,
    pub history: History<Preset>,
    pub playback: Playback,
    pub show: Show,
    pub compare: Compare,
    pub search: Search,
    pub messages: Messages,
    pub tooltips: Tooltips,
    /// A picture of the window is wanted here; then it closes.
    pub screenshot: Option<PathBuf>,
    pictures: Pictures,
}

/// The pictures of all systems, as last loaded well.
struct Pictures {
    names: Vec<haze::preset::MaterialNames>,
    loaded: Vec<MaterialAssets>,
}

impl Session {
    /// Opens a built-in preset by name, or a file.
    pub fn open(source: &Path) -> Result<Self, Error> {
        let preset = Preset::load(source)?;
        let loaded = preset.load_materials(source)?;
        Ok(Self {
            history: History::new(preset.clone()),
            playback: Playback::at(preset.time),
            show: Show::default(),
            compare: Compare::default(),
            search: Search::default(),
            messages: Messages::default(),
            tooltips: Tooltips::of::<Preset>(),
            screenshot: None,
            pictures: Pictures { names: names(&preset), loaded },
            saved: preset.clone(),
            source: source.to_owned(),
            preset,
        })
    }

    /// What is to be seen now.
    pub fn shot(&self, size: UVec2) -> Shot {
        let mut preset = self.preset.clone();
        preset.time = self.playback.time;
        Shot { preset, size, shade_tree: self.show.stage, materials: self.pictures.loaded.clone() }
    }

    /// Takes note of what the panels changed. `is_held`: a control is still being moved.
    pub fn track(&mut self, is_held: bool) {
        self.history.track(&self.preset, is_held, step_name);
        if names(&self.preset) != self.pictures.names {
            self.load_pictures();
        }
    }

    pub fn undo(&mut self) {
        if let Some(name) = self.history.undo(&mut self.preset) {
            self.messages.say("undo", format!("undone: {name}"));
        }
    }

    pub fn redo(&mut self) {
        if let Some(name) = self.history.redo(&mut self.preset) {
            self.messages.say("undo", format!("done again: {name}"));
        }
    }

    /// Reads the pictures that the preset names; those of before stay where they cannot be had.
    pub fn load_pictures(&mut self) {
        self.pictures.names = names(&self.preset);
        match self.preset.load_materials(&self.source) {
            Ok(loaded) => {
                self.pictures.loaded = loaded;
                self.messages.withdraw("pictures");
            }
            Err(error) => self.messages.complain("pictures", error),
        }
    }
}

fn names(preset: &Preset) -> Vec<haze::preset::MaterialNames> {
    preset.systems.iter().map(|system| system.material.clone()).collect()
}
