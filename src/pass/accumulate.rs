//! accumulate
//! What: blends every sprite's normal and amount into the accumulation target.
//! Reads: particles back to front, sprite flipbook, reduced depth or the host's own. Writes: accumulation target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA. Source: OTEE "Accumulating the particles".

use super::{
    ADDITIVE, Layouts, PARTICLE_LAYOUT, PREMULTIPLIED_OVER, PipelineParts, STRIP, Variants, color_target,
    create_pipeline, in_front, read_only_depth, switch, variant,
};
use super::{begin_pass, bind, color_attachment, set_part};
use crate::frame_bindings::FrameBindings;
use crate::settings::{AccumulationFormat, FadeCurve, NormalEncoding};
use crate::slot::{DrawPath, Slot};
use crate::targets::accumulation_layout;

/// What makes one accumulation pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulateKey {
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub curve: FadeCurve,
    /// Format of the host's depth and whether it is reversed, where sprites are tested against it.
    pub host_depth: Option<(wgpu::TextureFormat, bool)>,
    /// Count layers instead of blending normals.
    pub overdraw: bool,
}

#[derive(Debug)]
pub(crate) struct AccumulatePass {
    variants: Variants<AccumulateKey>,
    exact_filtering: bool,
}

impl AccumulatePass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, exact_filtering: bool) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material), Some(&layouts.accumulate)];
        Self { variants: Variants::new(device, "accumulate", &groups), exact_filtering }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, key: AccumulateKey) -> wgpu::RenderPipeline {
        let exact_filtering = self.exact_filtering;
        self.variants.get(key, |module, layout| {
            let blend = if key.overdraw { COUNT } else { PREMULTIPLIED_OVER };
            let targets =
                accumulation_layout(key.format).map(|attachment| color_target(attachment.format, Some(blend)));
            create_pipeline(
                device,
                PipelineParts {
                    label: "accumulate",
                    module,
                    layout,
                    buffers: &[Some(PARTICLE_LAYOUT)],
                    primitive: STRIP,
                    depth_stencil: key.host_depth.map(|(format, reversed)| read_only_depth(format, in_front(reversed))),
                    sample_count: 1,
                    targets: &targets,
                    constants: &[
                        variant!("FADE_CURVE", key.curve),
                        variant!("NORMAL_ENCODING", key.encoding),
                        switch("HOST_DEPTH", key.host_depth.is_some()),
                        switch("OVERDRAW", key.overdraw),
                        switch("EXACT_FILTERING", exact_filtering),
                    ],
                },
            )
        })
    }
}

/// Adds up colour and alpha.
const COUNT: wgpu::BlendState = wgpu::BlendState { color: ADDITIVE.color, alpha: ADDITIVE.color };

/// Records the pass for one system.
pub(crate) fn record(encoder: &mut wgpu::CommandEncoder, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { accumulate, host_depth, .. } = &draw.path else { return };
    let attachments = targets.accumulation.each_ref().map(color_attachment);
    let mut pass = begin_pass(encoder, "accumulate", &attachments, host_depth.as_ref());
    set_part(&mut pass, draw.rect.size);
    pass.set_pipeline(accumulate);
    bind(&mut pass, frame, slot, draw);
    pass.set_bind_group(3, &targets.accumulate_inputs, &[]);
    pass.set_vertex_buffer(0, draw.instances.slice(..));
    pass.draw(0..4, 0..draw.instance_count);
}
