//! A picture of the window, on its way to a file.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{self, Ui};
use haze::Error;
use image::RgbImage;

use super::platform::files::{Effort, write_png};
use super::session::Session;

/// Frames after which a window stands still.
const SETTLED: u32 = 6;

#[derive(Default)]
pub struct Screenshot {
    /// Frames that have been shown.
    frames: u32,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
}

impl Screenshot {
    /// Once a frame: takes the picture if one was asked for, and closes the window when it is written.
    pub fn advance(&mut self, ui: &Ui, session: &mut Session) {
        let Some(path) = session.screenshot.clone() else { return };
        self.frames += 1;
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(picture) = taken {
            if let Err(error) = write(&path, &picture) {
                session.messages.complain("screenshot", error);
            }
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        } else if self.frames == SETTLED {
            let (taken, context) = (self.taken.clone(), ui.ctx().clone());
            ui.ctx().request_screenshot(move |picture| {
                *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(picture);
                context.request_repaint();
            });
        }
        ui.ctx().request_repaint();
    }
}

fn write(path: &Path, picture: &egui::ColorImage) -> Result<(), Error> {
    let [width, height] = picture.size.map(|side| side as u32);
    let bytes = picture.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    let picture = RgbImage::from_raw(width, height, bytes).unwrap_or_default();
    write_png(path, &picture.into(), Effort::Small)
}
