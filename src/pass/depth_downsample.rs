//! depth_downsample
//! What: brings the scene's depth to the resolution of the accumulation target.
//! Reads: scene depth. Writes: reduced depth, R32Float, linear metres, at most `depth_limit`. Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use super::{Layouts, PipelineParts, Variants, color_target, create_pipeline, variant};
use crate::settings::DepthDownsample;
use crate::targets::REDUCED_DEPTH_FORMAT;

#[derive(Debug)]
pub(crate) struct DepthDownsamplePass {
    variants: Variants<DepthDownsample>,
}

impl DepthDownsamplePass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system)];
        Self { variants: Variants::new(device, "depth_downsample", &groups) }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, mode: DepthDownsample) -> wgpu::RenderPipeline {
        self.variants.get(mode, |module, layout| {
            create_pipeline(
                device,
                PipelineParts {
                    label: "depth_downsample",
                    module,
                    layout,
                    buffers: &[],
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: None,
                    sample_count: 1,
                    targets: &[color_target(REDUCED_DEPTH_FORMAT, None)],
                    constants: &[variant!("DEPTH_DOWNSAMPLE", mode)],
                },
            )
        })
    }
}
