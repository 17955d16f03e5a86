//! What is known of frames before they come.

use super::plan::SceneDepthKind;
use crate::frame::View;
use crate::settings::{Settings, ShadeTree};

/// What frames will look like, so far as it decides pipelines. See [`Renderer::warm_up`](crate::Renderer::warm_up).
#[derive(Clone, Copy, Debug)]
pub struct WarmUp<'a> {
    /// A camera like those to come: its hand and its depth convention count, and the size of the picture where `max_side` sets
    /// the scale, not where it stands.
    pub view: View,
    /// The kind of scene depth.
    pub scene_depth: SceneDepthKind,
    /// Settings of the systems to come.
    pub settings: &'a [Settings],
    /// The stages that will be shown.
    pub stages: &'a [ShadeTree],
}
