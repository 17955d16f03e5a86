//! Paint callbacks of egui for the parts of the window that show an image.

use eframe::egui::epaint::ViewportInPixels;
use eframe::egui_wgpu::{self, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::{egui, wgpu};
use haze_demo::shot::Shot;

use super::ViewportRenderer;
use super::cached_render::Target;
use super::stage_queue::StageQueue;
use super::viewport_frame::ViewportFrame;

impl ViewportRenderer {
    /// Shows the viewport's image in a part of the window.
    pub fn show(&self, ui: &egui::Ui, rect: egui::Rect, frame: ViewportFrame) {
        self.add(ui, rect, Content::Viewport(Box::new(frame)));
    }

    /// Shows a debug view of a shot in a part of the window. All views of one shot are drawn at once.
    pub fn show_debug_view(&self, ui: &egui::Ui, rect: egui::Rect, shot: Shot) {
        self.add(ui, rect, Content::DebugView(Box::new(shot)));
    }

    fn add(&self, ui: &egui::Ui, rect: egui::Rect, content: Content) {
        let callback = Callback { renderer: self.clone(), rect, content };
        ui.painter().add(egui_wgpu::Callback::new_paint_callback(rect, callback));
    }
}

/// Paint callback of one part of the window.
struct Callback {
    renderer: ViewportRenderer,
    rect: egui::Rect,
    content: Content,
}

enum Content {
    Viewport(Box<ViewportFrame>),
    DebugView(Box<Shot>),
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
        if self.renderer.health().is_lost() {
            return Vec::new();
        }
        let viewport = ViewportInPixels::from_points(&self.rect, screen.pixels_per_point, screen.size_in_pixels);
        let mut target = Target { device, queue, encoder, viewport };
        let mut state = self.renderer.lock();
        state.has_unpainted_commands = true;
        match &self.content {
            Content::Viewport(frame) => state.record_viewport(&mut target, frame),
            Content::DebugView(shot) => state.record_debug_view(&mut target, shot),
        }
        // A strip that is hidden takes no stages.
        let is_stage = matches!(self.content, Content::DebugView(_));
        let wants_stage = is_stage && state.stages.as_ref().is_some_and(StageQueue::wants_frame);
        if state.motion.wants_next() || wants_stage {
            self.renderer.egui().request_repaint();
        }
        // Overlays use the texels of the previous image, so another frame must follow if they have changed.
        if let Content::Viewport(frame) = &self.content
            && state.update_target_texels(frame.shot.preset.systems.len())
        {
            self.renderer.egui().request_repaint();
        }
        Vec::new()
    }

    fn paint(&self, info: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let viewport = info.viewport_in_pixels();
        if viewport.width_px <= 0 || viewport.height_px <= 0 {
            return;
        }
        let mut state = self.renderer.lock();
        state.has_unpainted_commands = false;
        let tonemap_bindings = match &self.content {
            Content::Viewport(_) => state.pair.as_ref(),
            Content::DebugView(shot) => state.strip.tonemap_bindings[shot.debug_view as usize].as_ref(),
        };
        if let Some(tonemap_bindings) = tonemap_bindings {
            state.tonemap_pass.record(pass, tonemap_bindings);
        }
    }
}

#[cfg(test)]
mod tests;
