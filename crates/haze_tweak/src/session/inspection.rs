//! Values of a pixel, and ramp coordinates of the whole image, computed from texels read back from the GPU.

use std::sync::Arc;

use eframe::egui::{Response, Vec2};
use glam::{UVec2, Vec3};
use haze_core::formula::tonemap::DisplayTransform;
use haze_reference::Probe;

use super::ramp_survey::{RampPosition, RampSurvey};
use crate::viewport_renderer::compared_side::ComparedSide;

/// State of the inspector.
#[derive(Default)]
pub struct Inspection {
    /// The values of the pixel under the pointer are shown.
    pub is_on: bool,
    /// True if the values are beside the image, not over it.
    pub is_docked: bool,
    /// A drag paints on the smoke, and the values would hide it.
    pub is_painting: bool,
    /// Pointer position over the image, in fractions of its sides.
    pub pointer: Option<Vec2>,
    /// Pinned position.
    pub pinned: Option<Vec2>,
    /// Values of the pixel.
    pub pixel_values: Option<PixelValues>,
    /// Ramp coordinates of the whole image.
    pub survey: Option<Arc<RampSurvey>>,
    /// Place on a ramp. Smoke that samples it is highlighted in the image.
    pub ramp_position: Option<RampPosition>,
}

/// Values of a pixel.
pub struct PixelValues {
    pub pixel: UVec2,
    /// Image that the pixel belongs to, and the names of its systems.
    pub side: ComparedSide,
    pub names: Vec<String>,
    pub probe: Probe,
    /// Fraction of the pixel that an object in front covers at its outline, 0 to 1. The probe is of the rest.
    pub front_fraction: f32,
    /// From its light to the color on the screen.
    pub transform: DisplayTransform,
}

impl Inspection {
    /// Follows the pointer over the viewport. A click pins the position, or releases it.
    pub fn point(&mut self, viewport: &Response) {
        self.pointer = viewport.hover_pos().map(|at| (at - viewport.rect.min) / viewport.rect.size());
        if self.is_on && viewport.clicked() {
            self.pinned = if self.pinned.is_some() { None } else { self.pointer };
        }
    }

    /// Returns the position to inspect.
    pub fn position(&self) -> Option<Vec2> {
        self.pinned.filter(|_| self.is_on).or(self.pointer)
    }

    pub fn toggle(&mut self) {
        self.is_on = !self.is_on;
        self.pinned = None;
    }
}

/// Returns tonemapped light as an sRGB code.
pub fn srgb_code(light: Vec3, transform: DisplayTransform) -> [u8; 3] {
    transform.code(light).to_array().map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8)
}
