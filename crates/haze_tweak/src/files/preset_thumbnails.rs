//! Thumbnails of presets, rendered one after the other on a worker thread.

use std::path::{Path, PathBuf};

use eframe::egui;
use glam::UVec2;
use haze_core::error::{AssetError, Error};
use haze_demo::tonemap_pass::tonemap;
use haze_preset::{AssetFolders, builtin};
use image::RgbImage;

use crate::platform::file_io::Stamp;
use crate::platform::worker::{Ticket, Worker};
use crate::platform::{asset_loading, file_io, render_job};

/// Size of a thumbnail, pixels.
pub const SIZE: UVec2 = UVec2::new(160, 90);

/// Largest number of files that are listed.
const MAX_PRESETS: usize = 200;

/// List of presets that the user can open.
pub struct PresetThumbnails {
    worker: Worker<(PathBuf, Result<RenderedPreset, Error>)>,
    pub entries: Vec<PresetEntry>,
    tickets: Vec<Ticket>,
}

/// Preset in the list.
pub struct PresetEntry {
    /// Path of a file, or name of a built-in preset.
    pub path: PathBuf,
    /// Stamp of the file when it was rendered.
    stamp: Option<Stamp>,
    /// `None` until it is rendered.
    pub shown: Option<PresetThumbnail>,
}

/// Rendered preset.
pub struct PresetThumbnail {
    pub name: String,
    pub description: String,
    pub image: egui::TextureHandle,
}

struct RenderedPreset {
    name: String,
    description: String,
    image: RgbImage,
}

impl PresetThumbnails {
    /// `wake` is called from the worker thread when a thumbnail is ready.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the system cannot start another thread.
    pub fn new(wake: impl Fn() + Send + 'static) -> Result<Self, Error> {
        let worker = Worker::new("haze thumbnails", wake);
        let worker = worker
            .map_err(|error| Error::from(AssetError::Io { path: "a thread to draw thumbnails".into(), error }))?;
        Ok(Self { worker, entries: Vec::new(), tickets: Vec::new() })
    }

    /// Lists the built-in presets and the JSON files of a folder, and renders those that are new or changed. Their
    /// images may also lie in `assets`.
    pub fn list(&mut self, folder: &Path, assets: Option<&Path>) {
        let built_in = builtin::PRESETS.iter().map(|preset| PathBuf::from(preset.name));
        let is_preset = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // Other JSON files are recipes, such as a.ramp.json.
            name.ends_with(".json") && name.matches('.').count() == 1
        };
        let files = file_io::list(folder).into_iter().filter(is_preset).take(MAX_PRESETS);
        let mut known = std::mem::take(&mut self.entries);
        self.tickets.drain(..).for_each(|ticket| ticket.cancel());
        for path in built_in.chain(files) {
            let stamp = Stamp::of(&path);
            let same =
                known.iter().position(|entry| entry.path == path && entry.stamp == stamp && entry.shown.is_some());
            if let Some(same) = same {
                self.entries.push(known.swap_remove(same));
                continue;
            }
            self.entries.push(PresetEntry { path: path.clone(), stamp, shown: None });
            let assets = assets.map(Path::to_owned);
            let job = async move |_: Ticket| {
                let drawn = draw(&path, assets).await;
                (path, drawn)
            };
            self.tickets.push(self.worker.submit_async(job));
        }
    }

    /// Takes finished thumbnails. Files that are not presets leave the list.
    pub fn advance(&mut self, context: &egui::Context) {
        while let Some(done) = self.worker.poll() {
            let Some((path, drawn)) = done else { continue };
            match drawn {
                Ok(drawn) => {
                    let image = egui::ColorImage::from_rgb([SIZE.x as usize, SIZE.y as usize], &drawn.image);
                    let image = context.load_texture(drawn.name.clone(), image, egui::TextureOptions::LINEAR);
                    let shown = PresetThumbnail { name: drawn.name, description: drawn.description, image };
                    if let Some(entry) = self.entries.iter_mut().find(|entry| entry.path == path) {
                        entry.shown = Some(shown);
                    }
                }
                Err(_) => self.entries.retain(|entry| entry.path != path),
            }
        }
    }

    /// Cancels the thumbnails that are not rendered yet.
    pub fn stop(&mut self) {
        self.tickets.drain(..).for_each(|ticket| ticket.cancel());
    }
}

async fn draw(path: &Path, assets: Option<PathBuf>) -> Result<RenderedPreset, Error> {
    let folders = AssetFolders::for_preset_file(path).with_shared(assets);
    let shot = asset_loading::shot(path, &folders, SIZE)?;
    let image = render_job::open_thumbnail_backend()?.render_async(&shot).await?;
    let image = tonemap(&image, &shot);
    Ok(RenderedPreset { image, name: shot.preset.name, description: shot.preset.description })
}
