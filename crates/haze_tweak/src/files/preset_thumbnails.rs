//! Presets to start from: names and descriptions, and thumbnails, which are rendered one at a time in pauses of the user.

use std::path::{Path, PathBuf};

use eframe::egui;
use haze_core::error::{AssetError, Error};
use haze_demo::tonemap_pass::tonemap;
use haze_preset::{AssetFolders, Preset, builtin};
use image::RgbImage;

use super::thumbnail_cache::{SIZE, ThumbnailCache};
use crate::platform::file_io::Stamp;
use crate::platform::idle_timer::IdleTimer;
use crate::platform::worker::{Ticket, Worker};
use crate::platform::{asset_loading, file_io, render_job};

/// Largest number of files that are listed.
const MAX_PRESETS: usize = 200;

/// List of presets that the user can open.
pub struct PresetThumbnails {
    worker: Worker<(PathBuf, Result<FoundPreset, Error>)>,
    pub entries: Vec<PresetEntry>,
    /// Files that were open before, the last one first.
    pub recent: Vec<PathBuf>,
    tickets: Vec<Ticket>,
    pub cache: ThumbnailCache,
    assets: Option<PathBuf>,
}

/// Preset in the list.
pub struct PresetEntry {
    /// Path of a file, or name of a built-in preset.
    pub path: PathBuf,
    /// Stamp of the file when it was read.
    stamp: Option<Stamp>,
    /// `None` until it is read.
    pub about: Option<PresetAbout>,
    /// `None` until it is rendered.
    pub image: Option<egui::TextureHandle>,
    is_rendering: bool,
}

/// Words about a preset.
pub struct PresetAbout {
    pub name: String,
    pub description: String,
}

impl PresetAbout {
    fn of(preset: Preset) -> Self {
        Self { name: preset.name, description: preset.description }
    }
}

/// Preset from the worker.
struct FoundPreset {
    about: PresetAbout,
    /// `None` if none was kept.
    image: Option<RgbImage>,
}

impl PresetThumbnails {
    /// `wake` is called from the worker thread when a thumbnail is ready.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the system cannot start another thread.
    pub fn new(cache: ThumbnailCache, wake: impl Fn() + Send + 'static) -> Result<Self, Error> {
        let worker = Worker::new("haze thumbnails", wake);
        let worker = worker
            .map_err(|error| Error::from(AssetError::Io { path: "a thread to draw thumbnails".into(), error }))?;
        Ok(Self { worker, entries: Vec::new(), recent: Vec::new(), tickets: Vec::new(), cache, assets: None })
    }

    /// Lists the built-in presets and the JSON files of a folder, and reads those that are new or changed. Their images may
    /// also lie in `assets`. Of the files of `recent`, those that are gone are left out.
    pub fn list(&mut self, folder: &Path, assets: Option<&Path>, recent: &[PathBuf]) {
        self.recent = recent.iter().filter(|path| file_io::exists(path)).cloned().collect();
        let built_in = builtin::PRESETS.iter().map(|preset| PathBuf::from(preset.name));
        let is_preset = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // Other JSON files are recipes, such as a.ramp.json.
            name.ends_with(".json") && name.matches('.').count() == 1
        };
        let files = file_io::list(folder).into_iter().filter(is_preset).take(MAX_PRESETS);
        let mut known = std::mem::take(&mut self.entries);
        self.stop();
        self.assets = assets.map(Path::to_owned);
        for path in built_in.chain(files) {
            let stamp = Stamp::of(&path);
            let same =
                known.iter().position(|entry| entry.path == path && entry.stamp == stamp && entry.image.is_some());
            if let Some(same) = same {
                self.entries.push(known.swap_remove(same));
                continue;
            }
            // The words of built-in presets are there at once, so that nothing moves under the pointer.
            let about = if is_built_in(&path) { file_io::read_preset(&path).ok() } else { None };
            let about = about.map(|(preset, _)| PresetAbout::of(preset));
            self.entries.push(PresetEntry { path: path.clone(), stamp, about, image: None, is_rendering: false });
            let cache = self.cache.clone();
            self.tickets.push(self.worker.submit(move |_| {
                let found = read(&path, &cache);
                (path, found)
            }));
        }
    }

    /// Takes what was read and rendered, and requests the next thumbnail in a pause of the user. Files that are not presets
    /// leave the list.
    pub fn advance(&mut self, context: &egui::Context, idle: IdleTimer) {
        while let Some(done) = self.worker.poll() {
            let Some((path, found)) = done else { continue };
            match found {
                Ok(FoundPreset { about, image }) => {
                    let Some(entry) = self.entries.iter_mut().find(|entry| entry.path == path) else { continue };
                    let texture = |image: RgbImage| {
                        let image = egui::ColorImage::from_rgb([SIZE.x as usize, SIZE.y as usize], &image);
                        context.load_texture(&about.name, image, egui::TextureOptions::LINEAR)
                    };
                    entry.image = image.map(texture);
                    entry.about = Some(about);
                }
                Err(_) => self.entries.retain(|entry| entry.path != path || entry.about.is_some()),
            }
        }
        if self.worker.is_busy() {
            return;
        }
        let is_due = |entry: &&mut PresetEntry| entry.about.is_some() && entry.image.is_none() && !entry.is_rendering;
        let Some(entry) = self.entries.iter_mut().find(is_due) else { return };
        if idle.is_idle(context) {
            entry.is_rendering = true;
            let path = entry.path.clone();
            let assets = self.assets.clone();
            let cache = self.cache.clone();
            self.tickets.push(self.worker.submit_async(async move |_: Ticket| {
                let found = render(&path, assets, &cache).await;
                (path, found)
            }));
        }
    }

    /// Returns true while a thumbnail is rendered.
    #[cfg(test)]
    pub fn is_rendering(&self) -> bool {
        self.worker.is_busy() && self.entries.iter().any(|entry| entry.is_rendering && entry.image.is_none())
    }

    /// Cancels the thumbnails that are not rendered yet.
    pub fn stop(&mut self) {
        self.tickets.drain(..).for_each(|ticket| ticket.cancel());
    }
}

/// Reads a preset, and its thumbnail if one was kept.
fn read(path: &Path, cache: &ThumbnailCache) -> Result<FoundPreset, Error> {
    let (preset, text) = file_io::read_preset(path)?;
    let image = is_built_in(path).then(|| cache.read(path, &text)).flatten();
    Ok(FoundPreset { image, about: PresetAbout::of(preset) })
}

/// Renders the thumbnail of a preset, and keeps that of a built-in one.
async fn render(path: &Path, assets: Option<PathBuf>, cache: &ThumbnailCache) -> Result<FoundPreset, Error> {
    let folders = AssetFolders::for_preset_file(path).with_shared(assets);
    let shot = asset_loading::shot(path, &folders, SIZE)?;
    let image = render_job::open_thumbnail_backend()?.render_async(&shot).await?;
    let image = tonemap(&image, &shot);
    if is_built_in(path) {
        let (_, text) = file_io::read_preset(path)?;
        cache.write(path, &text, &image);
    }
    Ok(FoundPreset { image: Some(image), about: PresetAbout::of(shot.preset) })
}

/// Returns true for the name of a built-in preset, whose images are built in too.
fn is_built_in(path: &Path) -> bool {
    path.to_str().and_then(|name| builtin::find(builtin::PRESETS, name)).is_some()
}
