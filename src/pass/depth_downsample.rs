//! depth_downsample
//! What: brings the scene's depth to the resolution of the accumulation target.
//! Reads: scene depth. Writes: reduced depth, Depth32Float, linear view depth over `depth_limit`; where a backend cannot
//! test what it samples, a coarse copy as well, never nearer than the original. Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use super::{Layouts, PipelineParts, Variants, create_pipeline, switch, variant};
use super::{begin_pass, read_only_depth, set_part};
use crate::frame_bindings::FrameBindings;
use crate::settings::DepthDownsample;
use crate::slot::{DrawPath, Slot};
use crate::targets::{DEPTH_COPY_FORMAT, REDUCED_DEPTH_FORMAT};

#[derive(Debug)]
pub(crate) struct DepthDownsamplePass {
    /// By mode, and whether for the copy.
    variants: Variants<(DepthDownsample, bool)>,
}

impl DepthDownsamplePass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system)];
        Self { variants: Variants::new(device, "depth_downsample", &groups) }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, mode: DepthDownsample, copy: bool) -> wgpu::RenderPipeline {
        self.variants.get((mode, copy), |module, layout| {
            let format = if copy { DEPTH_COPY_FORMAT } else { REDUCED_DEPTH_FORMAT };
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
                        ..read_only_depth(format, wgpu::CompareFunction::Always)
                    }),
                    sample_count: 1,
                    targets: &[],
                    constants: &[variant!("DEPTH_DOWNSAMPLE", mode), switch("COARSE_COPY", copy)],
                },
            )
        })
    }
}

/// Records the pass for one system.
pub(crate) fn record(encoder: &mut wgpu::CommandEncoder, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { depth_downsample, depth_copy, .. } = &draw.path else { return };
    for (pipeline, view) in [(depth_downsample, &targets.reduced_depth), (depth_copy, &targets.depth_copy)] {
        let (Some(pipeline), Some(view)) = (pipeline, view) else { continue };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        };
        let mut pass = begin_pass(encoder, "depth_downsample", &[], Some(depth));
        set_part(&mut pass, draw.rect.size);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, frame.bind_group(draw.linear_depth), &[]);
        pass.set_bind_group(1, &slot.bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}
