//! Numbers that programs need to show a flipbook.

use super::Emission;
use crate::image_format::Alpha;

/// Numbers of a flipbook, for programs: `flipbook.json`.
#[derive(serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub struct FlipbookNumbers {
    pub columns: u32,
    pub rows: u32,
    pub frames: u32,
    /// Frames per second.
    pub rate: f32,
    /// Color of `color.png`.
    pub alpha: Alpha,
    /// Light of fire in `color.png`; absent without `emission.png`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<Emission>,
    /// Way that full red or green stands for, as a share of a frame's width or height.
    pub motion_scale: f32,
    /// Intensity of a light under which the six-way maps have the brightness of the preset's smoke; absent without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub six_way_intensity: Option<f32>,
    /// Luminance of fire that full alpha of `six_way_2.png` stands for, in the unit of `six_way_intensity`; absent without fire, and
    /// where that alpha is opacity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub six_way_emission: Option<f32>,
}
