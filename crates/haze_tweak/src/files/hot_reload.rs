//! Hot reload of ramps, sprites, particle files, scene and sky, the preset and shaders, however the files are saved.
//!
//! A worker thread decodes images and compiles shaders. Valid results replace those that are shown; errors are reported
//! until the files are fixed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use haze::MaterialAssets;
use haze::shader::{self, Sources};
use haze_author::backdrop::Backdrop;
use haze_author::particle_files::ParticleFrames;
use haze_core::error::{AssetError, Error, PrepareError};
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_export::inputs::{backdrop_file_paths, relative_image_paths};
use haze_export::recipe_files::recipe_paths;
use haze_preset::{MaterialSources, Preset};

use crate::document::OnDisk;
use crate::document::loaded_backdrop::{self, LoadedBackdrop};
use crate::document::loaded_materials::{LoadedMaterials, names};
use crate::document::loaded_particles::{LoadedParticles, paths};
use crate::document::sprite_edits::sprite_source::detail_of;
use crate::platform::asset_loading;
use crate::platform::file_io::Watcher;
use crate::platform::worker::{Ticket, Worker};
use crate::session::Session;
use crate::viewport_renderer::ViewportRenderer;

/// Watches the files of a session.
pub struct HotReload {
    watcher: Watcher,
    worker: Worker<ReloadResult>,
    /// Files that were last requested.
    requested_files: Asked,
    /// Loads in progress.
    images: Option<Ticket>,
    particle_files: Option<Ticket>,
    backdrop: Option<Ticket>,
    /// Files of scene and sky that are watched.
    backdrop_files: Vec<PathBuf>,
    shaders: Option<Shaders>,
}

/// Path of the preset, the images and particle files that its systems name, and the names of scene and sky.
type Asked = (PathBuf, Vec<MaterialSources>, Vec<String>, [String; 2]);

/// Watched folder of shaders.
struct Shaders {
    folder: PathBuf,
    files: Vec<PathBuf>,
    checking: Option<Ticket>,
}

/// Result from the worker thread.
enum ReloadResult {
    Images(Box<Preset>, Result<Vec<MaterialAssets>, Error>),
    ParticleFiles(Box<Preset>, Result<Vec<Option<ParticleFrames>>, Error>),
    Backdrop(Box<Preset>, Result<Backdrop, Error>),
    /// With the files to watch.
    Shaders(Vec<PathBuf>, Result<(OffscreenContext, Sources), Error>),
}

/// Source of the shaders.
#[derive(Clone, Debug)]
pub enum ShaderFolder {
    /// The built-in shaders; nothing is watched.
    None,
    /// A folder whose files replace the built-in shaders from the start.
    Given(PathBuf),
    /// The folder that the built-in shaders were compiled from. They are used until a file changes.
    Checkout(PathBuf),
}

impl ShaderFolder {
    /// Returns the default source: the folder of the checkout if `cargo run` started the program.
    pub fn of_checkout() -> Self {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        // The package of the program is beside this one.
        match std::env::var_os("CARGO_MANIFEST_DIR") {
            Some(program) if Path::new(&program).parent() == package.parent() => {
                Self::Checkout(package.join("../../shaders"))
            }
            _ => Self::None,
        }
    }
}

impl HotReload {
    /// Watches the files of a session. `wake` is called from other threads when something has changed.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the system cannot start another thread.
    pub fn new(
        session: &Session,
        shaders: &ShaderFolder,
        renderer: &ViewportRenderer,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        let thread = |error| Error::from(AssetError::Io { path: "a thread to follow files".into(), error });
        let wake = Arc::new(wake);
        let its = Arc::clone(&wake);
        let mut hot_reload = Self {
            watcher: Watcher::new(move || its()).map_err(thread)?,
            worker: Worker::new("haze reload", move || wake()).map_err(thread)?,
            requested_files: requested_files(session),
            images: None,
            particle_files: None,
            backdrop: None,
            backdrop_files: Vec::new(),
            shaders: match shaders {
                ShaderFolder::None => None,
                ShaderFolder::Given(folder) | ShaderFolder::Checkout(folder) => Some(Shaders::new(folder)),
            },
        };
        hot_reload.watch(session);
        // Edited shaders must also be compiled for a new device.
        if matches!(shaders, ShaderFolder::Given(_)) || session.shaders.is_some() {
            hot_reload.check_shaders(session, renderer);
        }
        // Files may have been written after they were read and before they were watched.
        hot_reload.load_images(session);
        hot_reload.load_particle_files(session);
        hot_reload.load_backdrop(session);
        Ok(hot_reload)
    }

    /// Handles changed files and finished loads. Call once a frame.
    pub fn advance(&mut self, session: &mut Session, renderer: &ViewportRenderer) {
        if let Some(note) = self.watcher.take_message() {
            session.messages.info("watch", note);
        }
        let now = requested_files(session);
        if now != self.requested_files {
            let has_particle_files = (&now.0, &now.2) != (&self.requested_files.0, &self.requested_files.2);
            let has_backdrop = !session.backdrop.is_of(&session.document.preset) || now.0 != self.requested_files.0;
            self.requested_files = now;
            self.watch(session);
            // Files may have been written after they were read and before they were watched.
            changed_on_disk(session);
            mark_edits_stale(session);
            self.load_images(session);
            if has_particle_files {
                self.load_particle_files(session);
            }
            if has_backdrop {
                self.load_backdrop(session);
            }
        }
        let mut has_images = false;
        let mut has_particle_files = false;
        let mut has_shaders = false;
        let mut has_backdrop = false;
        for file in self.watcher.poll() {
            if self.shaders.as_ref().is_some_and(|shaders| shaders.files.contains(&file)) {
                has_shaders = true;
            } else if file == session.document.path() {
                changed_on_disk(session);
            } else if self.backdrop_files.contains(&file) {
                has_backdrop = true;
            } else if has_ending(&file, "png") {
                has_images = true;
                mark_edits_stale(session);
            } else if has_ending(&file, "json") {
                mark_edits_stale(session);
            } else {
                has_particle_files = true;
            }
        }
        if has_images {
            self.load_images(session);
        }
        if has_particle_files {
            // A sequence may have gained a frame, which must be watched too.
            self.watch(session);
            self.load_particle_files(session);
        }
        if has_backdrop {
            self.load_backdrop(session);
        }
        if has_shaders {
            self.check_shaders(session, renderer);
        }
        while let Some(loaded) = self.worker.poll() {
            self.apply(loaded, session, renderer);
        }
    }

    fn watch(&mut self, session: &Session) {
        let loaded = session.backdrop.of(&session.document.preset);
        self.backdrop_files = backdrop_file_paths(&session.folders(), &session.document.preset);
        self.backdrop_files.extend(loaded.files().map(Path::to_owned));
        let shaders = self.shaders.iter().flat_map(|shaders| shaders.files.iter().cloned());
        let folders = session.folders();
        let images = relative_image_paths(&session.document.preset);
        // The recipe of a sprite also makes its detail image, even if the preset does not name that.
        let beside = images.iter().flat_map(|image| recipe_paths(image).chain([detail_of(image)]));
        let beside = beside.flat_map(|file| folders.candidate_paths(&file).collect::<Vec<_>>());
        self.watcher.set(
            session
                .document
                .files(&folders)
                .into_iter()
                .chain(beside)
                .chain(shaders)
                .chain(self.backdrop_files.clone()),
        );
    }

    /// Loads the images that the preset names. The present ones stay if that fails.
    fn load_images(&mut self, session: &Session) {
        let preset = Box::new(session.document.preset.clone());
        let path = session.document.path().to_owned();
        let old = session.loaded_materials.clone();
        let folders = session.folders();
        let ticket = self.worker.submit(move |_| {
            let loaded = asset_loading::images(&preset, &path, &folders).map(|loaded| old.reuse_equal(loaded));
            ReloadResult::Images(preset, loaded)
        });
        // Only the latest load counts.
        if let Some(before) = self.images.replace(ticket) {
            before.cancel();
        }
    }

    /// Loads the particle files that the preset names. The present ones stay if that fails.
    fn load_particle_files(&mut self, session: &Session) {
        let preset = Box::new(session.document.preset.clone());
        let path = session.document.path().to_owned();
        let folders = session.folders();
        let ticket = self.worker.submit(move |_| {
            let loaded = asset_loading::particles(&preset, &path, &folders);
            ReloadResult::ParticleFiles(preset, loaded)
        });
        if let Some(before) = self.particle_files.replace(ticket) {
            before.cancel();
        }
    }

    /// Loads scene and sky that the preset names. The present ones stay if that fails.
    fn load_backdrop(&mut self, session: &Session) {
        let preset = Box::new(session.document.preset.clone());
        let path = session.document.path().to_owned();
        let folders = session.folders();
        let ticket = self.worker.submit(move |_| {
            let loaded = asset_loading::backdrop(&preset, &path, &folders);
            ReloadResult::Backdrop(preset, loaded)
        });
        if let Some(before) = self.backdrop.replace(ticket) {
            before.cancel();
        }
    }

    /// Compiles the shaders, and the pipelines that the preset needs, on the worker thread.
    pub fn check_shaders(&mut self, session: &Session, renderer: &ViewportRenderer) {
        let Some(shaders) = &mut self.shaders else { return };
        let folder = shaders.folder.clone();
        let context = renderer.context();
        let shot = session.shot(glam::UVec2::new(64, 36));
        let ticket = self.worker.submit(move |_| {
            let mut files = embedded_names(&folder);
            let checked = check(&folder, &context, &shot, &mut files);
            if let Err(
                Error::Asset(AssetError::Io { path, .. } | AssetError::Text { path, .. })
                | Error::Prepare(PrepareError::Shader { path, .. }),
            ) = &checked
                && path.starts_with(&folder)
            {
                // A file that could not be read is watched as well.
                add(&mut files, path);
            }
            ReloadResult::Shaders(files, checked)
        });
        if let Some(before) = shaders.checking.replace(ticket) {
            before.cancel();
        }
    }

    fn apply(&mut self, loaded: Option<ReloadResult>, session: &mut Session, renderer: &ViewportRenderer) {
        match loaded {
            Some(ReloadResult::Images(preset, Ok(loaded))) => {
                session.loaded_materials = LoadedMaterials::new(&preset, loaded);
                session.messages.clear("images");
            }
            Some(ReloadResult::ParticleFiles(preset, Ok(loaded))) => {
                session.particle_files = LoadedParticles::new(&preset, loaded);
                session.messages.clear("caches");
            }
            Some(ReloadResult::ParticleFiles(_, Err(error))) => session.messages.error("caches", error),
            Some(ReloadResult::Backdrop(preset, Ok(loaded))) => {
                session.backdrop = LoadedBackdrop::new(&preset, loaded);
                session.messages.clear("backdrop");
                session.report_missing_backdrop();
                self.watch(session);
            }
            Some(ReloadResult::Backdrop(_, Err(error))) => session.messages.error("backdrop", error),
            // The bake writes it, and then it is read again.
            Some(ReloadResult::Images(_, Err(_))) if session.sprites.is_baking() => {}
            Some(ReloadResult::Images(_, Err(error))) => session.messages.error("images", error),
            Some(ReloadResult::Shaders(files, checked)) => {
                if let Some(shaders) = &mut self.shaders {
                    shaders.files = files;
                }
                self.watch(session);
                let put = checked.and_then(|(context, sources)| renderer.replace_context(context).map(|()| sources));
                match put {
                    Ok(sources) => {
                        session.shaders = Some(sources);
                        session.messages.clear("shaders");
                    }
                    Err(error) => session.messages.error("shaders", error),
                }
            }
            None => {
                session.messages.error("reload", "A changed file was not loaded: internal error");
            }
        }
    }
}

impl Shaders {
    fn new(folder: &Path) -> Self {
        Self { folder: folder.into(), files: embedded_names(folder), checking: None }
    }
}

fn requested_files(session: &Session) -> Asked {
    let preset = &session.document.preset;
    (session.document.path().to_owned(), names(preset), paths(preset), loaded_backdrop::names(preset))
}

/// Returns the paths in the folder of files that would replace built-in shaders.
fn embedded_names(folder: &Path) -> Vec<PathBuf> {
    shader::sources().iter().map(|(name, _)| folder.join(name)).collect()
}

/// Returns a context with the folder's shaders after compiling the pipelines of the shot. Adds imported files to
/// `files`.
fn check(
    folder: &Path,
    context: &OffscreenContext,
    shot: &Shot,
    files: &mut Vec<PathBuf>,
) -> Result<(OffscreenContext, Sources), Error> {
    let sources = asset_loading::shaders(folder)?;
    sources.paths().for_each(|path| add(files, path));
    let context = context.with_shaders(&sources)?;
    OffscreenRenderer::new(&context, false)?.warm_up(shot)?;
    Ok((context, sources))
}

fn add(files: &mut Vec<PathBuf>, path: &Path) {
    if !files.iter().any(|file| file == path) {
        files.push(path.to_owned());
    }
}

/// Marks ramps and sprites to be compared with their files.
fn mark_edits_stale(session: &mut Session) {
    session.ramps.mark_stale();
    session.sprites.mark_stale();
}

fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Handles a changed preset file. It is loaded if there are no unsaved changes; otherwise the user chooses a version.
fn changed_on_disk(session: &mut Session) {
    match session.document.on_disk() {
        OnDisk::Same => {
            session.is_changed_on_disk = false;
            session.messages.clear("preset");
        }
        OnDisk::Gone => {
            let name = session.document.path().display();
            session.messages.error("preset", format!("{name} was deleted. Save writes it again."));
        }
        OnDisk::Changed if session.document.is_dirty() => session.is_changed_on_disk = true,
        OnDisk::Changed => session.revert(),
    }
}

#[cfg(test)]
mod tests;
