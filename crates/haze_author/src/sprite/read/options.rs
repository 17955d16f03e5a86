//! Answers that the caller gives.

use glam::UVec2;
use haze_core::settings::choice;

use super::color::{AlphaMode, CodeSpace};
use super::depth::DepthWhite;
use super::frame_grid::FrameOrder;
use super::motion::MotionAxes;
use super::playback::Playback;
use super::role::Role;
use super::six_way::SideOrder;

choice! {
    /// Contents of alpha of the second light map.
    SecondAlpha {
        /// The amount, or nothing.
        #[default]
        Amount = "amount",
        /// Emission: the light of fire, as in Unity.
        Emission = "emission",
    }
}

/// Answers that replace those that would be found.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// Contents of each file, in the order of the files; missing ones are found.
    pub roles: Vec<Option<Role>>,
    /// Columns and rows.
    pub cells: Option<UVec2>,
    /// Number of frames.
    pub frames: Option<u32>,
    /// Order of frames.
    pub order: Option<FrameOrder>,
    /// Relation of color to the amount.
    pub alpha: Option<AlphaMode>,
    /// Meaning of the codes of light maps or normals.
    pub space: Option<CodeSpace>,
    /// True if green of normals points down.
    pub y_down: Option<bool>,
    /// Sides of the channels of light maps.
    pub sides: Option<SideOrder>,
    /// Contents of alpha of the second light map.
    pub second_alpha: Option<SecondAlpha>,
    /// Directions of full red and green of motion vectors.
    pub motion: Option<MotionAxes>,
    /// Way of full red or green of motion vectors, as a fraction of a frame.
    pub motion_scale: Option<f32>,
    /// Meaning of white of depth.
    pub depth_white: Option<DepthWhite>,
    /// Loop or once.
    pub playback: Option<Playback>,
    /// Relief of normals that are made from alpha or light maps: 1 is that of a hemisphere.
    pub strength: f32,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            roles: Vec::new(),
            cells: None,
            frames: None,
            order: None,
            alpha: None,
            space: None,
            y_down: None,
            sides: None,
            second_alpha: None,
            motion: None,
            motion_scale: None,
            depth_white: None,
            playback: None,
            strength: 1.0,
        }
    }
}
