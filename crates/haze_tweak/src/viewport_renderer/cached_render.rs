//! Rendered image of a shot, kept until another shot is requested.

use std::time::Duration;

use eframe::egui::epaint::ViewportInPixels;
use eframe::wgpu;
use glam::{UVec2, Vec2};
use haze_core::error::Error;
use haze_core::settings::{DebugView, DepthSource};
use haze_demo::headless::WAIT_LIMIT;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{TonemapBindGroup, TonemapUniform};
use haze_preset::Preset;

/// Encoder, device and rectangle that egui gives for drawing.
pub struct Target<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub encoder: &'a mut wgpu::CommandEncoder,
    pub viewport: ViewportInPixels,
}

impl Target<'_> {
    pub fn shown(&self) -> TonemapUniform {
        TonemapUniform {
            origin: Vec2::new(self.viewport.left_px as f32, self.viewport.top_px as f32),
            size: Vec2::new(self.viewport.width_px as f32, self.viewport.height_px as f32),
            ..TonemapUniform::default()
        }
    }
}

/// Off-screen renderer with the last shot that it drew.
pub struct CachedRender {
    pub offscreen: OffscreenRenderer,
    /// Shot that was drawn last.
    pub shot: Option<Shot>,
    /// Error of the last attempt to draw; the image before is then shown.
    pub error: Option<String>,
    pub tonemap_bindings: [Option<TonemapBindGroup>; DebugView::ALL.len()],
    /// The device is waited for, to measure the wall time of the smoke.
    pub is_wall_timed: bool,
    /// Wall time of the smoke of the last shot, if it was measured.
    pub smoke_time: Option<Duration>,
}

impl CachedRender {
    pub fn new(context: &OffscreenContext) -> Result<Self, Error> {
        Ok(Self {
            offscreen: OffscreenRenderer::new(context, false)?.with_kept_paths(),
            shot: None,
            error: None,
            tonemap_bindings: Default::default(),
            is_wall_timed: false,
            smoke_time: None,
        })
    }

    /// Returns true if this shot was drawn last.
    pub fn shows(&self, shot: &Shot) -> bool {
        self.shot.as_ref().is_some_and(|drawn| drawn.has_same_image(shot))
    }

    /// Draws a shot unless it was drawn last. Returns true if the textures may have been replaced.
    pub fn record(&mut self, target: &mut Target<'_>, shot: &Shot, views: &[DebugView]) -> bool {
        if self.shows(shot) {
            return false;
        }
        // A shot that fails is tried only once.
        let last = self.shot.replace(shot.clone());
        let done = if self.is_wall_timed {
            let submit = |encoder| submit_and_wait(target.device, target.queue, encoder);
            self.offscreen.smoke_time(shot, views, submit).map(|time| self.smoke_time = Some(time))
        } else {
            self.smoke_time = None;
            self.offscreen.record(target.encoder, shot, views)
        };
        self.error = done.err().map(|error| error.to_string());
        last.is_none_or(|last| (last.size, last.debug_view) != (shot.size, shot.debug_view))
    }

    /// Draws one view of a shot, also if others of it were drawn before. Returns true if the textures were replaced.
    pub fn record_view(&mut self, target: &mut Target<'_>, shot: &Shot, view: DebugView) -> bool {
        let last = self.shot.replace(shot.clone());
        let done = self.offscreen.record(target.encoder, shot, &[view]);
        self.error = done.err().map(|error| error.to_string());
        last.is_none_or(|last| last.size != shot.size)
    }

    /// Call if the commands that were recorded last were never submitted.
    pub fn forget(&mut self) {
        self.shot = None;
        self.offscreen.invalidate_scene();
    }

    pub fn image(&self, view: DebugView) -> Option<&wgpu::Texture> {
        self.offscreen.image(view)
    }
}

/// Submits commands and waits until the device is done.
pub fn submit_and_wait(device: &wgpu::Device, queue: &wgpu::Queue, encoder: wgpu::CommandEncoder) -> Result<(), Error> {
    queue.submit([encoder.finish()]);
    let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(WAIT_LIMIT) };
    device.poll(wait).map(|_| ()).map_err(|error| Error::Device(error.to_string()))
}

/// Returns the shot with its size divided in each direction.
pub fn reduced(shot: &Shot, divisor: u32) -> Shot {
    Shot { size: (shot.size / divisor).max(UVec2::ONE), ..shot.clone() }
}

/// Sets the scale of every system that may have one other than 1.
pub fn set_scale(preset: &mut Preset, scale: u32) {
    for system in &mut preset.systems {
        if system.settings.accumulate.depth_source != DepthSource::Host {
            system.settings.accumulate.fix_scale(scale);
        }
    }
}
