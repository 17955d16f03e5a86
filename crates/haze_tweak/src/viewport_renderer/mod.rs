//! Renderer of the window's images, with their measurements. Draws inside egui's paint callbacks.

pub mod adaptive_resolution;
pub mod cached_render;
pub mod compared_side;
pub mod comparison_image;
pub mod cpu_render_job;
pub mod device_health;
pub mod frame_timings;
pub mod motion;
pub mod paint_callback;
pub mod psnr_job;
pub mod smoke_times;
pub mod stage_queue;
pub mod viewport_frame;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::{egui, wgpu};
use haze_core::error::Error;
use haze_demo::capture::Capture;
use haze_demo::image_metrics::Comparison;
use haze_demo::offscreen_renderer::OffscreenContext;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::TonemapPass;

use crate::platform::IS_PAGE;
use cached_render::submit_and_wait;
use compared_side::ComparedSide;
use device_health::DeviceHealth;
use smoke_times::TimeSource;
use stage_queue::StageQueue;
use viewport_frame::RendererState;
pub use viewport_frame::{RenderStats, TargetTexels, ViewportFrame};

/// Draws the images of one window. Clones share the state.
#[derive(Clone)]
pub struct ViewportRenderer {
    state: Arc<Mutex<RendererState>>,
    adapter: Arc<wgpu::AdapterInfo>,
    health: DeviceHealth,
    egui: egui::Context,
    time_source: TimeSource,
}

fn render_state<'a>(window: &'a eframe::CreationContext<'_>) -> Result<&'a eframe::egui_wgpu::RenderState, Error> {
    let none = || Error::NoDevice("the window has no graphics device".into());
    window.wgpu_render_state.as_ref().ok_or_else(none)
}

impl ViewportRenderer {
    /// # Errors
    /// If there is no device, or it lacks what the demo renderer needs.
    pub fn new(window: &eframe::CreationContext<'_>) -> Result<Self, Error> {
        let render = render_state(window)?;
        let renderer =
            Self::with_context(window, OffscreenContext::new(&render.adapter, &render.device, &render.queue))?;
        if renderer.is_software() {
            renderer.draw_stages_one_by_one();
        }
        Ok(renderer)
    }

    /// Draws one stage of the strip in a frame, and none while the user holds something.
    pub fn draw_stages_one_by_one(&self) {
        self.lock().stages = Some(StageQueue::default());
    }

    /// Draws all stages of the strip in one frame.
    pub fn draw_stages_at_once(&self) {
        self.lock().stages = None;
    }

    /// Like [`new`](Self::new), with pipelines that other renderers of the window's device share.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_context(window: &eframe::CreationContext<'_>, context: OffscreenContext) -> Result<Self, Error> {
        let render = render_state(window)?;
        let health = DeviceHealth::watch(&render.device, &window.egui_ctx);
        if !IS_PAGE && render.adapter.get_info().device_type != wgpu::DeviceType::Cpu {
            // Takes about 0.2 s on a GPU. A CPU adapter takes longer, and its paths cost about the same.
            context.measure_paths(|encoder| submit_and_wait(&render.device, &render.queue, encoder))?;
        }
        let tonemap_pass = TonemapPass::new(&render.device, render.target_format);
        let state = Arc::new(Mutex::new(RendererState::new(context, tonemap_pass)?));
        let adapter = Arc::new(render.adapter.get_info());
        let egui = window.egui_ctx.clone();
        let time_source = TimeSource::of(&adapter, render.device.features());
        Ok(Self { state, adapter, health, egui, time_source })
    }

    /// Returns a function that requests a repaint from any thread.
    pub fn wake(&self) -> impl Fn() + Send + Sync + 'static {
        let egui = self.egui.clone();
        move || egui.request_repaint()
    }

    /// Returns the egui context of the window.
    pub fn egui(&self) -> &egui::Context {
        &self.egui
    }

    /// Returns the name of the adapter as one line.
    pub fn adapter(&self) -> String {
        let software = if self.is_software() { ", software" } else { "" };
        format!("{} ({}{software})", self.adapter.name, self.adapter.backend)
    }

    /// Returns true if the adapter is the CPU.
    pub fn is_software(&self) -> bool {
        self.adapter.device_type == wgpu::DeviceType::Cpu
    }

    pub fn health(&self) -> &DeviceHealth {
        &self.health
    }

    /// Call at the beginning of a frame. `is_touched`: the user holds something; `is_animated`: time passes. While one is so,
    /// the image is drawn at an adaptive resolution.
    pub fn begin_frame(&self, is_touched: bool, is_animated: bool) {
        let mut state = self.lock();
        // egui drops recorded commands if there is no surface to draw to.
        if std::mem::take(&mut state.has_unpainted_commands) {
            state.forget();
        }
        state.motion.begin_frame(is_touched || is_animated);
        if let Some(stages) = &mut state.stages {
            stages.begin_frame(is_touched);
        }
    }

    /// Simulates a long frame.
    #[cfg(test)]
    pub fn simulate_slow_frame(&self) {
        self.lock().motion.resolution.update(1.0);
    }

    /// Returns the number of window pixels per image pixel, in each direction.
    pub fn divisor(&self) -> u32 {
        self.lock().motion.resolution.divisor()
    }

    /// Returns the shared GPU context, for checking other shaders.
    pub fn context(&self) -> OffscreenContext {
        self.lock().context.clone()
    }

    /// Draws everything with another context of the same device from now on.
    ///
    /// # Errors
    /// As [`ViewportRenderer::new`]. On an error, nothing changes.
    pub fn replace_context(&self, context: OffscreenContext) -> Result<(), Error> {
        self.lock().replace_context(context)
    }

    /// Returns the error of the image that should be shown.
    pub fn error(&self) -> Option<String> {
        self.lock().error()
    }

    /// Turns the measurement of the smoke's time on or off.
    pub fn measure(&self, is_on: bool) {
        self.lock().measure(is_on.then_some(self.time_source));
    }

    /// Measures by timestamps, as on a GPU.
    #[cfg(test)]
    pub fn use_timestamps(&mut self) {
        self.time_source = TimeSource::Timestamps;
    }

    /// Draws the image again although its shot is the same.
    pub fn draw_again(&self) {
        self.lock().main.shot = None;
    }

    /// Overrides the accumulation scale; `None` uses that of the preset.
    pub fn show_scale(&self, scale: Option<u32>) {
        self.lock().scale = scale;
    }

    /// Returns the cost of drawing the image.
    pub fn render_stats(&self) -> RenderStats {
        self.lock().render_stats(self.time_source)
    }

    /// Returns the texels of each system in the last image; `None` if it was out of view or drawn forward.
    pub fn texels(&self) -> Vec<Option<TargetTexels>> {
        self.lock().texels.clone()
    }

    /// Returns true if the backend can read texels back.
    pub fn can_capture(&self) -> bool {
        self.lock().context.can_capture()
    }

    /// Requests the texels of one of the images whenever it has changed.
    pub fn want_capture(&self, wants: Option<ComparedSide>) {
        self.lock().wants_capture = wants;
    }

    /// Returns texels that have arrived.
    pub fn take_capture(&self) -> Option<(ComparedSide, Shot, Capture)> {
        self.lock().capture.take_if(|(.., capture)| capture.is_finished())
    }

    /// Returns true while texels are being read back.
    pub fn is_capturing(&self) -> bool {
        self.lock().capture.is_some()
    }

    /// Forces the next copy, even of an image that was already copied.
    pub fn forget_capture(&self) {
        self.lock().captured = None;
    }

    /// Requests a readback of the two images whenever they stand still.
    pub fn want_comparison(&self, wants: bool) {
        self.lock().want_comparison(wants);
    }

    /// Returns two images that have arrived.
    pub fn take_comparison(&self) -> Option<Comparison> {
        self.lock().comparison.take_if(|comparison| comparison.is_finished())
    }

    /// Returns true while two images are being read back, or will be.
    pub fn is_comparing(&self) -> bool {
        self.lock().is_comparing()
    }

    /// Locks the state.
    pub(super) fn lock(&self) -> MutexGuard<'_, RendererState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
