//! Screenshot of the window, written to a file.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{self, Ui};
use haze_core::error::Error;
use image::RgbImage;

use crate::platform::file_io::{CompressionEffort, write_png};
use crate::session::Session;

/// Number of frames after which the window has settled.
const SETTLED_FRAMES: u32 = 6;
/// Number of frames after which a system whose thumbnail fails is no longer waited for.
const MAX_FRAMES: u32 = 1000;

#[derive(Default)]
pub struct Screenshot {
    /// Number of frames that were shown.
    frames: u32,
    is_requested: bool,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
}

impl Screenshot {
    /// Takes the requested screenshot, and closes the window when it is written. Call once a frame.
    pub fn advance(&mut self, ui: &Ui, session: &mut Session) {
        let Some(path) = session.screenshot.clone() else { return };
        self.frames += 1;
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(image) = taken {
            if let Err(error) = write(&path, &image) {
                session.messages.error("screenshot", error);
            }
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        } else if !self.is_requested && self.is_settled(session) {
            self.is_requested = true;
            let taken = self.taken.clone();
            let context = ui.ctx().clone();
            ui.ctx().request_screenshot(move |image| {
                *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
                context.request_repaint();
            });
        }
        ui.ctx().request_repaint();
    }

    fn is_settled(&self, session: &Session) -> bool {
        let images = &session.view.systems.images;
        let has_images = images.len() == session.document.preset.systems.len() && images.iter().all(Option::is_some);
        self.frames >= SETTLED_FRAMES && has_images || self.frames >= MAX_FRAMES
    }
}

pub(super) fn write(path: &Path, image: &egui::ColorImage) -> Result<(), Error> {
    let [width, height] = image.size.map(|side| side as u32);
    let bytes = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    let image = RgbImage::from_raw(width, height, bytes).unwrap_or_default();
    Ok(write_png(path, &image.into(), CompressionEffort::Small)?)
}
