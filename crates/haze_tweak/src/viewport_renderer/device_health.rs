//! State of the window's wgpu device: lost, or with an error. egui handles neither, and without a handler a wgpu error
//! ends the program.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::{egui, wgpu};
use haze_core::error::Error;

/// State of a device. Clones share it.
#[derive(Clone, Default)]
pub struct DeviceHealth(Arc<Shared>);

#[derive(Default)]
struct Shared {
    is_lost: AtomicBool,
    /// First error since the last [`DeviceHealth::take_error`].
    error: Mutex<Option<Error>>,
}

impl DeviceHealth {
    /// Registers callbacks on a device. Each event requests a repaint of the context.
    pub fn watch(device: &wgpu::Device, context: &egui::Context) -> Self {
        let health = Self::default();
        let lost = health.clone();
        let frame = context.clone();
        device.set_device_lost_callback(move |_, _| {
            lost.0.is_lost.store(true, Ordering::SeqCst);
            frame.request_repaint();
        });
        let failed = health.clone();
        let frame = context.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = failed.lock();
            if first.is_none() {
                *first = Some(one_line_error(&error));
            }
            frame.request_repaint();
        }));
        health
    }

    /// Returns true once the device is lost. wgpu and egui panic if they use it after that.
    pub fn is_lost(&self) -> bool {
        self.0.is_lost.load(Ordering::SeqCst)
    }

    /// Returns the first error since the last call.
    pub fn take_error(&self) -> Option<Error> {
        self.lock().take()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<Error>> {
        self.0.error.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Formats an error of wgpu as one line.
fn one_line_error(error: &wgpu::Error) -> Error {
    Error::Device(match error {
        wgpu::Error::OutOfMemory { .. } => "out of memory; a smaller window takes less".into(),
        error => error.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    })
}

/// Destroys the device while this frame is painted, like a driver reset. For tests.
pub fn destroy_device(ui: &egui::Ui) {
    let callback = Callback::new_paint_callback(ui.ctx().content_rect(), DestroyDevice);
    ui.ctx().layer_painter(egui::LayerId::background()).add(callback);
}

struct DestroyDevice;

impl CallbackTrait for DestroyDevice {
    fn prepare(
        &self,
        device: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        device.destroy();
        // `destroy` alone does not report the loss: wgpu calls the handler when the idle device is polled.
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
    fn an_uncaught_error_is_reported_once_on_one_line() {
        let gpu = Headless::new().unwrap();
        let health = DeviceHealth::watch(&gpu.device, &egui::Context::default());
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
    fn a_lost_device_is_reported_and_repaints_the_window() {
        let gpu = Headless::new().unwrap();
        let context = egui::Context::default();
        let health = DeviceHealth::watch(&gpu.device, &context);
        for _ in 0..3 {
            context.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        }
        assert!(!health.is_lost() && !context.has_requested_repaint());
        gpu.device.destroy();
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        assert!(health.is_lost() && context.has_requested_repaint() && health.take_error().is_none());
    }
}
