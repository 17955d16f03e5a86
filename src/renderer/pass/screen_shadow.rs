//! screen_shadow: darkens the host's lit image by the shadow of the smoke.
//!
//! Reads: scene depth, lights, shadow maps, optical depths towards the lights, shadow ramp.
//! Writes: the host's color target.
//! Blend: DST, ZERO.

use crate::renderer::gpu::host_pass::HostPass;
use crate::renderer::gpu::pipeline::{MULTIPLY, RenderPipelineDescription, read_only_depth};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;

impl PipelineKey for HostPass {
    const PASS: &'static str = "screen_shadow";
    const GROUPS: GroupSet = GroupSet::ScreenShadow;
    type Description = RenderPipelineDescription;

    fn describe(self) -> RenderPipelineDescription {
        RenderPipelineDescription {
            buffers: &[],
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: self.depth_format.map(|format| read_only_depth(format, wgpu::CompareFunction::Always)),
            sample_count: self.sample_count,
            targets: self.color_targets(MULTIPLY),
            constants: Vec::new(),
        }
    }
}

/// The pass for one frame, in the host's pass.
#[derive(Debug)]
pub(crate) struct ScreenShadow<'a> {
    pub pipeline: wgpu::RenderPipeline,
    /// Groups 0 to 3: shadow maps, frame, lights, shadow on the scene.
    pub groups: [&'a wgpu::BindGroup; 4],
}

impl ScreenShadow<'_> {
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        for (index, group) in (0..).zip(self.groups) {
            pass.set_bind_group(index, group, &[]);
        }
        pass.draw(0..3, 0..1);
    }
}
