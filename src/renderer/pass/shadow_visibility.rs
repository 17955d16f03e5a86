//! shadow_visibility: looks up a host's shadow maps at the cells of the density grid.
//!
//! Reads: shadow maps of the lights.
//! Writes: visibility of the lights, in blocks of the volume.

use haze_core::glam::UVec3;

use crate::renderer::gpu::binding::written_texture;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::gpu::pipeline::ComputePipelineDescription;
use crate::renderer::layouts::{GroupSet, SHADOW_FORMAT, SHADOW_MAP_TYPES};
use crate::renderer::pipeline_variants::PipelineKey;

/// Cells of a workgroup along each axis.
const SIDE: u32 = 2;

/// Key of the only pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ShadowVisibilityKey;

impl PipelineKey for ShadowVisibilityKey {
    const PASS: &'static str = "shadow_visibility";
    const GROUPS: GroupSet = GroupSet::None;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        [SHADOW_MAP_TYPES.as_slice(), &[written_texture(SHADOW_FORMAT, wgpu::TextureViewDimension::D3)]].concat()
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription { entry_point: "look_up_cells", constants: Vec::new() }
    }
}

/// The pass for one frame.
#[derive(Debug)]
pub(crate) struct ShadowVisibility {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 0, by block of lights.
    pub inputs: Vec<wgpu::BindGroup>,
    /// Number of cells along each axis.
    pub size: UVec3,
}

impl ShadowVisibility {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        let pass = encoder.compute("shadow_visibility");
        pass.set_pipeline(&self.pipeline);
        let workgroups = |cells: u32| cells.div_ceil(SIDE);
        for inputs in &self.inputs {
            pass.set_bind_group(0, inputs, &[]);
            pass.dispatch_workgroups(workgroups(self.size.x), workgroups(self.size.y), workgroups(self.size.z));
        }
    }
}
