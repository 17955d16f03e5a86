//! tile_refine
//! What: lists, for every tile of a few texels, those of its bin's sprites that it may show something of.
//! Reads: lists of bins, sprites, reduced depth or the host's own. Writes: lists of tiles.

use glam::UVec2;

use super::Groups;
use super::sprites::SpriteKey;
use crate::renderer::gpu::pipeline::{ComputeParts, switch};

/// Texels of a tile: TILE_ALONE in `shaders/lib/tiles.wgsl`.
pub(crate) const ALONE: UVec2 = UVec2::new(8, 4);
/// Tiles along a workgroup's sides.
const WORKGROUP: UVec2 = UVec2::splat(8);

/// What makes one pipeline differ from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TileRefineKey {
    step: Step,
    sprite: SpriteKey,
    host_depth: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Step {
    Mark,
    Refine,
}

/// All of them, in order. `host_depth`: sprites are compared with the host's own depth, not the reduced one.
pub(crate) fn keys(sprite: SpriteKey, host_depth: bool) -> [TileRefineKey; 2] {
    [Step::Mark, Step::Refine].map(|step| TileRefineKey { step, sprite, host_depth })
}

/// The pipeline for a key.
pub(crate) fn describe(key: TileRefineKey) -> ComputeParts {
    ComputeParts {
        entry_point: match key.step {
            Step::Mark => "mark",
            Step::Refine => "refine",
        },
        constants: key.sprite.constants([switch("HOST_DEPTH", key.host_depth)]),
    }
}

/// Tiles along the sides of a target.
pub(crate) fn tiles_along(size: UVec2) -> UVec2 {
    UVec2::new(size.x.div_ceil(ALONE.x), size.y.div_ceil(ALONE.y))
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileRefine {
    /// As [`keys`].
    pub pipelines: [wgpu::ComputePipeline; 2],
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    /// Texels in use.
    pub size: UVec2,
    pub bins: u32,
}

impl TileRefine {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        let tiles = tiles_along(self.size);
        let by_tile = (tiles.x.div_ceil(WORKGROUP.x), tiles.y.div_ceil(WORKGROUP.y));
        for (pipeline, (x, y)) in self.pipelines.iter().zip([(self.bins, 1), by_tile]) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}
