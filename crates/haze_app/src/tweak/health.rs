//! Whether the window's device still works. egui looks after neither: without a handler an error of wgpu's ends the program.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::{egui, wgpu};
use haze::Error;

/// What is known of a device. A clone is the same.
#[derive(Clone, Default)]
pub struct Health(Arc<Shared>);

#[derive(Default)]
struct Shared {
    is_lost: AtomicBool,
    /// The first since it was last asked for.
    error: Mutex<Option<Error>>,
}

impl Health {
    /// Watches a device; what happens to it is seen in the next frame of the context.
    pub fn watch(device: &wgpu::Device, context: &egui::Context) -> Self {
        let health = Self::default();
        let (lost, frame) = (health.clone(), context.clone());
        device.set_device_lost_callback(move |_, _| {
            lost.0.is_lost.store(true, Ordering::SeqCst);
            frame.request_repaint();
        });
        let (failed, frame) = (health.clone(), context.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            failed.lock().get_or_insert(described(&error));
            frame.request_repaint();
        }));
        health
    }

    /// True once nothing may be asked of the device any more: wgpu and egui panic.
    pub fn is_lost(&self) -> bool {
        self.0.is_lost.load(Ordering::SeqCst)
    }

    /// What went wrong since this was asked the last time.
    pub fn take_error(&self) -> Option<Error> {
        self.lock().take()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<Error>> {
        self.0.error.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// An error of wgpu's, on one line.
fn described(error: &wgpu::Error) -> Error {
    Error::Device(match error {
        wgpu::Error::OutOfMemory { .. } => "out of memory; a smaller window takes less".into(),
        error => error.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    })
}

/// Loses the device while this frame is painted, as a driver would. For tests.
pub fn lose_device(ui: &egui::Ui) {
    let callback = Callback::new_paint_callback(ui.ctx().content_rect(), Lose);
    ui.ctx().layer_painter(egui::LayerId::background()).add(callback);
}

struct Lose;

impl CallbackTrait for Lose {
    fn prepare(
        &self,
        device: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        device.destroy();
        // Destroyed, but not lost before it is idle and this has been told.
        let _ = device.poll(wgpu::PollType::wait_indefinitely());
        Vec::new()
    }

    fn paint(&self, _: egui::PaintCallbackInfo, _: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_demo::headless::Headless;

    #[test]
    fn an_error_that_nobody_caught_is_told_once_and_on_one_line() {
        let gpu = Headless::new().unwrap();
        let health = Health::watch(&gpu.device, &egui::Context::default());
        for _ in 0..3 {
            let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: 16,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::VERTEX,
                mapped_at_creation: false,
            });
        }
        let text = health.take_error().unwrap().to_string();
        assert!(text.starts_with("the graphics device failed: Validation Error") && !text.contains('\n'), "{text}");
        assert!(health.take_error().is_none() && !health.is_lost());
    }

    #[test]
    fn a_lost_device_is_known_and_wakes_the_window() {
        let gpu = Headless::new().unwrap();
        let context = egui::Context::default();
        let health = Health::watch(&gpu.device, &context);
        for _ in 0..3 {
            context.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        }
        assert!(!health.is_lost() && !context.has_requested_repaint());
        gpu.device.destroy();
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        assert!(health.is_lost() && context.has_requested_repaint() && health.take_error().is_none());
    }
}
