//! Smoke among Bevy's transparent objects.

use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::core_3d::{Transparent3d, TransparentSortingInfo3d};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_phase::{
    Draw, DrawError, DrawFunctions, PhaseItem, PhaseItemExtraIndex, TrackedRenderPass, ViewSortedRenderPhases,
};
use bevy::render::render_resource::{CachedRenderPipelineId, PipelineCache, SpecializedRenderPipelines};
use bevy::render::view::{ExtractedView, Msaa, ViewUniformOffset};

use crate::composite::{CompositeKey, CompositePipeline, CompositePipelineId};
use crate::extract::{ExtractedSmoke, ExtractedSmokes};
use crate::gpu_asset::GpuSmoke;
use crate::renderers::{SmokeRenderers, ViewRenderer, smokes_in_view};
use crate::targets::draws_directly;

/// Draws the smoke of one entity, or the composite of all smoke.
pub(crate) struct DrawSmoke;

/// Adds an item for the smoke of each entity to the transparent phase of each view; in views that are composited, one item
/// at the depth of the nearest smoke.
pub(crate) fn queue_smoke(
    mut commands: Commands,
    smokes: Res<ExtractedSmokes>,
    presets: Res<RenderAssets<GpuSmoke>>,
    renderers: Res<SmokeRenderers>,
    draw_functions: Res<DrawFunctions<Transparent3d>>,
    mut phases: ResMut<ViewSortedRenderPhases<Transparent3d>>,
    cache: Res<PipelineCache>,
    pipeline: Res<CompositePipeline>,
    mut pipelines: ResMut<SpecializedRenderPipelines<CompositePipeline>>,
    views: Query<(
        Entity,
        &ExtractedView,
        &ExtractedCamera,
        &Msaa,
        Option<&RenderLayers>,
        Option<&Tonemapping>,
        Option<&DebandDither>,
    )>,
) {
    let Some(draw_function) = draw_functions.read().get_id::<DrawSmoke>() else { return };
    for (entity, view, camera, msaa, layers, tonemapping, dither) in &views {
        let Some(phase) = phases.get_mut(&view.retained_view_entity) else { continue };
        let renderer = renderers.get(entity);
        let rangefinder = view.rangefinder3d();
        let centers = smokes_in_view(&smokes, layers)
            .filter(|smoke| presets.get(smoke.asset).is_some())
            .map(|smoke| (smoke, center(smoke, view, renderer)));
        let mut add = |smoke: &ExtractedSmoke, center, pipeline| {
            phase.add_transient(Transparent3d {
                sorting_info: TransparentSortingInfo3d::Sorted { mesh_center: center, depth_bias: 0.0 },
                distance: 0.0,
                pipeline,
                // The view's entity makes the item's key differ from that of a mesh on the same entity.
                entity: (entity, smoke.entity),
                draw_function,
                batch_range: 0..1,
                extra_index: PhaseItemExtraIndex::None,
                indexed: false,
            });
        };
        if draws_directly(camera, tonemapping) {
            centers.for_each(|(smoke, center)| add(smoke, center, CachedRenderPipelineId::INVALID));
            continue;
        }
        let distance = |center: &Vec3| rangefinder.distance(center);
        let nearest = centers.max_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
        let Some((smoke, center)) = nearest else { continue };
        let key = CompositeKey {
            format: view.target_format,
            samples: msaa.samples(),
            tonemapping: tonemapping.copied().unwrap_or(Tonemapping::None),
            dither: dither.copied().unwrap_or(DebandDither::Disabled),
        };
        let pipeline = pipelines.specialize(&cache, &pipeline, key);
        commands.entity(entity).insert(CompositePipelineId(pipeline));
        add(smoke, center, pipeline);
    }
}

/// Point at the smoke's depth in the last frame, which haze measured; the entity's origin before the first frame.
fn center(smoke: &ExtractedSmoke, view: &ExtractedView, renderer: Option<&ViewRenderer>) -> Vec3 {
    let depth = renderer.and_then(|kept| kept.renderer.depth_of(*kept.drawn.get(&smoke.entity)?.last()?));
    match depth {
        Some(depth) => view.world_from_view.translation() + view.world_from_view.forward() * depth,
        None => smoke.origin,
    }
}

impl Draw<Transparent3d> for DrawSmoke {
    fn draw<'w>(
        &mut self,
        world: &'w World,
        pass: &mut TrackedRenderPass<'w>,
        view: Entity,
        item: &Transparent3d,
    ) -> Result<(), DrawError> {
        let Some(kept) = world.get_resource::<SmokeRenderers>().and_then(|renderers| renderers.get(view)) else {
            return Ok(());
        };
        if !kept.pass.composited {
            // Sets state that Bevy does not track; `wgpu_pass` makes it forget its own.
            for key in kept.drawn.get(&item.main_entity()).into_iter().flatten() {
                kept.renderer.render_system(pass.wgpu_pass(), *key);
            }
            return Ok(());
        }
        let cache = world.get_resource::<PipelineCache>();
        let pipeline = world.get::<CompositePipelineId>(view).and_then(|id| cache?.get_render_pipeline(id.0));
        let offset = world.get::<ViewUniformOffset>(view);
        if let (Some(composite), Some(pipeline), Some(offset)) = (&kept.composite, pipeline, offset) {
            pass.set_render_pipeline(pipeline);
            pass.set_bind_group(0, &composite.group, &[offset.offset]);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }
}
