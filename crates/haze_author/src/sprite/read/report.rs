//! Answers to all questions, and their lines of a report.

use std::path::PathBuf;

use glam::UVec2;

use super::answer::{Answer, Observation};
use super::color::ColorCode;
use super::depth::DepthWhite;
use super::frame_grid::FrameOrder;
use super::motion::MotionAxes;
use super::options::SecondAlpha;
use super::playback::Playback;
use super::role::Role;
use super::six_way::SideOrder;

/// Answers to all questions about a set of sheets. Questions that do not arise have none.
#[derive(Clone, Debug)]
pub struct SheetAnswers {
    /// Files with their contents.
    pub roles: Vec<(PathBuf, Answer<Role>)>,
    /// Columns and rows.
    pub cells: Answer<UVec2>,
    /// Order of frames.
    pub order: Answer<FrameOrder>,
    /// Number of frames.
    pub frames: Answer<u32>,
    /// Codes of the light maps.
    pub light: Option<ColorCode>,
    /// Sides of the channels of the light maps.
    pub sides: Option<Answer<SideOrder>>,
    /// Contents of alpha of the second light map, if it is not the same everywhere.
    pub second_alpha: Option<Answer<SecondAlpha>>,
    /// Codes of the normals.
    pub normals: Option<ColorCode>,
    /// True if green of the normals points down.
    pub y_down: Option<Answer<bool>>,
    /// Directions of full red and green of motion vectors.
    pub motion: Option<Answer<MotionAxes>>,
    /// Way of full red or green of motion vectors, as a fraction of a frame.
    pub motion_scale: Option<Answer<f32>>,
    /// Meaning of white of depth.
    pub depth_white: Option<Answer<DepthWhite>>,
    /// Loop or once.
    pub playback: Answer<Playback>,
}

impl SheetAnswers {
    /// Returns a line for each answer.
    pub fn observations(&self) -> Vec<Observation> {
        let mut lines = Vec::new();
        for (path, role) in &self.roles {
            lines.push(Observation::new(format!("{}: {}", path.display(), role.value.name()), role, "--role"));
        }
        let UVec2 { x, y } = self.cells.value;
        lines.push(Observation::new(format!("grid: {x}x{y}"), &self.cells, "--grid"));
        lines.push(Observation::new(format!("order: {}", self.order.value.name()), &self.order, "--order"));
        lines.push(Observation::new(format!("frames: {}", self.frames.value), &self.frames, "--frames"));
        for (what, code) in [("light", &self.light), ("normals", &self.normals)] {
            if let Some(ColorCode { alpha, space }) = code {
                lines.push(Observation::new(format!("{what}: {}", alpha.value.name()), alpha, "--alpha"));
                lines.push(Observation::new(format!("{what}: {}", space.value.name()), space, "--codes"));
            }
        }
        if let Some(is_down) = &self.y_down {
            let direction = if is_down.value { "down" } else { "up" };
            lines.push(Observation::new(format!("green of normals: {direction}"), is_down, "--y-down"));
        }
        if let Some(sides) = &self.sides {
            lines.push(Observation::new(format!("sides: {}", sides.value.name()), sides, "--sides"));
        }
        if let Some(alpha) = &self.second_alpha {
            let name = alpha.value.name();
            lines.push(Observation::new(format!("alpha of the second light map: {name}"), alpha, "--second-alpha"));
        }
        if let Some(motion) = &self.motion {
            let name = motion.value.name();
            lines.push(Observation::new(format!("motion, full red and green: {name}"), motion, "--motion"));
        }
        if let Some(scale) = &self.motion_scale {
            let text = format!("motion, way of full red or green: {:.4} of a frame", scale.value);
            lines.push(Observation::new(text, scale, "--motion-scale"));
        }
        if let Some(white) = &self.depth_white {
            lines.push(Observation::new(format!("white of depth: {}", white.value.name()), white, "--depth-white"));
        }
        lines.push(Observation::new(format!("playback: {}", self.playback.value.name()), &self.playback, "--playback"));
        lines
    }
}
