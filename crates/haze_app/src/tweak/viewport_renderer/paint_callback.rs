//! Paint callbacks of egui for the parts of the window that show an image.

use eframe::egui::epaint::ViewportInPixels;
use eframe::egui_wgpu::{self, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::{egui, wgpu};
use haze_demo::shot::Shot;

use super::Easel;
use super::cached_render::Target;
use super::viewport_frame::Exhibit;

impl Easel {
    /// Shows the viewport's image in a part of the window.
    pub fn show(&self, ui: &egui::Ui, rect: egui::Rect, exhibit: Exhibit) {
        self.add(ui, rect, What::Exhibit(Box::new(exhibit)));
    }

    /// Shows a debug view of a shot in a part of the window. All views of one shot are drawn at once.
    pub fn show_stage(&self, ui: &egui::Ui, rect: egui::Rect, shot: Shot) {
        self.add(ui, rect, What::OffscreenRenderer(Box::new(shot)));
    }

    fn add(&self, ui: &egui::Ui, rect: egui::Rect, what: What) {
        let callback = Callback { easel: self.clone(), rect, what };
        ui.painter().add(egui_wgpu::Callback::new_paint_callback(rect, callback));
    }
}

/// Paint callback of one part of the window.
struct Callback {
    easel: Easel,
    rect: egui::Rect,
    what: What,
}

enum What {
    Exhibit(Box<Exhibit>),
    OffscreenRenderer(Box<Shot>),
}

impl CallbackTrait for Callback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if self.easel.health().is_lost() {
            return Vec::new();
        }
        let place = ViewportInPixels::from_points(&self.rect, screen.pixels_per_point, screen.size_in_pixels);
        let mut target = Target { device, queue, encoder, place };
        let mut drawing = self.easel.lock();
        drawing.is_unpainted = true;
        match &self.what {
            What::Exhibit(exhibit) => drawing.record_viewport(&mut target, exhibit),
            What::OffscreenRenderer(shot) => drawing.record_debug_view(&mut target, shot),
        }
        if drawing.motion.wants_next() {
            self.easel.egui().request_repaint();
        }
        // Overlays use the texels of the previous image, so another frame must follow if they have changed.
        if let What::Exhibit(exhibit) = &self.what
            && drawing.update_target_texels(exhibit.shot.preset.systems.len())
        {
            self.easel.egui().request_repaint();
        }
        Vec::new()
    }

    fn paint(&self, info: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let place = info.viewport_in_pixels();
        if place.width_px <= 0 || place.height_px <= 0 {
            return;
        }
        let mut drawing = self.easel.lock();
        drawing.is_unpainted = false;
        let tonemap_bindings = match &self.what {
            What::Exhibit(_) => drawing.pair.as_ref(),
            What::OffscreenRenderer(shot) => drawing.strip.tonemap_bindings[shot.debug_view as usize].as_ref(),
        };
        if let Some(tonemap_bindings) = tonemap_bindings {
            drawing.tonemap_pass.record(pass, tonemap_bindings);
        }
    }
}

#[cfg(test)]
mod tests;
