//! depth_downsample
//! What: brings the scene's depth to the resolution of the accumulation target.
//! Reads: scene depth. Writes: reduced depth, Depth32Float, linear view depth over `depth_limit`. Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use super::{Layouts, PipelineParts, Variants, create_pipeline, variant};
use super::{begin_pass, read_only_depth, set_part};
use crate::frame_bindings::FrameBindings;
use crate::settings::DepthDownsample;
use crate::slot::{DrawPath, Slot};
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
                    depth_stencil: Some(wgpu::DepthStencilState {
                        depth_write_enabled: Some(true),
                        ..read_only_depth(REDUCED_DEPTH_FORMAT, wgpu::CompareFunction::Always)
                    }),
                    sample_count: 1,
                    targets: &[],
                    constants: &[variant!("DEPTH_DOWNSAMPLE", mode)],
                },
            )
        })
    }
}

/// Records the pass for one system.
pub(crate) fn record(encoder: &mut wgpu::CommandEncoder, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { depth_downsample: Some(pipeline), .. } = &draw.path else { return };
    let Some(view) = &targets.reduced_depth else { return };
    let depth = wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    };
    let mut pass = begin_pass(encoder, "depth_downsample", &[], Some(depth));
    set_part(&mut pass, draw.rect.size);
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, frame.bind_group(), &[]);
    pass.set_bind_group(1, &slot.bindings, &[]);
    pass.draw(0..3, 0..1);
}
