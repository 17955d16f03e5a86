//! PSNR of the two compared images, computed on a worker thread so that no frame waits for it.

use eframe::egui;
use haze_demo::image_metrics::PsnrReport;

use super::ViewportRenderer;
use crate::platform::repaint_handle::RepaintHandle;
use crate::platform::worker::Worker;

#[derive(Default)]
pub struct PsnrJob {
    worker: Option<Worker<Option<PsnrReport>>>,
    /// PSNR of the last pair of images that was read back.
    pub report: Option<PsnrReport>,
}

impl PsnrJob {
    /// Takes finished results and requests missing ones. Call once a frame. `is_on`: two images are shown.
    pub fn update(&mut self, context: &egui::Context, renderer: &ViewportRenderer, wake: &RepaintHandle, is_on: bool) {
        renderer.want_comparison(is_on);
        if !is_on {
            self.report = None;
            return;
        }
        if let Some(comparison) = renderer.take_comparison() {
            // If no thread can be started, no figures are shown.
            let wake = wake.clone();
            let worker = self.worker.take().or_else(|| Worker::new("psnr", move || wake.call()).ok());
            if let Some(worker) = &worker {
                worker.submit(move |_| comparison.read());
            }
            self.worker = worker;
        } else if renderer.is_comparing() {
            context.request_repaint();
        }
        if let Some(answer) = self.worker.as_ref().and_then(Worker::poll) {
            self.report = answer.flatten();
        }
    }

    /// Returns the figures as text for the user.
    pub fn text(&self) -> Option<String> {
        let decibels = |figure: f32| if figure.is_finite() { format!("{figure:.1} dB") } else { "the same".into() };
        let PsnrReport { psnr, edge_psnr } = self.report?;
        let edges = edge_psnr.map(|figure| format!("   edges {}", decibels(figure))).unwrap_or_default();
        Some(format!("PSNR {}{edges}", decibels(psnr)))
    }
}
