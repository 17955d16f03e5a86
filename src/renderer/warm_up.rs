//! Description of future frames, for compiling their pipelines in advance.

use haze_core::frame::View;
use haze_core::settings::{DebugView, Settings};

use super::plan::SceneDepthKind;

/// Properties of future frames that select pipelines. See [`Renderer::warm_up`](crate::Renderer::warm_up).
#[derive(Clone, Copy, Debug)]
pub struct WarmUp<'a> {
    /// A camera like those of the future frames. Its handedness and depth convention matter, and its size if `max_side`
    /// determines the scale; its position does not.
    pub view: View,
    /// Kind of scene depth.
    pub scene_depth: SceneDepthKind,
    /// Settings of the future systems.
    pub settings: &'a [Settings],
    /// Stages that will be shown.
    pub debug_views: &'a [DebugView],
}
