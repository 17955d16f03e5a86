//! What draws the pictures of the window.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::{egui, wgpu};
use haze::Error;
use haze_demo::apart::Comparison;
use haze_demo::capture::Capture;
use haze_demo::develop::Developer;
use haze_demo::shot::Shot;
use haze_demo::stage::StageContext;

use super::drawing::{Drawing, Figures, Texels};
use crate::tweak::compare::Side;
use crate::tweak::health::Health;

/// Draws for one window. A clone is the same.
#[derive(Clone)]
pub struct Easel {
    drawing: Arc<Mutex<Drawing>>,
    adapter: Arc<wgpu::AdapterInfo>,
    health: Health,
    egui: egui::Context,
    /// GPU time can be known.
    is_timed: bool,
}

impl Easel {
    /// # Errors
    /// Where there is no device, or it cannot draw what the demo draws.
    pub fn new(window: &eframe::CreationContext<'_>) -> Result<Self, Error> {
        let none = || Error::NoDevice("the window has no graphics device".into());
        let render = window.wgpu_render_state.as_ref().ok_or_else(none)?;
        let health = Health::watch(&render.device, &window.egui_ctx);
        let context = StageContext::new(&render.adapter, &render.device, &render.queue);
        if render.adapter.get_info().device_type != wgpu::DeviceType::Cpu {
            // A fifth of a second; where a CPU draws it is longer, and what those take is much alike.
            context.measure_paths(|encoder| {
                render.queue.submit([encoder.finish()]);
                let waited = render.device.poll(wgpu::PollType::wait_indefinitely());
                waited.map(|_| ()).map_err(|error| Error::Device(error.to_string()))
            })?;
        }
        let developer = Developer::new(&render.device, render.target_format);
        let drawing = Arc::new(Mutex::new(Drawing::new(context, developer)?));
        let (adapter, egui) = (Arc::new(render.adapter.get_info()), window.egui_ctx.clone());
        let is_timed = render.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        Ok(Self { drawing, adapter, health, egui, is_timed })
    }

    /// Makes the window draw itself again, from any thread.
    pub fn wake(&self) -> impl Fn() + Send + Sync + 'static {
        let egui = self.egui.clone();
        move || egui.request_repaint()
    }

    /// What the window is drawn with.
    pub fn egui(&self) -> &egui::Context {
        &self.egui
    }

    /// What draws, on one line.
    pub fn adapter(&self) -> String {
        let software = if self.is_software() { ", software" } else { "" };
        format!("{} ({}{software})", self.adapter.name, self.adapter.backend)
    }

    /// True if the CPU draws.
    pub fn is_software(&self) -> bool {
        self.adapter.device_type == wgpu::DeviceType::Cpu
    }

    pub fn health(&self) -> &Health {
        &self.health
    }

    /// To be called at the beginning of a frame. While something moves the picture is drawn as coarsely as it takes to be quick.
    pub fn begin_frame(&self, is_moving: bool) {
        let mut drawing = self.lock();
        // egui drops what was recorded where there is nothing to draw into.
        if std::mem::take(&mut drawing.is_unpainted) {
            drawing.forget();
        }
        drawing.motion.begin_frame(is_moving);
    }

    /// As if a frame had taken long.
    #[cfg(test)]
    pub fn be_slow(&self) {
        self.lock().motion.pace.update(1.0);
    }

    /// Pixels of the window that one of the picture stands for, each way.
    pub fn divisor(&self) -> u32 {
        self.lock().motion.pace.divisor()
    }

    /// What stages are made of: for other shaders to be checked with.
    pub fn context(&self) -> StageContext {
        self.lock().context.clone()
    }

    /// Draws everything with another context of the same device from now on.
    ///
    /// # Errors
    /// As [`Easel::new`]; all is as it was then.
    pub fn set_context(&self, context: StageContext) -> Result<(), Error> {
        self.lock().set_context(context)
    }

    /// What is wrong with what is to be seen.
    pub fn error(&self) -> Option<String> {
        self.lock().error()
    }

    /// Measures the picture from now on, or not any more.
    pub fn measure(&self, is_on: bool) {
        if self.is_timed {
            self.lock().measure(is_on);
        }
    }

    /// Draws the picture again, though it is the same.
    pub fn draw_again(&self) {
        self.lock().main.shot = None;
    }

    /// Shows the smoke through targets of this scale, or of the preset's.
    pub fn show_scale(&self, scale: Option<u32>) {
        self.lock().scale = scale;
    }

    /// What drawing the picture took.
    pub fn figures(&self) -> Figures {
        self.lock().figures(self.is_timed)
    }

    /// Of every system, how it was in the last picture; `None` where it was out of sight or drawn forward.
    pub fn texels(&self) -> Vec<Option<Texels>> {
        self.lock().texels.clone()
    }

    /// Whether texels can be brought back at all.
    pub fn can_capture(&self) -> bool {
        self.lock().context.can_capture()
    }

    /// Of which picture texels are to be brought back when it is another.
    pub fn want_capture(&self, wants: Option<Side>) {
        self.lock().wants_capture = wants;
    }

    /// Texels of a picture that have arrived.
    pub fn take_capture(&self) -> Option<(Side, Shot, Capture)> {
        self.lock().capture.take_if(|(.., capture)| capture.has_arrived())
    }

    /// Texels are under way.
    pub fn is_capturing(&self) -> bool {
        self.lock().capture.is_some()
    }

    /// The next copy is taken, even of a picture that was copied.
    pub fn forget_capture(&self) {
        self.lock().captured = None;
    }

    /// Whether the two pictures are to be brought back when they stand still.
    pub fn want_comparison(&self, wants: bool) {
        self.lock().want_comparison(wants);
    }

    /// Two pictures that have arrived.
    pub fn take_comparison(&self) -> Option<Comparison> {
        self.lock().comparison.take_if(|comparison| comparison.has_arrived())
    }

    /// Two pictures are under way, or will be.
    pub fn is_comparing(&self) -> bool {
        self.lock().is_comparing()
    }

    /// The drawing itself, for as long as it is held.
    pub(super) fn lock(&self) -> MutexGuard<'_, Drawing> {
        self.drawing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
