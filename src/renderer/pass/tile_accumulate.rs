//! tile_accumulate: accumulates every sprite's normal, or its six-way light, and amount, texel by texel, front to back.
//!
//! Reads: sprite lists, sprite flipbook, detail map or noise, reduced depth or the host's own.
//! Writes: accumulation target.
//! Source: OTEE "Accumulating the particles"; Porter and Duff, "Compositing digital images", 1984.

use glam::UVec2;

use super::Groups;
use super::sprites::SpriteKey;
use super::tile_refine;
use crate::renderer::gpu::pipeline::{ComputeParts, switch, variant};
use crate::renderer::targets::Beside;
use crate::settings::{AccumulationFormat, NormalEncoding};

/// Texels per workgroup of the entry points `in_step` and `alone` in `shaders/tile_accumulate.wgsl`.
const IN_STEP: UVec2 = UVec2::new(8, 16);
const ALONE: UVec2 = UVec2::new(tile_refine::ALONE.x, 8 * tile_refine::ALONE.y);

/// Key of a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileAccumulateKey {
    pub sprite: SpriteKey,
    pub format: AccumulationFormat,
    pub encoding: NormalEncoding,
    pub weighted: bool,
    pub beside: Beside,
    /// True if sprites are compared with the host's own depth instead of the reduced depth.
    pub host_depth: bool,
    /// True if the traversal stops where a texel is opaque.
    pub stops: bool,
    /// True for cooperative traversal, false for per-invocation traversal.
    pub in_step: bool,
}

/// Returns the pipeline's parts for a key.
pub(crate) fn describe(key: TileAccumulateKey) -> ComputeParts {
    ComputeParts {
        entry_point: if key.in_step { "in_step" } else { "alone" },
        constants: key.sprite.constants([
            variant!("NORMAL_ENCODING", key.encoding),
            switch("HOST_DEPTH", key.host_depth),
            switch("WEIGHTED", key.weighted),
            switch("BYTE_TARGET", key.format == AccumulationFormat::Rgba8Unorm),
            switch("SUMS_WEIGHTS", key.beside == Beside::Weights),
            switch("STOPS", key.stops),
            switch("LOADS_SPRITE", !key.in_step),
        ]),
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
    pub in_step: bool,
}

impl TileAccumulate {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        let side = if self.in_step { IN_STEP } else { ALONE };
        pass.dispatch_workgroups(self.size.x.div_ceil(side.x), self.size.y.div_ceil(side.y), 1);
    }
}
