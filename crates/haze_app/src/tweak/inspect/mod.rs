//! What became of a pixel, and what the whole picture looks up: told from texels that came back from the GPU.

pub mod lens;
pub mod lit;
pub mod panel;
pub mod survey;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use eframe::egui::{Response, Vec2};
use glam::{UVec2, Vec3};
use haze::formula::tonemap::developed;
use haze_reference::Probe;

use super::compare::Side;
use survey::{Spot, Survey};

/// What is asked, and what is known.
#[derive(Default)]
pub struct Inspect {
    /// Numbers are shown of the pixel under the pointer.
    pub is_on: bool,
    /// The pointer over the picture, in shares of its sides.
    pub pointer: Option<Vec2>,
    /// A place that is kept.
    pub pinned: Option<Vec2>,
    /// What is told.
    pub told: Option<Told>,
    /// What the whole picture looks up.
    pub survey: Option<Arc<Survey>>,
    /// A place on a ramp: what looks it up is lit in the picture.
    pub spot: Option<Spot>,
}

/// What became of a pixel.
pub struct Told {
    pub pixel: UVec2,
    /// The picture that it is of, and the names of the systems there.
    pub side: Side,
    pub names: Vec<String>,
    pub probe: Probe,
    /// Multiplies the light before it is shown.
    pub exposure: f32,
}

impl Inspect {
    /// Follows the pointer over the viewport; a click keeps a place, or lets it go.
    pub fn point(&mut self, viewport: &Response) {
        self.pointer = viewport.hover_pos().map(|at| (at - viewport.rect.min) / viewport.rect.size());
        if self.is_on && viewport.clicked() {
            self.pinned = if self.pinned.is_some() { None } else { self.pointer };
        }
    }

    /// The place that is asked about.
    pub fn place(&self) -> Option<Vec2> {
        self.pinned.filter(|_| self.is_on).or(self.pointer)
    }

    pub fn toggle(&mut self) {
        self.is_on = !self.is_on;
        self.pinned = None;
    }
}

/// Light as it is shown, sRGB code.
fn code(light: Vec3, exposure: f32) -> [u8; 3] {
    developed(light, exposure).to_array().map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8)
}
