//! forward
//! What: the classic way: every sprite fragment lit and blended at full resolution.
//! Reads: particles back to front, sprite flipbook, detail map or noise, scene depth, lights, ramps. Writes: the host's colour target.
//! Blend: alpha, additive or multiply. Source: OTEE "Typical game particles so far".

use super::bind;
use super::{
    ADDITIVE, Layouts, MULTIPLY, PARTICLE_LAYOUT, PREMULTIPLIED_OVER, PipelineParts, STRIP, Variants, color_target,
    create_pipeline, in_front, read_only_depth, switch, variant,
};
use crate::descriptor::Descriptor;
use crate::frame_bindings::FrameBindings;
use crate::settings::{BlendMode, SoftScatterMode};
use crate::slot::{DrawPath, Slot};
use crate::sprite_key::SpriteKey;

/// What makes one forward pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ForwardKey {
    pub blend_mode: BlendMode,
    pub sprite: SpriteKey,
    pub age_colour: bool,
    /// Sprites are seen behind the scene: nothing tests depth.
    pub shows_through: bool,
    pub soft_scatter_mode: SoftScatterMode,
    pub reversed: bool,
}

#[derive(Debug)]
pub(crate) struct ForwardPass {
    variants: Variants<ForwardKey>,
    descriptor: Descriptor,
}

impl ForwardPass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, descriptor: &Descriptor) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material)];
        Self { variants: Variants::new(device, "forward", &groups), descriptor: *descriptor }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, key: ForwardKey) -> wgpu::RenderPipeline {
        let descriptor = self.descriptor;
        self.variants.get(key, |module, layout| {
            let blend = match key.blend_mode {
                BlendMode::Alpha => PREMULTIPLIED_OVER,
                BlendMode::Additive => ADDITIVE,
                BlendMode::Multiply => MULTIPLY,
            };
            let compare = if key.shows_through { wgpu::CompareFunction::Always } else { in_front(key.reversed) };
            let depth = descriptor.depth_format.map(|format| read_only_depth(format, compare));
            create_pipeline(
                device,
                PipelineParts {
                    label: "forward",
                    module,
                    layout,
                    buffers: &[Some(PARTICLE_LAYOUT)],
                    primitive: STRIP,
                    depth_stencil: depth,
                    sample_count: descriptor.sample_count,
                    targets: &[color_target(descriptor.color_format, Some(blend))],
                    constants: &key.sprite.constants([
                        variant!("BLEND_MODE", key.blend_mode),
                        switch("AGE_COLOUR", key.age_colour),
                        switch("DEPTH_TESTED", descriptor.depth_format.is_some() && !key.shows_through),
                        variant!("SOFT_SCATTER_MODE", key.soft_scatter_mode),
                        switch("EXACT_FILTERING", descriptor.exact_filtering),
                    ]),
                },
            )
        })
    }
}

/// Records the pass for one system into the host's pass.
pub(crate) fn record(pass: &mut wgpu::RenderPass<'_>, frame: &FrameBindings, slot: &Slot) {
    let Some(draw) = &slot.draw else { return };
    let DrawPath::Forward(pipeline) = &draw.path else { return };
    pass.set_pipeline(pipeline);
    bind(pass, frame, slot, draw);
    pass.set_vertex_buffer(0, draw.instances.slice(..));
    for _ in 0..draw.debug_loop {
        pass.draw(0..4, 0..draw.instance_count);
    }
}
