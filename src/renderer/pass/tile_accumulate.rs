//! tile_accumulate: accumulates every sprite's normal, or its six-way light, and amount, texel by texel, front to back.
//!
//! Reads: sprite lists, sprite flipbook, detail map or noise, reduced depth or the host's own.
//! Writes: accumulation target.
//! Source: OTEE "Accumulating the particles"; Porter and Duff, "Compositing digital images", 1984.

use glam::UVec2;

use super::Groups;
use super::tile_refine;
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant, enum_constant};
use crate::renderer::sprite_instances::SpriteKey;
use crate::renderer::targets::{TiledFormats, attachment_constants, tiled_formats};
use crate::settings::{AccumulationFormat, NormalEncoding};
use crate::view_setup::AttachmentSet;

/// Texels per workgroup of the entry points `cooperative` and `split`, and of `per_invocation`, in `shaders/tile_accumulate.wgsl`.
pub(crate) const COOPERATIVE_TILE: UVec2 = UVec2::new(8, 16);
const PER_INVOCATION_TILE: UVec2 =
    UVec2::new(tile_refine::PER_INVOCATION_TILE.x, 8 * tile_refine::PER_INVOCATION_TILE.y);

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileAccumulateKey {
    pub sprite: SpriteKey,
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub weighted: bool,
    pub attachments: AttachmentSet,
    /// True if sprites are compared with the host's own depth instead of the reduced depth.
    pub host_depth: bool,
    /// True if the traversal stops where a texel is opaque.
    pub stops: bool,
    /// True for cooperative traversal, false for per-invocation traversal.
    pub cooperative: bool,
    /// True if a cooperative workgroup traverses parts of its list at the same time.
    pub split: bool,
}

impl TileAccumulateKey {
    /// Returns the formats of the textures that the pass writes.
    pub fn formats(&self) -> TiledFormats {
        tiled_formats(self.attachments, self.format)
    }
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TileAccumulateKey) -> ComputePipelineDescription {
    ComputePipelineDescription {
        entry_point: match (key.cooperative, key.split) {
            (true, true) => "split",
            (true, false) => "cooperative",
            (false, _) => "per_invocation",
        },
        constants: key.sprite.constants(attachment_constants(key.attachments).chain([
            enum_constant!("NORMAL_ENCODING", key.encoding),
            bool_constant("HOST_DEPTH", key.host_depth),
            bool_constant("WEIGHTED", key.weighted),
            bool_constant("STOPS", key.stops),
            bool_constant("LOADS_SPRITE", !key.cooperative),
        ])),
    }
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileAccumulate {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub cooperative: bool,
}

impl TileAccumulate {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        let side = if self.cooperative { COOPERATIVE_TILE } else { PER_INVOCATION_TILE };
        pass.dispatch_workgroups(self.size.x.div_ceil(side.x), self.size.y.div_ceil(side.y), 1);
    }
}
