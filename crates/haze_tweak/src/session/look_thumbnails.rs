//! Thumbnails of the present smoke with every ramp that fits a field, rendered one after the other on a worker thread.

use eframe::egui::{self, ColorImage, TextureHandle, TextureOptions};
use glam::UVec2;
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use haze_preset::{AssetFolders, builtin};
use image::RgbImage;

use crate::document::ramp_edits::ramp_slots;
use crate::platform::clock::{self, Duration, Instant};
use crate::platform::worker::{Ticket, Worker};
use crate::platform::{asset_loading, render_job};

/// Width of a thumbnail, pixels.
pub const WIDTH: u32 = 160;
/// Time for which the smoke must not change before its thumbnails are rendered again.
const MIN_STILL_TIME: Duration = Duration::from_millis(400);

/// Looks of one field of a material, while they are shown.
#[derive(Default)]
pub struct LookThumbnails {
    worker: Option<Worker<(String, Option<RgbImage>)>>,
    shown: Option<ShownLooks>,
}

/// Looks that are shown.
pub struct ShownLooks {
    /// Index of the system, and the field of its material.
    pub system: usize,
    pub field: &'static str,
    pub entries: Vec<LookEntry>,
    /// Smoke of the thumbnails, with the same ramp in the field whatever the preset names there.
    rendered: Option<Shot>,
    /// Smoke that differs from it, and the time since when it has not changed.
    wanted: Option<(Shot, Instant)>,
    tickets: Vec<Ticket>,
}

/// Ramp, and the smoke that it makes.
pub struct LookEntry {
    pub name: String,
    /// `None` until it is rendered.
    pub image: Option<TextureHandle>,
}

/// Returns the size of a thumbnail of a view, pixels: its shape, but at most as high as wide.
pub fn thumbnail_size(view: UVec2) -> UVec2 {
    let aspect = view.y as f32 / view.x.max(1) as f32;
    UVec2::new(WIDTH, (WIDTH as f32 * aspect.clamp(0.3, 1.0)).round() as u32)
}

impl LookThumbnails {
    /// Shows the ramps of these names in a field.
    pub fn open(&mut self, system: usize, field: &'static str, names: Vec<String>) {
        self.close();
        let entries = names.into_iter().map(|name| LookEntry { name, image: None }).collect();
        self.shown = Some(ShownLooks { system, field, entries, rendered: None, wanted: None, tickets: Vec::new() });
    }

    /// Closes the list. Returns true if it was open.
    pub fn close(&mut self) -> bool {
        let shown = self.shown.take();
        shown.iter().flat_map(|shown| &shown.tickets).for_each(Ticket::cancel);
        shown.is_some()
    }

    pub fn shown(&self) -> Option<&ShownLooks> {
        self.shown.as_ref()
    }

    /// Takes finished thumbnails, and requests new ones as soon as the smoke stands still. `shot`: the present view.
    pub fn advance(&mut self, context: &egui::Context, shot: &Shot, folders: &AssetFolders) {
        let Some(shown) = &mut self.shown else { return };
        while let Some(Some((name, image))) = self.worker.as_ref().and_then(Worker::poll) {
            if let Some((entry, image)) = shown.entries.iter_mut().find(|entry| entry.name == name).zip(image) {
                let size = [image.width() as usize, image.height() as usize];
                let image = ColorImage::from_rgb(size, &image);
                entry.image = Some(context.load_texture(name, image, TextureOptions::LINEAR));
            }
        }
        let shot = Shot { size: thumbnail_size(shot.size), ..shot.clone() };
        // The ramp of the field at the time of the first rendering, so that equal smoke shares all images.
        let system = shown.system;
        let field = shown.field;
        let of = |shot: &Shot| ramp_of(shot, system, field);
        let Some(neutral) = shown.rendered.as_ref().and_then(of).or_else(|| of(&shot)) else { return };
        let key = with_ramp(&shot, system, field, "", neutral);
        let is_same = |known: &Shot| known.has_same_image(&key) && known.preset.camera == key.preset.camera;
        if shown.rendered.as_ref().is_some_and(is_same) {
            shown.wanted = None;
            return;
        }
        let now = clock::now();
        let since = match &shown.wanted {
            Some((wanted, since)) if is_same(wanted) => *since,
            _ => now,
        };
        let left = MIN_STILL_TIME.saturating_sub(now.duration_since(since));
        shown.wanted = Some((key.clone(), since));
        if shown.rendered.is_some() && left > Duration::ZERO {
            context.request_repaint_after(left);
            return;
        }
        if self.worker.is_none() {
            let context = context.clone();
            // Without a thread, only names are shown.
            self.worker = Worker::new("looks", move || context.request_repaint()).ok();
        }
        shown.tickets.drain(..).for_each(|ticket| ticket.cancel());
        if let Some(worker) = &self.worker {
            for entry in &shown.entries {
                let name = entry.name.clone();
                let shot = shot.clone();
                let folders = folders.clone();
                shown.tickets.push(worker.submit_async(async move |_| {
                    let image = draw(&shot, system, field, &name, &folders).await;
                    (name, image.ok())
                }));
            }
        }
        shown.rendered = Some(key);
        shown.wanted = None;
    }
}

/// Loads a ramp, built in or from a file.
fn ramp(name: &str, folders: &AssetFolders) -> Result<Ramp, Error> {
    match builtin::find(builtin::RAMPS, name) {
        Some(builtin) => Ok(builtin.ramp()?),
        None => asset_loading::ramp(&asset_loading::image_path(name, folders)),
    }
}

/// Returns the ramp in a field.
fn ramp_of(shot: &Shot, system: usize, field: &str) -> Option<Ramp> {
    let found = shot.preset.systems.get(system)?;
    let mut assets = shot.materials.get(system)?.clone();
    let slots = ramp_slots(&found.material, &mut assets);
    slots.into_iter().find(|slot| slot.0 == field).map(|slot| slot.2.clone())
}

/// Returns a shot with another ramp in a field.
fn with_ramp(shot: &Shot, system: usize, field: &str, name: &str, ramp: Ramp) -> Shot {
    let mut shot = shot.clone();
    let path = format!("systems[{system}].material.{field}");
    if let (Some(found), Some(assets)) = (shot.preset.systems.get(system), shot.materials.get_mut(system)) {
        ramp_slots(&found.material, assets).into_iter().filter(|slot| slot.0 == field).for_each(|slot| {
            *slot.2 = ramp.clone();
        });
    }
    // An unknown field has no slot either.
    _ = haze_core::settings::set_field(&mut shot.preset, &path, name);
    shot
}

async fn draw(shot: &Shot, system: usize, field: &str, name: &str, folders: &AssetFolders) -> Result<RgbImage, Error> {
    let shot = with_ramp(shot, system, field, name, ramp(name, folders)?);
    let image = render_job::open_thumbnail_backend()?.render_async(&shot).await?;
    Ok(tonemap(&image, &shot))
}
