//! Passes that one frame records for a system, with all their bindings.

use std::sync::Arc;

use super::auto::PathWorkload;
use super::frame_bindings::DepthBindings;
use super::gpu::Gpu;
use super::gpu::frame_encoder::FrameEncoder;
use super::pass::accumulate::{Accumulate, AccumulateKey, DepthTest};
use super::pass::depth_sort::DepthSort;
use super::pass::diffuse_bake::DiffuseBake;
use super::pass::emit::Emit;
use super::pass::forward::Forward;
use super::pass::specular_scatter::SpecularScatter;
use super::pass::transfer::{LitInputs, Transfer};
use super::pass::{Groups, TexelPass, TexelPipeline};
use super::pipelines::Pipelines;
use super::plan::{DeferredPlan, ForwardPlan};
use super::sprite_instances::Sprites;
use super::system_targets::{ReadyTargets, TargetInputs};
use super::tiled::{TiledInputs, TiledPasses, TiledSystem};
use crate::formula::smoke_tiles::{CELL_SIDE, tile_counts, tile_side};
use crate::settings::DebugView;
use crate::view_setup::SystemSetup;

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

/// Passes of the deferred path, in execution order.
#[derive(Debug)]
pub(crate) struct DeferredPasses {
    pub depth_downsample: Option<TexelPass>,
    pub depth_copy: Option<TexelPass>,
    pub diffuse_bake: Option<DiffuseBake>,
    pub accumulate: AccumulatePasses,
    pub overdraw: Option<Accumulate>,
    pub light_target: Option<TexelPass>,
    pub depth_slopes: Option<TexelPass>,
    pub mark_cells: Option<TexelPass>,
    pub upsample_lit: Option<TexelPass>,
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

/// State of the path `tiled` that a system keeps between frames, and its workload.
pub(crate) struct TiledContext<'a> {
    pub system: &'a mut TiledSystem,
    pub workload: Option<&'a PathWorkload>,
}

impl PassBuilder<'_> {
    pub fn forward(self, plan: &ForwardPlan) -> SystemPasses {
        let pipeline = self.pipelines.forward.get(plan.key);
        SystemPasses::Forward(Forward { pipeline, groups: self.groups, sprites: self.sprites })
    }

    /// `depth`: the host depth that the plan reads. `host_depth`: the host's depth buffer, for a hardware depth test
    /// against it.
    pub fn deferred(
        self,
        plan: &DeferredPlan<'_>,
        tiles: TiledContext<'_>,
        targets: ReadyTargets<'_>,
        setup: &SystemSetup,
        depth: &DepthBindings,
        host_depth: Option<&wgpu::TextureView>,
    ) -> SystemPasses {
        let Self { gpu, pipelines, groups, sprites } = self;
        let ReadyTargets { accumulation, baked_diffuse, inputs } = targets;
        let size = setup.rect.size;
        let accumulate = |key: AccumulateKey, targets: &Arc<[wgpu::TextureView]>| Accumulate {
            pipeline: pipelines.accumulate.get(key),
            targets: targets.clone(),
            tested_depth: match key.depth_test {
                DepthTest::InShader => None,
                DepthTest::Reduced => accumulation.reduced_depth.clone(),
                DepthTest::Copy => accumulation.depth_copy.clone(),
                DepthTest::Host(..) => host_depth.cloned(),
            },
            size,
            groups: groups.clone(),
            inputs: inputs.accumulate.as_ref().unwrap_or(&depth.accumulate_inputs).clone(),
            sprites: sprites.clone(),
        };
        let computed = pipelines.tiled.as_ref().filter(|_| plan.computes_texels);
        let texel_pass = |name, pipeline, inputs: &Option<wgpu::BindGroup>| TexelPass {
            name,
            pipeline,
            size,
            groups: groups.clone(),
            inputs: inputs.clone(),
        };
        let lights = setup.uniform.light_count;
        SystemPasses::Deferred(DeferredPasses {
            depth_downsample: plan.depth_downsample.and_then(|key| {
                let pipeline = match computed.filter(|_| plan.computes_depth()) {
                    Some(tiled) => TexelPipeline::Compute(tiled.depth_downsample.get(key)),
                    None => {
                        TexelPipeline::Depth(pipelines.depth_downsample.get(key), accumulation.reduced_depth.clone()?)
                    }
                };
                Some(texel_pass("depth_downsample", pipeline, &inputs.depth_downsample))
            }),
            depth_copy: plan.depth_copy.and_then(|key| {
                let pipeline =
                    TexelPipeline::Depth(pipelines.depth_downsample.get(key), accumulation.depth_copy.clone()?);
                Some(texel_pass("depth_downsample", pipeline, &None))
            }),
            diffuse_bake: plan.diffuse_bake.map(|key| DiffuseBake {
                pipeline: pipelines.diffuse_bake.get(key),
                faces: baked_diffuse.faces.clone(),
                groups: groups.clone(),
            }),
            accumulate: match (plan.tiled, &pipelines.tiled) {
                (Some(keys), Some(tiled)) => {
                    let inputs = TiledInputs {
                        sprites: &sprites,
                        size,
                        attachments: &accumulation.attachments,
                        depth: accumulation.reduced_depth.as_ref().unwrap_or(&depth.depth),
                        workload: tiles.workload,
                    };
                    AccumulatePasses::Tiled(tiles.system.write(&gpu, tiled, keys, &groups, &inputs))
                }
                _ => AccumulatePasses::Raster(accumulate(plan.accumulate, &accumulation.attachments)),
            },
            overdraw: plan.overdraw.zip(accumulation.overdraw.as_ref()).map(|(key, layers)| accumulate(key, layers)),
            light_target: plan.light_target.and_then(|key| {
                let pipeline = match computed {
                    Some(tiled) => TexelPipeline::Compute(tiled.light_target.get(key)),
                    None => TexelPipeline::Color(pipelines.light_target.get(key), accumulation.lit.clone()?),
                };
                Some(texel_pass("light_target", pipeline, &inputs.light_target))
            }),
            depth_slopes: plan.depth_slopes.and_then(|key| {
                let pipeline = match computed {
                    Some(tiled) => TexelPipeline::Compute(tiled.depth_slopes.get(key)),
                    None => TexelPipeline::Color(pipelines.depth_slopes.get(key), accumulation.depth_slopes.clone()?),
                };
                Some(texel_pass("depth_slopes", pipeline, &inputs.depth_slopes))
            }),
            mark_cells: plan.mark_cells.and_then(|key| {
                let cells = [accumulation.smoke_cells.clone()?, accumulation.slope_cells.clone()?];
                let pipeline = TexelPipeline::Colors(pipelines.mark_cells.get(key), cells);
                let size = size.map(|side| side.div_ceil(CELL_SIDE));
                Some(TexelPass { size, ..texel_pass("mark_cells", pipeline, &inputs.mark_cells) })
            }),
            upsample_lit: plan.upsample_lit.zip(computed).map(|(key, tiled)| TexelPass {
                size: accumulation.pixels_in_use(size),
                ..texel_pass("upsample_lit", TexelPipeline::Compute(tiled.upsample_lit.get(key)), &inputs.upsample_lit)
            }),
            transfer: transfer_pass(pipelines, plan, &groups, inputs, setup),
            specular_scatter: plan.specular_scatter.filter(|_| lights > 0).map(|key| SpecularScatter {
                pipeline: pipelines.specular_scatter.get(key),
                groups: groups.clone(),
                inputs: inputs.upsampled.clone(),
                lights,
                is_in_transfer: plan.glows_in_transfer(),
            }),
            sprites: sprites.clone(),
        })
    }
}

fn transfer_pass(
    pipelines: &Pipelines,
    plan: &DeferredPlan<'_>,
    groups: &Groups,
    inputs: &TargetInputs,
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
        inputs: inputs.transfer.clone(),
        overdraw_inputs: inputs.overdraw.clone(),
        lit: plan.transfer_lit.map(|_| LitInputs {
            group: inputs.pixels.as_ref().unwrap_or(&inputs.upsampled).clone(),
            tiles: tile_counts(setup.rect.size, tile_side(setup.rect.scale)).element_product(),
        }),
    }
}
