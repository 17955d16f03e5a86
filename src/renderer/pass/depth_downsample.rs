//! depth_downsample: reduces the scene depth to the resolution of the accumulation target. `TexelPass` records it.
//!
//! Reads: scene depth.
//! Writes: reduced depth, Depth32Float, linear view depth divided by `depth_limit`. If the backend cannot test what it
//! samples, also a coarse copy, never nearer than the original. On the path `tiled`, R32Float.
//! Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use crate::renderer::gpu::pipeline::{
    ComputePipelineDescription, Constant, RenderPipelineDescription, bool_constant, enum_constant, read_only_depth,
};
use crate::renderer::targets::{DEPTH_COPY_FORMAT, REDUCED_DEPTH_FORMAT};
use crate::settings::DepthDownsample;

/// Key of a downsampling pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthDownsampleKey {
    pub mode: DepthDownsample,
    /// True for the coarse copy.
    pub copy: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: DepthDownsampleKey) -> RenderPipelineDescription {
    let format = if key.copy { DEPTH_COPY_FORMAT } else { REDUCED_DEPTH_FORMAT };
    RenderPipelineDescription {
        buffers: &[],
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            depth_write_enabled: Some(true),
            ..read_only_depth(format, wgpu::CompareFunction::Always)
        }),
        sample_count: 1,
        targets: Vec::new(),
        constants: constants(key),
    }
}

/// Returns the parts of the compute pipeline for a key.
pub(crate) fn describe_compute(key: DepthDownsampleKey) -> ComputePipelineDescription {
    ComputePipelineDescription { entry_point: "texels", constants: constants(key) }
}

fn constants(key: DepthDownsampleKey) -> Vec<Constant> {
    vec![enum_constant!("DEPTH_DOWNSAMPLE", key.mode), bool_constant("COARSE_COPY", key.copy)]
}
