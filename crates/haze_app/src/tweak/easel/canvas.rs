//! A picture of a shot, kept until it is to show another.

use eframe::egui::epaint::ViewportInPixels;
use eframe::wgpu;
use glam::{UVec2, Vec2};
use haze::Error;
use haze::preset::Preset;
use haze::settings::{DepthSource, ShadeTree};
use haze_demo::develop::{Developing, Shown};
use haze_demo::shot::Shot;
use haze_demo::stage::{Stage, StageContext};

/// Where egui draws, and with what.
pub struct Target<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub encoder: &'a mut wgpu::CommandEncoder,
    pub place: ViewportInPixels,
}

impl Target<'_> {
    pub fn shown(&self) -> Shown {
        Shown {
            origin: Vec2::new(self.place.left_px as f32, self.place.top_px as f32),
            size: Vec2::new(self.place.width_px as f32, self.place.height_px as f32),
            ..Shown::default()
        }
    }
}

/// A stage, and what it shows.
pub struct Canvas {
    pub stage: Stage,
    /// What was drawn last.
    pub shot: Option<Shot>,
    /// Why that could not be: what was drawn before is shown.
    pub error: Option<String>,
    pub developing: [Option<Developing>; ShadeTree::ALL.len()],
}

impl Canvas {
    pub fn new(context: &StageContext) -> Result<Self, Error> {
        Ok(Self { stage: Stage::new(context, false)?, shot: None, error: None, developing: Default::default() })
    }

    /// True if this shot was drawn last.
    pub fn shows(&self, shot: &Shot) -> bool {
        self.shot.as_ref().is_some_and(|drawn| drawn.is_same(shot))
    }

    /// Draws a shot if it is another than the last; tells whether pictures may be others now.
    pub fn record(&mut self, target: &mut Target<'_>, shot: &Shot, stages: &[ShadeTree]) -> bool {
        if self.shows(shot) {
            return false;
        }
        // Once, even if it cannot be drawn.
        let last = self.shot.replace(shot.clone());
        let done = self.stage.record(target.encoder, shot, stages);
        self.error = done.err().map(|error| error.to_string());
        last.is_none_or(|last| (last.size, last.shade_tree) != (shot.size, shot.shade_tree))
    }

    /// What was recorded last was never drawn.
    pub fn forget(&mut self) {
        self.shot = None;
        self.stage.forget();
    }

    pub fn picture(&self, stage: ShadeTree) -> Option<&wgpu::Texture> {
        self.stage.picture(stage)
    }
}

/// The same shot with so many times fewer pixels each way.
pub fn reduced(shot: &Shot, divisor: u32) -> Shot {
    Shot { size: (shot.size / divisor).max(UVec2::ONE), ..shot.clone() }
}

/// Sets the scale of every system that can have another than 1.
pub fn set_scale(preset: &mut Preset, scale: u32) {
    for system in &mut preset.systems {
        if system.settings.accumulate.depth_source != DepthSource::Host {
            system.settings.accumulate.scale = scale;
        }
    }
}
