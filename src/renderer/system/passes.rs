//! Passes that one frame records for a system, with all their bindings.

use std::sync::Arc;

use haze_core::formula::smoke_tiles::{tile_counts, tile_side};
use haze_core::settings::DebugView;
use haze_core::view_setup::SystemSetup;

use crate::renderer::auto::PathWorkload;
use crate::renderer::frame_bindings::DepthBindings;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::frame_encoder::FrameEncoder;
use crate::renderer::pass::accumulate::{Accumulate, AccumulateKey, DepthTest};
use crate::renderer::pass::depth_downsample::{DEPTH_COPY, REDUCED_DEPTH};
use crate::renderer::pass::depth_sort::DepthSort;
use crate::renderer::pass::diffuse_bake::DiffuseBake;
use crate::renderer::pass::emit::Emit;
use crate::renderer::pass::forward::Forward;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::specular_scatter::{self, SpecularScatter};
use crate::renderer::pass::sprite_instances::Sprites;
use crate::renderer::pass::texel_pass::TexelInputs;
use crate::renderer::pass::transfer::{self, LitInputs, Transfer};
use crate::renderer::pass::{TexelPasses, transfer_lit};
use crate::renderer::pipelines::{DrawnPipelines, Pipelines};
use crate::renderer::plan::{DeferredPlan, ForwardPlan};
use crate::renderer::targets::{InputGroups, SystemTextures};
use crate::renderer::tiled::{TiledInputs, TiledPasses, TiledSystem};

/// Pass that produces a system's particles on the GPU, if their buffer cannot be drawn as is.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "as SystemPasses")]
pub(crate) enum ParticlePass {
    /// Evaluates an emitter.
    Emit(Emit),
    /// Sorts a host's particles back to front.
    DepthSort(DepthSort, Groups),
}

impl ParticlePass {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        match self {
            Self::Emit(emit) => emit.record(encoder.compute("emit")),
            Self::DepthSort(sort, groups) => sort.record(encoder.compute("sort"), groups),
        }
    }
}

/// Passes that draw a system.
#[derive(Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "one per system, built in place; a box would cost an allocation per frame"
)]
pub(crate) enum SystemPasses {
    Forward(Forward),
    Deferred(DeferredPasses),
}

/// Passes of the deferred path.
#[derive(Debug)]
pub(crate) struct DeferredPasses {
    pub texels: TexelPasses,
    pub diffuse_bake: Option<DiffuseBake>,
    pub accumulate: AccumulatePasses,
    pub overdraw: Option<Accumulate>,
    pub transfer: Transfer,
    pub specular_scatter: Option<SpecularScatter>,
    pub sprites: Sprites,
}

/// Accumulation by either path.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "as SystemPasses")]
pub(crate) enum AccumulatePasses {
    Raster(Accumulate),
    Tiled(TiledPasses),
}

impl AccumulatePasses {
    pub fn record(&self, encoder: &mut FrameEncoder<'_>) {
        match self {
            Self::Raster(accumulate) => accumulate.record(encoder),
            Self::Tiled(passes) => passes.record(encoder),
        }
    }
}

/// Resources from which a system's passes are built.
pub(crate) struct PassBuilder<'a> {
    pub gpu: Gpu<'a>,
    pub pipelines: &'a Pipelines,
    pub groups: Groups,
    pub sprites: Sprites,
}

/// From what the passes of the deferred path are built, besides.
pub(crate) struct DeferredInputs<'a> {
    pub textures: SystemTextures<'a>,
    /// Bind groups of the textures.
    pub groups: &'a mut InputGroups,
    pub setup: &'a SystemSetup,
    /// Host depth that the plan reads.
    pub depth: &'a DepthBindings,
    /// The host's depth buffer, for a hardware depth test against it.
    pub host_depth: Option<&'a wgpu::TextureView>,
    /// State of the path `tiled` that the system keeps between frames.
    pub tiles: &'a mut TiledSystem,
    pub workload: Option<&'a PathWorkload>,
}

impl PassBuilder<'_> {
    pub fn forward(self, plan: &ForwardPlan) -> SystemPasses {
        let pipeline = self.pipelines.drawn.forward.get(plan.key);
        SystemPasses::Forward(Forward { pipeline, groups: self.groups, sprites: self.sprites })
    }

    pub fn deferred(self, plan: &DeferredPlan<'_>, inputs: DeferredInputs<'_>) -> SystemPasses {
        let Self { gpu, pipelines, groups, sprites } = self;
        let DeferredInputs { textures, groups: input_groups, setup, depth, host_depth, tiles, workload } = inputs;
        let drawn = &pipelines.drawn;
        let accumulation = textures.accumulation;
        let reduced_depth = accumulation.get(&REDUCED_DEPTH);
        let size = setup.rect.size;
        let compared = match reduced_depth {
            Some(depth) => input_groups.get("accumulate", || drawn.accumulate.bind_textures([depth])),
            None => depth.accumulate_inputs.clone(),
        };
        let accumulate = |key: AccumulateKey, targets: &Arc<[wgpu::TextureView]>| Accumulate {
            pipeline: drawn.accumulate.get(key),
            targets: targets.clone(),
            tested_depth: match key.depth_test {
                DepthTest::InShader => None,
                DepthTest::Reduced => reduced_depth.cloned(),
                DepthTest::Copy => accumulation.get(&DEPTH_COPY).cloned(),
                DepthTest::Host(..) => host_depth.cloned(),
            },
            size,
            groups: groups.clone(),
            inputs: compared.clone(),
            sprites: sprites.clone(),
        };
        let mut texels = TexelInputs { groups: &groups, textures, inputs: input_groups, size };
        SystemPasses::Deferred(DeferredPasses {
            texels: pipelines.texels.passes(&plan.texels, &mut texels),
            diffuse_bake: plan.diffuse_bake.map(|key| DiffuseBake {
                pipeline: drawn.diffuse_bake.get(key),
                faces: textures.baked_diffuse.faces.clone(),
                groups: groups.clone(),
            }),
            accumulate: match (plan.tiled, &pipelines.tiled) {
                (Some(keys), Some(tiled)) => {
                    let inputs = TiledInputs {
                        sprites: &sprites,
                        size,
                        attachments: &accumulation.attachments,
                        depth: reduced_depth.unwrap_or(&depth.depth),
                        workload,
                    };
                    AccumulatePasses::Tiled(tiles.write(&gpu, tiled, keys, &groups, &inputs))
                }
                _ => AccumulatePasses::Raster(accumulate(plan.accumulate, &accumulation.attachments)),
            },
            overdraw: plan.overdraw.zip(accumulation.overdraw.as_ref()).map(|(key, layers)| accumulate(key, layers)),
            transfer: transfer_pass(drawn, plan, &groups, textures, input_groups, setup),
            specular_scatter: plan.specular_scatter.filter(|_| setup.uniform.light_count > 0).map(|key| {
                SpecularScatter {
                    pipeline: drawn.specular_scatter.get(key),
                    inputs: specular_scatter::inputs(&drawn.specular_scatter, textures, input_groups),
                    groups: groups.clone(),
                    lights: setup.uniform.light_count,
                    is_in_transfer: plan.glows_in_transfer(),
                }
            }),
            sprites: sprites.clone(),
        })
    }
}

fn transfer_pass(
    pipelines: &DrawnPipelines,
    plan: &DeferredPlan<'_>,
    groups: &Groups,
    textures: SystemTextures<'_>,
    inputs: &mut InputGroups,
    setup: &SystemSetup,
) -> Transfer {
    let mut by_debug_view = [const { [const { None }; 2] }; DebugView::ALL.len()];
    for key in plan.transfers() {
        by_debug_view[key.debug_view as usize] = [Some(pipelines.transfer.get(key)), None];
    }
    for (debug_view, keys) in plan.lit_transfers() {
        by_debug_view[debug_view as usize] = keys.map(|key| key.map(|key| pipelines.transfer_lit.get(key)));
    }
    Transfer {
        pipelines: by_debug_view,
        groups: groups.clone(),
        inputs: transfer::inputs(&pipelines.transfer, textures, inputs),
        overdraw_inputs: transfer::overdraw_inputs(&pipelines.transfer, textures, inputs),
        lit: plan.transfer_lit.map(|_| LitInputs {
            group: transfer_lit::inputs(&pipelines.transfer_lit, textures, inputs),
            tiles: tile_counts(setup.rect.size, tile_side(setup.rect.scale)).element_product(),
        }),
    }
}
