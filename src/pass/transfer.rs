//! transfer
//! What: lights the accumulated smoke once per pixel, over the system's bounding box.
//! Reads: accumulation target, reduced depth, scene depth, lights, ramps. Writes: the host's colour target.
//! Blend: ONE, ONE_MINUS_SRC_ALPHA. Source: OTEE "Transfer & lighting".

use super::bind;
use super::{
    Layouts, PREMULTIPLIED_OVER, PipelineParts, Variants, color_target, create_pipeline, in_front, read_only_depth,
    switch, variant,
};
use crate::descriptor::Descriptor;
use crate::frame_bindings::FrameBindings;
use crate::settings::{DiffuseMode, NormalDecode, NormalEncoding, ShadeTree, SoftScatterMode, Upsample};
use crate::slot::{DrawPath, Slot};

/// Vertices of the box: twelve triangles.
const BOX_VERTICES: u32 = 36;

/// What makes one transfer pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TransferKey {
    pub encoding: NormalEncoding,
    pub decode: NormalDecode,
    pub diffuse_mode: DiffuseMode,
    pub soft_scatter_mode: SoftScatterMode,
    pub upsample: Upsample,
    pub host_depth: bool,
    pub shade_tree: ShadeTree,
    /// Draw the back faces, untested, because the near plane cuts the box.
    pub back_faces: bool,
    pub reversed: bool,
}

#[derive(Debug)]
pub(crate) struct TransferPass {
    variants: Variants<TransferKey>,
    descriptor: Descriptor,
}

impl TransferPass {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, descriptor: &Descriptor) -> Self {
        let groups = [Some(&layouts.frame), Some(&layouts.system), Some(&layouts.material), Some(&layouts.transfer)];
        Self { variants: Variants::new(device, "transfer", &groups), descriptor: *descriptor }
    }

    pub fn pipeline(&mut self, device: &wgpu::Device, key: TransferKey) -> wgpu::RenderPipeline {
        let descriptor = self.descriptor;
        self.variants.get(key, |module, layout| {
            let (cull, compare) = if key.back_faces {
                (wgpu::Face::Front, wgpu::CompareFunction::Always)
            } else {
                (wgpu::Face::Back, in_front(key.reversed))
            };
            create_pipeline(
                device,
                PipelineParts {
                    label: "transfer",
                    module,
                    layout,
                    buffers: &[],
                    primitive: wgpu::PrimitiveState { cull_mode: Some(cull), ..Default::default() },
                    depth_stencil: descriptor.depth_format.map(|format| read_only_depth(format, compare)),
                    sample_count: descriptor.sample_count,
                    targets: &[color_target(descriptor.color_format, Some(PREMULTIPLIED_OVER))],
                    constants: &[
                        variant!("DIFFUSE_MODE", key.diffuse_mode),
                        variant!("SOFT_SCATTER_MODE", key.soft_scatter_mode),
                        variant!("NORMAL_ENCODING", key.encoding),
                        variant!("NORMAL_DECODE", key.decode),
                        variant!("UPSAMPLE", key.upsample),
                        variant!("SHADE_TREE", key.shade_tree),
                        switch("HOST_DEPTH", key.host_depth),
                        switch("BACK_FACES", key.back_faces),
                        switch("EXACT_FILTERING", descriptor.exact_filtering),
                    ],
                },
            )
        })
    }
}

/// Records the pass for one system into the host's pass.
pub(crate) fn record(pass: &mut wgpu::RenderPass<'_>, frame: &FrameBindings, slot: &Slot) {
    let (Some(draw), Some(targets)) = (&slot.draw, &slot.targets) else { return };
    let DrawPath::Deferred { transfer: Some(pipeline), .. } = &draw.path else { return };
    pass.set_pipeline(pipeline);
    bind(pass, frame, slot, draw);
    pass.set_bind_group(3, &targets.transfer_inputs, &[]);
    pass.draw(0..BOX_VERTICES, 0..1);
}
