//! Rendered image of a shot, kept until another shot is requested.

use eframe::egui::epaint::ViewportInPixels;
use eframe::wgpu;
use glam::{UVec2, Vec2};
use haze::Error;
use haze_core::settings::{DebugView, DepthSource};
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{TonemapBindGroup, TonemapUniform};
use haze_preset::Preset;

/// Encoder, device and rectangle that egui gives for drawing.
pub struct Target<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub encoder: &'a mut wgpu::CommandEncoder,
    pub place: ViewportInPixels,
}

impl Target<'_> {
    pub fn shown(&self) -> TonemapUniform {
        TonemapUniform {
            origin: Vec2::new(self.place.left_px as f32, self.place.top_px as f32),
            size: Vec2::new(self.place.width_px as f32, self.place.height_px as f32),
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
}

impl CachedRender {
    pub fn new(context: &OffscreenContext) -> Result<Self, Error> {
        Ok(Self {
            offscreen: OffscreenRenderer::new(context, false)?,
            shot: None,
            error: None,
            tonemap_bindings: Default::default(),
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
        let done = self.offscreen.record(target.encoder, shot, views);
        self.error = done.err().map(|error| error.to_string());
        last.is_none_or(|last| (last.size, last.debug_view) != (shot.size, shot.debug_view))
    }

    /// Call if the commands that were recorded last were never submitted.
    pub fn forget(&mut self) {
        self.shot = None;
        self.offscreen.invalidate_scene();
    }

    pub fn picture(&self, view: DebugView) -> Option<&wgpu::Texture> {
        self.offscreen.picture(view)
    }
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
