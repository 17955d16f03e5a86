//! Editing session: the document, and the state of its view. It is kept when a device is lost.

pub mod action;
mod asset_edits;
pub mod comparison;
pub mod first_run_hints;
pub mod image_thumbnails;
pub mod inspection;
pub mod light_view;
pub mod look_controls;
pub mod look_thumbnails;
pub mod macro_param;
pub mod messages;
pub mod playback;
pub mod ramp_survey;
pub mod setting_search;
pub mod slider_range;
pub mod smoke_geometry;
pub mod sprite_preview;
pub mod sprite_view;
mod system_edits;
pub mod system_view;
pub mod track_view;
pub mod view_options;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use eframe::egui;
use glam::UVec2;
use haze::shader::Sources;
use haze::{Light, MaterialAssets};
use haze_author::particle_files::ParticleFrames;
use haze_author::preset::{Tooltips, no_effect_reason};
use haze_core::error::Error;
use haze_core::settings::{BackdropKind, DebugView, FieldValue, field_values};
use haze_demo::shot::Shot;
use haze_preset::{AssetFolders, Preset};

use crate::document::Document;
use crate::document::keyframes::{self, KeyframeEdit};
use crate::document::light_roles::{keep_one_key, light_of};
use crate::document::loaded_backdrop::{self, LoadedBackdrop};
use crate::document::loaded_materials::LoadedMaterials;
use crate::document::loaded_particles::LoadedParticles;
use crate::document::preset_diff::{changed_fields, copy_field};
use crate::document::ramp_edits::RampEdits;
use crate::document::simulation_edit::SimulationEdit;
use crate::document::sprite_edits::SpriteEdits;
use crate::platform::IS_PAGE;
use crate::platform::asset_loading::{self, LoadedAssets};
use crate::platform::repaint_handle::RepaintHandle;
use crate::viewport_renderer::cpu_render_job::CpuRenderJob;
use crate::viewport_renderer::frame_timings::FrameTimings;
use crate::viewport_renderer::psnr_job::PsnrJob;
use comparison::CompareState;
use first_run_hints::FirstRunHints;
use image_thumbnails::ImageThumbnails;
use inspection::Inspection;
use light_view::LightView;
use look_thumbnails::LookThumbnails;
use messages::Messages;
use playback::Playback;
use setting_search::SettingSearch;
use smoke_geometry::SmokeGeometry;
use sprite_preview::SpritePreview;
use system_view::SystemView;
use view_options::{Tab, ViewOptions};

pub struct Session {
    /// Document; panels change its preset directly.
    pub document: Document,
    pub playback: Playback,
    pub view: ViewOptions,
    pub compare: CompareState,
    pub psnr_job: PsnrJob,
    pub cpu_render_job: CpuRenderJob,
    pub inspect: Inspection,
    pub search: SettingSearch,
    pub hints: FirstRunHints,
    pub messages: Messages,
    pub timings: FrameTimings,
    pub tooltips: Tooltips,
    /// Descriptions of the debug views.
    pub debug_view_tooltips: Tooltips,
    pub thumbnails: ImageThumbnails,
    /// Looks of a ramp, while they are shown.
    pub looks: LookThumbnails,
    /// Flipbook on the Sprite tab.
    pub flipbook: Option<SpritePreview>,
    /// Repaints the window from threads that run for longer than one window is open.
    pub repaint: RepaintHandle,
    /// Folder of images that presets share.
    pub assets: Option<PathBuf>,
    /// Path of a screenshot; the window closes once it is written.
    pub screenshot: Option<PathBuf>,
    /// Smoke at the shown time, for panels that measure it.
    pub smoke: SmokeGeometry,
    /// Images as last loaded without error.
    pub loaded_materials: LoadedMaterials,
    pub particle_files: LoadedParticles,
    /// Scene and sky from files, as last loaded without error.
    pub backdrop: LoadedBackdrop,
    /// Folders of scenes and skies that were dropped on the window; they are copied beside the preset when it is saved.
    pub backdrop_folders: Vec<PathBuf>,
    /// Kind of a backdrop for which the user asks for a file dialog.
    pub backdrop_request: Option<BackdropKind>,
    /// Ramps whose stops are edited.
    pub ramps: RampEdits,
    /// Sprites whose recipes are edited.
    pub sprites: SpriteEdits,
    /// Simulation that becomes a sprite.
    pub simulation: SimulationEdit,
    /// Shaders of a watched folder, as last compiled without error; `None` means the built-in ones.
    pub shaders: Option<Sources>,
    /// Another program has written the file while there are unsaved changes. The user has to choose a version.
    pub is_changed_on_disk: bool,
    /// Copy of a built-in image that the user has to confirm.
    pub copy_request: Option<CopyRequest>,
    changed: Changed,
    /// Set while the second image has settings of its own.
    second_diff: Option<SecondDiff>,
}

/// Copy of a built-in image beside the preset, to be edited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CopyRequest {
    /// Index of the system that will use it.
    pub system: usize,
    /// Name of the built-in image.
    pub name: String,
    pub image: CopiedImage,
}

/// Kind of a copied image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CopiedImage {
    /// Ramp of a field of the material.
    Ramp(&'static str),
    Sprite,
}

/// Paths of the fields that differ from the preset on disk, and the two presets that were compared.
struct Changed {
    paths: HashSet<String>,
    saved: Preset,
    preset: Preset,
}

/// Values of the second image's settings that differ, by path, and the two presets that were compared.
struct SecondDiff {
    differing_values: HashMap<String, FieldValue>,
    settings: Preset,
    preset: Preset,
}

impl Session {
    /// Opens a built-in preset by name, or a file. Images are looked up beside it and in `assets`.
    pub fn open(source: &Path, assets: Option<PathBuf>) -> Result<Self, Error> {
        Self::show(Document::open(source)?, assets)
    }

    /// Shows a document. Images are looked up beside it and in `assets`.
    pub fn show(document: Document, assets: Option<PathBuf>) -> Result<Self, Error> {
        let preset = &document.preset;
        let source = document.path();
        let folders = AssetFolders::for_preset_file(source).with_shared(assets.clone());
        let LoadedAssets { materials, particles, backdrop } = asset_loading::all(preset, source, &folders)?;
        Ok(Self {
            assets,
            playback: Playback::of(preset),
            view: ViewOptions::default(),
            compare: CompareState::default(),
            psnr_job: PsnrJob::default(),
            cpu_render_job: CpuRenderJob::default(),
            inspect: Inspection::default(),
            search: SettingSearch::default(),
            hints: FirstRunHints::default(),
            messages: Messages::default(),
            timings: FrameTimings::default(),
            tooltips: Tooltips::of::<Preset>(),
            debug_view_tooltips: Tooltips::of::<DebugView>(),
            thumbnails: ImageThumbnails::default(),
            looks: LookThumbnails::default(),
            flipbook: None,
            repaint: RepaintHandle::default(),
            screenshot: None,
            smoke: SmokeGeometry::default(),
            loaded_materials: LoadedMaterials::new(preset, materials),
            particle_files: LoadedParticles::new(preset, particles),
            backdrop: LoadedBackdrop::new(preset, backdrop),
            backdrop_folders: Vec::new(),
            backdrop_request: None,
            ramps: RampEdits::default(),
            sprites: SpriteEdits::default(),
            simulation: SimulationEdit::default(),
            shaders: None,
            is_changed_on_disk: false,
            copy_request: None,
            changed: Changed { paths: HashSet::new(), saved: preset.clone(), preset: preset.clone() },
            second_diff: None,
            document,
        })
    }

    /// Attaches the session to another window. GPU resources of the previous device are dropped.
    pub fn attach_window(&mut self, context: &egui::Context) {
        self.repaint.follow(context);
        self.thumbnails = ImageThumbnails::default();
        self.flipbook = None;
        self.looks = LookThumbnails::default();
        self.view.systems.images.clear();
    }

    /// Returns the folders where images are looked up.
    pub fn folders(&self) -> AssetFolders {
        AssetFolders::for_preset_file(self.document.path())
            .with_shared(self.assets.clone())
            .with_shared(self.backdrop_folders.clone())
    }

    /// Returns the reason why a field of a preset has no effect at the size of the view.
    pub fn no_effect_reason(&self, preset: &Preset, path: &str) -> Option<&'static str> {
        no_effect_reason(preset, path, self.view.size)
    }

    /// Returns the shot of the present view.
    pub fn shot(&self, size: UVec2) -> Shot {
        self.shot_of(self.shown_preset(), size)
    }

    /// Returns the shot of the present view with its tracks and all systems, for exports.
    pub fn animated_shot(&self, size: UVec2) -> Shot {
        self.shot_of(Preset { time: self.playback.time, ..self.document.preset.clone() }, size)
    }

    /// Returns the preset with the values of its tracks at the time of the playback.
    pub fn preset_now(&self) -> Preset {
        self.document.preset.evaluate(self.playback.time)
    }

    /// Returns the smoke that is shown, measured unless `known` has it already.
    pub fn measure<'a>(&self, known: &'a mut SmokeGeometry) -> &'a SmokeGeometry {
        known.at(&self.shown_preset(), self.particle_frames(), self.playback.time)
    }

    fn shot_of(&self, mut preset: Preset, size: UVec2) -> Shot {
        self.view.lights.apply(&mut preset);
        let materials = self.materials();
        let caches = self.particle_frames();
        let backdrop = self.backdrop.of(&preset);
        Shot { preset, size, debug_view: self.view.debug_view, materials, caches, backdrop, shown_scalar: None }
    }

    /// Returns the images of every system, with edits.
    pub fn materials(&self) -> Vec<MaterialAssets> {
        let mut materials = self.loaded_materials.of(&self.document.preset);
        self.ramps.apply(&self.document.preset, &mut materials);
        self.sprites.apply(&self.document.preset, &mut materials);
        self.simulation.apply(&self.document.preset, &mut materials);
        materials
    }

    /// Returns the particles of every system that has particle files.
    pub fn particle_frames(&self) -> Vec<Option<ParticleFrames>> {
        self.particle_files.of(&self.document.preset)
    }

    /// Says on a page that scene and sky are not shown.
    pub fn report_missing_backdrop(&mut self) {
        let names = loaded_backdrop::names(&self.document.preset).into_iter().filter(|name| !name.is_empty());
        let names: Vec<_> = names.collect();
        if IS_PAGE && !names.is_empty() {
            let names = names.join(" and ");
            self.messages.info("backdrop", format!("A page does not show {names}; the program does"));
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
        self.copy(&saved, path);
    }

    /// Returns the values of the second image's settings that differ, by path; `None` if it has no settings of its own.
    pub fn second_diff(&self) -> Option<&HashMap<String, FieldValue>> {
        self.second_diff.as_ref().map(|second| &second.differing_values)
    }

    /// Copies a field, a group or a list from the second image's settings.
    pub fn copy_from_second(&mut self, path: &str) {
        if let Some(second) = self.compare.against.as_ref().and_then(|against| against.settings(self.saved())).cloned()
        {
            self.copy(&second, path);
        }
    }

    fn copy(&mut self, from: &Preset, path: &str) {
        let preset = &mut self.document.preset;
        copy_field(from, preset, path);
        if let Some(index) = light_of(path) {
            keep_one_key(&mut preset.lights, index);
        }
    }

    /// Records changes that panels made. `is_held`: a control is still being dragged or typed into.
    pub fn track(&mut self, is_held: bool) {
        let is_held = is_held || self.view.tab == Tab::Ramps && self.ramps.is_editing();
        self.follow_ramps(is_held);
        self.follow_sprites(is_held);
        self.follow_simulation(is_held);
        self.document.track(is_held);
        let saved = self.saved();
        let preset = &self.document.preset;
        if (&self.changed.saved, &self.changed.preset) != (saved, preset) {
            let paths = changed_fields(saved, preset).into_iter().collect();
            self.changed = Changed { paths, saved: saved.clone(), preset: preset.clone() };
        }
        let second = self.compare.against.as_ref().and_then(|against| against.settings(self.saved()));
        let Some(settings) = second else {
            self.second_diff = None;
            return;
        };
        let preset = &self.document.preset;
        if self.second_diff.as_ref().is_none_or(|known| (&known.settings, &known.preset) != (settings, preset)) {
            let paths: HashSet<_> = changed_fields(settings, preset).into_iter().collect();
            let differing_values =
                field_values(settings).into_iter().filter(|(path, _)| paths.contains(path)).collect();
            self.second_diff =
                Some(SecondDiff { differing_values, settings: settings.clone(), preset: preset.clone() });
        }
    }

    /// Shows the reason if typed input is not valid, and clears it after a valid edit.
    pub fn report_refused_input(&mut self, refused: Option<String>, is_edited: bool) {
        match refused {
            Some(refused) => self.messages.error("typed", refused),
            None if is_edited => self.messages.clear("typed"),
            None => {}
        }
    }

    /// Changes the selected light, if there is one.
    pub fn change_light(&mut self, change: impl FnOnce(&mut LightView, &mut Preset, usize)) {
        let preset = &mut self.document.preset;
        if let Some(index) = self.view.lights.selected.filter(|&index| index < preset.lights.len()) {
            change(&mut self.view.lights, preset, index);
        }
    }

    /// Adds a light, and selects it.
    pub fn add_light(&mut self, light: Light) {
        let preset = &mut self.document.preset;
        let end = preset.lights.len();
        self.view.lights.insert(preset, end, light);
    }

    /// Gives settings the values of their keyframes at the time of the playback, until [`Session::end_edit`].
    pub fn begin_edit(&mut self) -> Option<KeyframeEdit> {
        KeyframeEdit::begin(&mut self.document.preset, self.playback.key_time())
    }

    /// Turns changed values of settings with keyframes into keyframes. The playback stops at them.
    pub fn end_edit(&mut self, edit: Option<KeyframeEdit>) {
        if let Some(time) = edit.and_then(|edit| edit.end(&mut self.document.preset)) {
            self.playback.time = f64::from(time);
            self.playback.is_playing = false;
        }
    }

    /// Adds a keyframe of a setting at the time of the playback, or deletes the one that is there.
    pub fn toggle_key(&mut self, setting: &str) {
        let preset = &mut self.document.preset;
        let time = self.playback.key_time();
        match keyframes::track(preset, setting).and_then(|track| keyframes::key_at(track, time)) {
            Some(index) => keyframes::remove_key(preset, setting, index),
            None => {
                keyframes::add_key(preset, setting, time);
                self.view.tracks.select(setting);
            }
        }
    }

    /// Removes the track of a setting, which keeps the value that is shown.
    pub fn remove_track(&mut self, setting: &str) {
        keyframes::remove_track(&mut self.document.preset, setting, self.playback.key_time());
    }

    /// Pastes the copied keyframes into a track, from a time on.
    pub fn paste_keys(&mut self, setting: &str, time: f32) {
        let mut preset = self.document.preset.clone();
        keyframes::paste_keys(&mut preset, setting, time, &self.view.tracks.copied);
        match preset.validate() {
            Ok(()) => self.document.preset = preset,
            Err(error) => self.messages.error("keyframes", format!("Cannot paste: {error}")),
        }
    }

    pub fn undo(&mut self) {
        if let Some(name) = self.document.undo() {
            self.messages.info("undo", format!("Undo: {name}"));
        }
    }

    pub fn redo(&mut self) {
        if let Some(name) = self.document.redo() {
            self.messages.info("undo", format!("Redo: {name}"));
        }
    }

    /// Reads the file again. Undo restores the changes that it replaces.
    pub fn revert(&mut self) {
        self.is_changed_on_disk = false;
        match self.document.revert() {
            Ok(()) => self.messages.clear("preset"),
            Err(error) => self.messages.error("preset", error),
        }
    }

    /// Replaces the document, and resets the state that depended on the old one.
    pub fn replace_document(&mut self, document: Document, loaded: LoadedAssets) {
        let LoadedAssets { materials, particles, backdrop } = loaded;
        self.loaded_materials = LoadedMaterials::new(&document.preset, materials);
        self.particle_files = LoadedParticles::new(&document.preset, particles);
        self.backdrop = LoadedBackdrop::new(&document.preset, backdrop);
        self.backdrop_folders.clear();
        self.playback = Playback { is_playing: self.playback.is_playing, ..Playback::of(&document.preset) };
        self.compare = CompareState::default();
        self.view.system = 0;
        self.is_changed_on_disk = false;
        self.view.systems = SystemView::default();
        self.ramps = RampEdits::default();
        self.copy_request = None;
        self.looks.close();
        self.sprites.forget();
        self.simulation.close();
        let stale = ["preset", "ramp", "sprite", "simulation", "images", "caches", "backdrop", "file"];
        stale.into_iter().for_each(|about| self.messages.clear(about));
        self.document = document;
    }

    /// Replaces the preset by one from a text.
    pub fn paste(&mut self, text: &str) {
        match self.document.paste(text) {
            Ok(()) => self.messages.info("file", "Pasted a preset"),
            Err(error) => self.messages.error("file", format!("Cannot paste: {error}")),
        }
    }
}
