//! Resources of a frame that all its systems share.

use haze_core::glam::UVec2;
use haze_core::view_setup::ViewGeometry;

use super::context::Shared;
use super::frame_bindings::FrameBindings;
use super::gpu::Gpu;
use super::plan::PipelineInputs;
use super::tiled::FrameShadow;
use crate::frame::FrameInput;

/// A frame, with the resources that every system needs.
pub(crate) struct FrameContext<'a> {
    pub gpu: Gpu<'a>,
    pub shared: &'a Shared,
    pub frame: &'a FrameInput<'a>,
    pub view: &'a ViewGeometry,
    /// Size of the host's targets, pixels.
    pub host_size: UVec2,
    pub inputs: &'a PipelineInputs<'a>,
    pub bindings: &'a FrameBindings,
    /// Density grid, if any system receives shadow.
    pub shadow: Option<FrameShadow<'a>>,
}
