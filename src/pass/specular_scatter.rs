//! specular_scatter
//! What: the glow of lights behind the smoke, one quad of constant pixel size round each.
//! Reads: accumulation target, reduced depth, scene depth, lights, specular ramp. Writes: the host's colour target.
//! Blend: ONE, ONE. Source: OTEE "Specular scattering".

use super::bind;
use super::{
    ADDITIVE, Layouts, PipelineParts, STRIP, Variants, color_target, create_pipeline, read_only_depth, switch, variant,
};
use crate::descriptor::Descriptor;
use crate::frame_bindings::FrameBindings;
use crate::settings::Upsample;
use crate::slot::{DrawPath, Slot};

#[derive(Debug)]
pub(crate) struct SpecularScatterPass {
    variants: Variants<Upsample>,
    descriptor: Descriptor,
}

impl SpecularScatterPass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, descriptor: &Descriptor) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material), Some(&layouts.transfer)];
        Self { variants: Variants::new(device, "specular_scatter", &groups), descriptor: *descriptor }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, upsample: Upsample) -> wgpu::RenderPipeline {
        let descriptor = self.descriptor;
        self.variants.get(upsample, |module, layout| {
            let depth = descriptor.depth_format.map(|format| read_only_depth(format, wgpu::CompareFunction::Always));
            create_pipeline(
                device,
                PipelineParts {
                    label: "specular_scatter",
                    module,
                    layout,
                    buffers: &[],
                    primitive: STRIP,
                    depth_stencil: depth,
                    sample_count: descriptor.sample_count,
                    targets: &[color_target(descriptor.color_format, Some(ADDITIVE))],
                    constants: &[variant!("UPSAMPLE", upsample), switch("EXACT_FILTERING", descriptor.exact_filtering)],
                },
            )
        })
    }
}

/// Records the pass for one system into the host's pass: one quad per light.
pub(crate) fn record(pass: &mut wgpu::RenderPass<'_>, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { specular_scatter: Some((pipeline, lights)), .. } = &draw.path else { return };
    pass.set_pipeline(pipeline);
    bind(pass, frame, slot, draw);
    pass.set_bind_group(3, &targets.transfer_inputs, &[]);
    pass.draw(0..4, 0..*lights);
}
