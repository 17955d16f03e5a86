//! Editing session: the document, and the state of its view. It is kept when a device is lost.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use eframe::egui;
use glam::UVec2;
use haze::preset::{AssetFolders, Preset};
use haze::settings::{DebugView, FieldValue, field_values};
use haze::shader::Sources;
use haze::{Error, Light, MaterialAssets};
use haze_author::particle_files::ParticleFrames;
use haze_author::preset::Tooltips;
use haze_demo::shot::Shot;

use super::caches::Caches;
use super::compare::Compare;
use super::document::difference::{changed_fields, copy_field};
use super::document::document::Document;
use super::gauge::PsnrJob;
use super::hints::FirstRunHints;
use super::inspect::Inspect;
use super::lights::LightView;
use super::messages::Messages;
use super::performance::Performance;
use super::picture_thumbnails::PictureThumbnails;
use super::pictures::Pictures;
use super::platform::assets::{self, Loaded};
use super::platform::wake::RepaintHandle;
use super::playback::Playback;
use super::ramp_files::RampEdits;
use super::referee::CpuRenderJob;
use super::search::SettingSearch;
use super::show::{Show, Tab};
use super::sprite::draw::Painted;
use super::sprite::files::SpriteEdits;

pub struct Session {
    /// Document; panels change its preset directly.
    pub document: Document,
    pub playback: Playback,
    pub show: Show,
    pub compare: Compare,
    pub gauge: PsnrJob,
    pub referee: CpuRenderJob,
    pub inspect: Inspect,
    pub search: SettingSearch,
    pub hints: FirstRunHints,
    pub messages: Messages,
    pub performance: Performance,
    pub tooltips: Tooltips,
    /// Descriptions of the debug views.
    pub stages: Tooltips,
    pub thumbnails: PictureThumbnails,
    /// Flipbook on the Sprite tab.
    pub flipbook: Option<Painted>,
    /// Repaints the window from threads that run for longer than one window is open.
    pub wake: RepaintHandle,
    /// Folder of images that presets share.
    pub assets: Option<PathBuf>,
    /// Path of a screenshot; the window closes once it is written.
    pub screenshot: Option<PathBuf>,
    /// Images as last loaded without error.
    pub pictures: Pictures,
    pub caches: Caches,
    /// Ramps whose stops are edited.
    pub ramps: RampEdits,
    /// Sprites whose recipes are edited.
    pub sprites: SpriteEdits,
    /// Shaders of a watched folder, as last compiled without error; `None` means the built-in ones.
    pub shaders: Option<Sources>,
    /// Another program has written the file while there are unsaved changes. The user has to choose a version.
    pub is_changed_on_disk: bool,
    changed: Changed,
    /// Set while the second image has settings of its own.
    second: Option<SecondDiff>,
}

/// Paths of the fields that differ from the preset on disk, and the two presets that were compared.
struct Changed {
    paths: HashSet<String>,
    saved: Preset,
    preset: Preset,
}

/// Values of the second image's settings that differ, by path, and the two presets that were compared.
struct SecondDiff {
    apart: HashMap<String, FieldValue>,
    settings: Preset,
    preset: Preset,
}

impl Session {
    /// Opens a built-in preset by name, or a file. Images are looked up beside it and in `assets`.
    pub fn open(source: &Path, assets: Option<PathBuf>) -> Result<Self, Error> {
        let document = Document::open(source)?;
        let preset = &document.preset;
        let folders = AssetFolders::beside(source).with_shared(assets.clone());
        let (materials, caches) = assets::all(preset, source, &folders)?;
        Ok(Self {
            assets,
            playback: Playback::at(preset.time),
            show: Show::default(),
            compare: Compare::default(),
            gauge: PsnrJob::default(),
            referee: CpuRenderJob::default(),
            inspect: Inspect::default(),
            search: SettingSearch::default(),
            hints: FirstRunHints::default(),
            messages: Messages::default(),
            performance: Performance::default(),
            tooltips: Tooltips::of::<Preset>(),
            stages: Tooltips::of::<DebugView>(),
            thumbnails: PictureThumbnails::default(),
            flipbook: None,
            wake: RepaintHandle::default(),
            screenshot: None,
            pictures: Pictures::new(preset, materials),
            caches: Caches::new(preset, caches),
            ramps: RampEdits::default(),
            sprites: SpriteEdits::default(),
            shaders: None,
            is_changed_on_disk: false,
            changed: Changed { paths: HashSet::new(), saved: preset.clone(), preset: preset.clone() },
            second: None,
            document,
        })
    }

    /// Attaches the session to another window. GPU resources of the previous device are dropped.
    pub fn attach_window(&mut self, context: &egui::Context) {
        self.wake.follow(context);
        (self.thumbnails, self.flipbook) = (PictureThumbnails::default(), None);
    }

    /// Returns the folders where images are looked up.
    pub fn folders(&self) -> AssetFolders {
        AssetFolders::beside(self.document.path()).with_shared(self.assets.clone())
    }

    /// Returns the shot of the present view.
    pub fn shot(&self, size: UVec2) -> Shot {
        let mut preset = self.document.preset.clone();
        preset.time = self.playback.time;
        preset.lights = self.show.lights.shown(&preset.lights);
        let (materials, caches) = (self.materials(), self.caches());
        Shot { preset, size, debug_view: self.show.stage, materials, caches }
    }

    /// Returns the images of every system, with edits.
    pub fn materials(&self) -> Vec<MaterialAssets> {
        let mut materials = self.pictures.of(&self.document.preset);
        self.ramps.apply(&self.document.preset, &mut materials);
        self.sprites.apply(&self.document.preset, &mut materials);
        materials
    }

    /// Returns the particles of every system that has particle files.
    pub fn caches(&self) -> Vec<Option<ParticleFrames>> {
        self.caches.of(&self.document.preset)
    }

    /// Bakes edited ramps, and writes them unless a control is held.
    pub fn follow_ramps(&mut self, is_held: bool) {
        let folders = self.folders();
        let mut done = self.ramps.advance(&mut self.document, &folders, is_held);
        if !is_held && done.is_ok() {
            done = self.ramps.make_own(&mut self.document);
        }
        if let Err(error) = done {
            self.messages.complain("ramp", error);
        }
    }

    /// Requests bakes of edited sprites; they are full and written unless a control is held.
    fn follow_sprites(&mut self, is_held: bool) {
        let mut done = self.sprites.advance(&mut self.document, is_held);
        if !is_held && done.is_ok() {
            done = self.sprites.make_own(&mut self.document);
        }
        if let Err(error) = done {
            self.messages.complain("sprite", error);
        }
    }

    /// Returns the preset on disk, or the edited one if the file's content is not known.
    pub fn saved(&self) -> &Preset {
        self.document.saved().unwrap_or(&self.document.preset)
    }

    /// Returns the paths of the fields that differ from the preset on disk.
    pub fn changed(&self) -> &HashSet<String> {
        &self.changed.paths
    }

    /// Resets a field, a group or a list to its value on disk.
    pub fn reset_field(&mut self, path: &str) {
        let saved = self.saved().clone();
        copy_field(&saved, &mut self.document.preset, path);
    }

    /// Returns the values of the second image's settings that differ, by path; `None` if it has no settings of its own.
    pub fn second(&self) -> Option<&HashMap<String, FieldValue>> {
        self.second.as_ref().map(|second| &second.apart)
    }

    /// Copies a field, a group or a list from the second image's settings.
    pub fn take(&mut self, path: &str) {
        if let Some(second) = self.compare.against.as_ref().and_then(|against| against.settings(self.saved())).cloned()
        {
            copy_field(&second, &mut self.document.preset, path);
        }
    }

    /// Records changes that panels made. `is_held`: a control is still being dragged or typed into.
    pub fn track(&mut self, is_held: bool) {
        let is_held = is_held || self.show.tab == Tab::Ramps && self.ramps.is_editing();
        self.follow_ramps(is_held);
        self.follow_sprites(is_held);
        self.document.track(is_held);
        let (saved, preset) = (self.saved(), &self.document.preset);
        if (&self.changed.saved, &self.changed.preset) != (saved, preset) {
            let paths = changed_fields(saved, preset).into_iter().collect();
            self.changed = Changed { paths, saved: saved.clone(), preset: preset.clone() };
        }
        let second = self.compare.against.as_ref().and_then(|against| against.settings(self.saved()));
        let Some(settings) = second else {
            self.second = None;
            return;
        };
        let preset = &self.document.preset;
        if self.second.as_ref().is_none_or(|known| (&known.settings, &known.preset) != (settings, preset)) {
            let paths: HashSet<_> = changed_fields(settings, preset).into_iter().collect();
            let apart = field_values(settings).into_iter().filter(|(path, _)| paths.contains(path)).collect();
            self.second = Some(SecondDiff { apart, settings: settings.clone(), preset: preset.clone() });
        }
    }

    /// Shows the reason if typed input is not valid, and withdraws it after a valid edit.
    pub fn refuse(&mut self, refused: Option<String>, is_edited: bool) {
        match refused {
            Some(refused) => self.messages.complain("typed", refused),
            None if is_edited => self.messages.withdraw("typed"),
            None => {}
        }
    }

    /// Changes the selected light, if there is one.
    pub fn change_light(&mut self, change: impl FnOnce(&mut LightView, &mut Vec<Light>, usize)) {
        let lights = &mut self.document.preset.lights;
        if let Some(index) = self.show.lights.selected.filter(|&index| index < lights.len()) {
            change(&mut self.show.lights, lights, index);
        }
    }

    /// Adds a light, and selects it.
    pub fn add_light(&mut self, light: Light) {
        let lights = &mut self.document.preset.lights;
        let end = lights.len();
        self.show.lights.insert(lights, end, light);
    }

    pub fn undo(&mut self) {
        if let Some(name) = self.document.undo() {
            self.messages.say("undo", format!("undone: {name}"));
        }
    }

    pub fn redo(&mut self) {
        if let Some(name) = self.document.redo() {
            self.messages.say("undo", format!("redone: {name}"));
        }
    }

    /// Reads the file again. Undo restores the changes that it replaces.
    pub fn revert(&mut self) {
        self.is_changed_on_disk = false;
        match self.document.revert() {
            Ok(()) => self.messages.withdraw("preset"),
            Err(error) => self.messages.complain("preset", error),
        }
    }

    /// Replaces the document, and resets the state that depended on the old one.
    pub fn put(&mut self, document: Document, (materials, caches): Loaded) {
        self.pictures = Pictures::new(&document.preset, materials);
        self.caches = Caches::new(&document.preset, caches);
        self.playback = Playback::at(document.preset.time);
        (self.compare, self.show.system, self.is_changed_on_disk) = (Compare::default(), 0, false);
        self.ramps = RampEdits::default();
        self.sprites.forget();
        self.show.lights.forget_keys();
        let stale = ["preset", "ramp", "sprite", "pictures", "caches", "file"];
        stale.into_iter().for_each(|about| self.messages.withdraw(about));
        self.document = document;
    }

    /// Replaces the preset by one from a text.
    pub fn paste(&mut self, text: &str) {
        match self.document.paste(text) {
            Ok(()) => self.messages.say("file", "pasted a preset"),
            Err(error) => self.messages.complain("file", format!("nothing is pasted: {error}")),
        }
    }
}
