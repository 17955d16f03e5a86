//! accumulate
//! What: blends every sprite's normal and amount into the accumulation target.
//! Reads: particles back to front, sprite flipbook, reduced depth or the host's own. Writes: accumulation target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA. Source: OTEE "Accumulating the particles".

use super::{
    ADDITIVE, Layouts, PARTICLE_LAYOUT, PREMULTIPLIED_OVER, PipelineParts, STRIP, Variants, color_target,
    create_pipeline, in_front, read_only_depth, switch, variant,
};
use super::{begin_pass, bind, color_attachment, read_only, set_part};
use crate::frame_bindings::FrameBindings;
use crate::settings::{AccumulationFormat, FadeCurve, NormalEncoding};
use crate::slot::{DrawPath, Slot};
use crate::targets::{REDUCED_DEPTH_FORMAT, accumulation_layout};

/// What makes one accumulation pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulateKey {
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub curve: FadeCurve,
    pub depth_test: DepthTest,
    /// Count layers instead of blending normals.
    pub overdraw: bool,
}

/// What rejects hidden sprites before they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DepthTest {
    /// Nothing: this backend cannot test what the shader samples.
    InShader,
    /// The hardware, against the reduced depth.
    Reduced,
    /// The hardware, against the host's depth: its format, and whether it is reversed.
    Host(wgpu::TextureFormat, bool),
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
            let depth_stencil = match key.depth_test {
                DepthTest::InShader => None,
                DepthTest::Reduced => Some(read_only_depth(REDUCED_DEPTH_FORMAT, in_front(false))),
                DepthTest::Host(format, reversed) => Some(read_only_depth(format, in_front(reversed))),
            };
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
                    depth_stencil,
                    sample_count: 1,
                    targets: &targets,
                    constants: &[
                        variant!("FADE_CURVE", key.curve),
                        variant!("NORMAL_ENCODING", key.encoding),
                        switch("HOST_DEPTH", matches!(key.depth_test, DepthTest::Host(..))),
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
    let DrawPath::Deferred { accumulate, tested_depth, .. } = &draw.path else { return };
    let attachments = targets.accumulation.each_ref().map(color_attachment);
    let mut pass = begin_pass(encoder, "accumulate", &attachments, read_only(tested_depth.as_ref()));
    set_part(&mut pass, draw.rect.size);
    pass.set_pipeline(accumulate);
    bind(&mut pass, frame, slot, draw);
    pass.set_bind_group(3, &targets.accumulate_inputs, &[]);
    pass.set_vertex_buffer(0, draw.instances.slice(..));
    pass.draw(0..4, 0..draw.instance_count);
}
