//! accumulate
//! What: blends every sprite's normal and amount into the accumulation target.
//! Reads: particles back to front, sprite flipbook, detail map or noise, reduced depth or the host's own. Writes:
//! accumulation target. Blend: ONE, ONE_MINUS_SRC_ALPHA. Source: OTEE "Accumulating the particles"; techniques: NV, BLOG, MS.

use super::{
    ADDITIVE, Layouts, PARTICLE_LAYOUT, PREMULTIPLIED_OVER, PipelineParts, STRIP, Variants, color_target,
    create_pipeline, in_front, read_only_depth, switch, variant,
};
use super::{begin_pass, bind, color_attachment, read_only, set_part};
use crate::frame_bindings::FrameBindings;
use crate::settings::{AccumulationFormat, NormalEncoding};
use crate::slot::{DrawPath, Slot};
use crate::sprite_key::SpriteKey;
use crate::targets::{DEPTH_COPY_FORMAT, REDUCED_DEPTH_FORMAT, accumulation_layout};

/// What makes one accumulation pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct AccumulateKey {
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub sprite: SpriteKey,
    /// Sprites are compared with the host's own depth, not the reduced one.
    pub host_depth: bool,
    pub depth_test: DepthTest,
    /// Count layers instead of blending normals.
    pub overdraw: bool,
}

/// What rejects hidden sprites before they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DepthTest {
    /// Nothing: what is behind the scene may show.
    InShader,
    /// The hardware, against the reduced depth, which the shader samples too.
    Reduced,
    /// The hardware, against a coarse copy of the reduced depth: this backend cannot test what the shader samples.
    Copy,
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
                DepthTest::Copy => Some(read_only_depth(DEPTH_COPY_FORMAT, in_front(false))),
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
                    constants: &key.sprite.constants([
                        variant!("NORMAL_ENCODING", key.encoding),
                        switch("HOST_DEPTH", key.host_depth),
                        // The copy is too coarse to stand in for the shader's own test.
                        switch("DEPTH_TESTED", !matches!(key.depth_test, DepthTest::InShader | DepthTest::Copy)),
                        switch("OVERDRAW", key.overdraw),
                        switch("EXACT_FILTERING", exact_filtering),
                    ]),
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
    for _ in 0..draw.debug_loop {
        pass.draw(0..4, 0..draw.instance_count);
    }
}
