//! tile_accumulate: accumulates every sprite's normal, or its six-way light, and amount, texel by texel, front to back.
//!
//! Reads: sprite lists, sprite flipbook, detail map or noise, reduced depth or the host's own.
//! Writes: accumulation target.
//! Source: OTEE "Accumulating the particles"; Porter and Duff, "Compositing digital images", 1984.

use haze_core::formula::uniforms::TilesUniform;
use haze_core::glam::UVec2;
use haze_core::settings::{AccumulationFormat, NormalEncoding};
use haze_core::view_setup::{AttachmentSet, MAX_TARGET_ATTACHMENTS};

use super::groups::Groups;
use super::sprite_instances::SpriteKey;
use super::tile_refine;
use crate::renderer::gpu::binding::{LOADED, READ_BUFFER, uniform, written_texture};
use crate::renderer::gpu::pipeline::{ComputePipelineDescription, bool_constant, enum_constant};
use crate::renderer::layouts::GroupSet;
use crate::renderer::pipeline_variants::PipelineKey;
use crate::renderer::targets::{PLACEHOLDER_FORMAT, TiledFormats, attachment_constants, tiled_formats};

/// Texels per workgroup of the entry points `cooperative` and `split`, of `quads`, of `split_finely`, and of `per_invocation`,
/// in `shaders/tile_accumulate.wgsl`.
pub(crate) const COOPERATIVE_TILE: UVec2 = UVec2::new(8, 16);
const QUAD_TILE: UVec2 = UVec2::new(32, 16);
const FINE_TILE: UVec2 = UVec2::new(8, 8);
const PER_INVOCATION_TILE: UVec2 =
    UVec2::new(tile_refine::PER_INVOCATION_TILE.x, 8 * tile_refine::PER_INVOCATION_TILE.y);

/// Division of the work on a texel among invocations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum TraversalMode {
    /// On CPUs: each traverses the list for texels of its own.
    PerInvocation,
    /// On GPUs: a workgroup reads the list together.
    Cooperative,
    /// As `Cooperative`, twice as many texels for each invocation.
    Quads,
    /// As `Cooperative`, four parts of the list at the same time.
    Split,
    /// As `Cooperative`, eight parts at the same time.
    SplitFinely,
}

impl TraversalMode {
    /// The traversals of GPUs.
    pub const COOPERATIVE: [Self; 4] = [Self::Cooperative, Self::Quads, Self::Split, Self::SplitFinely];

    /// Returns the texels per workgroup.
    fn tile(self) -> UVec2 {
        match self {
            Self::PerInvocation => PER_INVOCATION_TILE,
            Self::Cooperative | Self::Split => COOPERATIVE_TILE,
            Self::Quads => QUAD_TILE,
            Self::SplitFinely => FINE_TILE,
        }
    }
}

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
    pub traversal: TraversalMode,
}

impl TileAccumulateKey {
    /// Returns the formats of the textures that the pass writes.
    pub fn formats(&self) -> TiledFormats {
        tiled_formats(self.attachments, self.format)
    }

    /// True for a traversal of GPUs.
    pub fn is_cooperative(&self) -> bool {
        self.traversal != TraversalMode::PerInvocation
    }
}

impl PipelineKey for TileAccumulateKey {
    const PASS: &'static str = "tile_accumulate";
    const GROUPS: GroupSet = GroupSet::Sprites;
    type Description = ComputePipelineDescription;

    fn inputs() -> Vec<wgpu::BindingType> {
        inputs([PLACEHOLDER_FORMAT; MAX_TARGET_ATTACHMENTS]).to_vec()
    }

    fn describe(self) -> ComputePipelineDescription {
        ComputePipelineDescription {
            entry_point: match self.traversal {
                TraversalMode::PerInvocation => "per_invocation",
                TraversalMode::Cooperative => "cooperative",
                TraversalMode::Quads => "quads",
                TraversalMode::Split => "split",
                TraversalMode::SplitFinely => "split_finely",
            },
            constants: self.sprite.constants(attachment_constants(self.attachments).chain([
                enum_constant!("NORMAL_ENCODING", self.encoding),
                bool_constant("HOST_DEPTH", self.host_depth),
                bool_constant("WEIGHTED", self.weighted),
                bool_constant("STOPS", self.stops),
                bool_constant("QUADS", self.traversal == TraversalMode::Quads),
                bool_constant("LOADS_SPRITE", !self.is_cooperative()),
            ])),
        }
    }
}

/// Returns the types of the bindings of group 3 for targets of these formats.
pub(crate) fn inputs(formats: TiledFormats) -> [wgpu::BindingType; 8 + MAX_TARGET_ATTACHMENTS] {
    let mut types = [READ_BUFFER; 8 + MAX_TARGET_ATTACHMENTS];
    types[0] = uniform(size_of::<TilesUniform>());
    types[6] = LOADED;
    let targets = formats.map(|format| written_texture(format, wgpu::TextureViewDimension::D2));
    types[7..7 + MAX_TARGET_ATTACHMENTS].copy_from_slice(&targets);
    types
}

/// The pass for one system.
#[derive(Debug)]
pub(crate) struct TileAccumulate {
    pub pipeline: wgpu::ComputePipeline,
    /// Group 3.
    pub inputs: wgpu::BindGroup,
    /// Size of the part in use, texels.
    pub size: UVec2,
    pub traversal: TraversalMode,
}

impl TileAccumulate {
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &Groups) {
        pass.set_pipeline(&self.pipeline);
        groups.bind_to_compute(pass);
        pass.set_bind_group(3, &self.inputs, &[]);
        let tile = self.traversal.tile();
        pass.dispatch_workgroups(self.size.x.div_ceil(tile.x), self.size.y.div_ceil(tile.y), 1);
    }
}
