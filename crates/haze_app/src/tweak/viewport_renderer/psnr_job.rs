//! PSNR of the two compared images, computed on a worker thread so that no frame waits for it.

use eframe::egui;
use haze_demo::image_metrics::PsnrReport;

use super::Easel;
use crate::tweak::platform::repaint_handle::RepaintHandle;
use crate::tweak::platform::worker::Worker;

#[derive(Default)]
pub struct PsnrJob {
    worker: Option<Worker<Option<PsnrReport>>>,
    /// PSNR of the last pair of images that was read back.
    pub apart: Option<PsnrReport>,
}

impl PsnrJob {
    /// Takes finished results and requests missing ones. Call once a frame. `is_on`: two images are shown.
    pub fn update(&mut self, context: &egui::Context, easel: &Easel, wake: &RepaintHandle, is_on: bool) {
        easel.want_comparison(is_on);
        if !is_on {
            self.apart = None;
            return;
        }
        if let Some(comparison) = easel.take_comparison() {
            // If no thread can be started, no figures are shown.
            let wake = wake.clone();
            let worker = self.worker.take().or_else(|| Worker::new("gauge", move || wake.call()).ok());
            if let Some(worker) = &worker {
                worker.submit(move |_| comparison.read());
            }
            self.worker = worker;
        } else if easel.is_comparing() {
            context.request_repaint();
        }
        if let Some(answer) = self.worker.as_ref().and_then(Worker::poll) {
            self.apart = answer.flatten();
        }
    }

    /// Returns the figures as text for the user.
    pub fn text(&self) -> Option<String> {
        let decibels = |figure: f32| if figure.is_finite() { format!("{figure:.1} dB") } else { "the same".into() };
        let PsnrReport { psnr, edge_psnr } = self.apart?;
        let edges = edge_psnr.map(|figure| format!("   edges {}", decibels(figure))).unwrap_or_default();
        Some(format!("PSNR {}{edges}", decibels(psnr)))
    }
}
