//! Work of a view ahead of Bevy's transparent pass: copies the opaque depth, gathers lights and systems, and accumulates the
//! smoke. In views that are composited, draws its light too.

use bevy::camera::MainPassResolutionOverride;
use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::prelude::*;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::light::{AmbientLight, GlobalAmbientLight};
use bevy::log::error_once;
use bevy::math::{Vec2, Vec3};
use bevy::pbr::{ExtractedDirectionalLight, ExtractedPointLight, ViewLightEntities, ViewShadowBindings};
use bevy::render::camera::{ExtractedCamera, TemporalJitter};
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{
    CommandEncoder, LoadOp, Operations, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, StoreOp,
};
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::storage::GpuShaderBuffer;
use bevy::render::sync_world::MainEntity;
use bevy::render::view::{ExtractedView, Msaa, ViewDepthStencilTexture, ViewTarget};
use haze::{FrameInput, MAX_LIGHTS, PrepareError, SceneDepth, View, glam, wgpu};

use crate::composite::CompositeResources;
use crate::convert;
use crate::environment::{ExtractedEnvironments, HemisphereLight};
use crate::extract::ExtractedSmokes;
use crate::gpu_asset::GpuSmoke;
use crate::lights::{ambient_light, scene_lights};
use crate::map_light::MapLights;
use crate::renderers::{PassFormat, SmokeRenderers, ViewRenderer, smokes_in_view};
use crate::shadow_maps::{LightShadow, ShadowViews};
use crate::targets::{LIGHT_FORMAT, LightTarget, SmokeTargets, draws_directly};
use crate::view_system::{ViewSystem, fire_light, view_systems};

/// Camera in the render world.
#[derive(QueryData)]
pub(crate) struct CameraView {
    camera_entity: &'static MainEntity,
    camera: &'static ExtractedCamera,
    view: &'static ExtractedView,
    target: &'static ViewTarget,
    depth: &'static ViewDepthStencilTexture,
    msaa: &'static Msaa,
    targets: &'static SmokeTargets,
    tonemapping: Option<&'static Tonemapping>,
    layers: Option<&'static RenderLayers>,
    jitter: Option<&'static TemporalJitter>,
    resolution: Option<&'static MainPassResolutionOverride>,
    ambient: Option<&'static AmbientLight>,
    shadows: Option<(&'static ViewLightEntities, &'static ViewShadowBindings)>,
}

/// Lights of the scene.
#[derive(SystemParam)]
pub(crate) struct LightSources<'w, 's> {
    points: Query<'w, 's, (Entity, &'static ExtractedPointLight, Option<&'static RenderLayers>)>,
    suns: Query<'w, 's, (Entity, &'static ExtractedDirectionalLight, Option<&'static RenderLayers>)>,
    ambient: Option<Res<'w, GlobalAmbientLight>>,
    environments: Res<'w, ExtractedEnvironments>,
    maps: Res<'w, MapLights>,
    shadow_views: ShadowViews<'w, 's>,
}

/// Lights of a frame, and the shadow maps of some of them.
struct FrameLights<'a> {
    lights: Vec<haze::Light>,
    shadows: Vec<LightShadow<'a>>,
}

/// Records the work of a view.
pub(crate) fn prepare_smoke(
    view: ViewQuery<CameraView>,
    smokes: Res<ExtractedSmokes>,
    presets: Res<RenderAssets<GpuSmoke>>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    sources: LightSources,
    composites: CompositeResources,
    mut renderers: ResMut<SmokeRenderers>,
    mut context: RenderContext,
) {
    let entity = view.entity();
    let view = view.into_inner();
    let systems: Vec<_> = smokes_in_view(&smokes, view.layers)
        .filter_map(|smoke| Some((smoke, presets.get(smoke.asset)?)))
        .flat_map(|(smoke, preset)| view_systems(smoke, preset, &buffers, sources.ambient_at(smoke.origin, &view)))
        .collect();
    if systems.is_empty() {
        renderers.clear_drawn(entity);
        return;
    }
    let kept = match renderers.ensure(entity, pass_format(&view)) {
        Ok(kept) => kept,
        Err(error) => {
            error_once!("smoke in camera {}: {error}", view.camera_entity.id());
            return;
        }
    };

    let recorder = context.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = context.command_encoder();
    let span = recorder.time_span(encoder, "smoke");
    let frame_lights = sources.of_frame(&view, &systems);
    let shadow_maps: Vec<_> = frame_lights.shadows.iter().map(LightShadow::map).collect();
    let shading = systems.iter().find(|system| system.shades_meshes());
    let shades_meshes = shading.is_some();
    let frame = FrameInput {
        scene_ambient: shading.map(ViewSystem::mean_ambient),
        lights: &frame_lights.lights,
        shadow_maps: &shadow_maps,
        time: smokes.seconds,
        ..FrameInput::new(haze_view(&view), read_depth(&view, encoder))
    };
    prepare_systems(kept, *view.camera_entity, encoder, &frame, systems);
    if shades_meshes {
        shade_meshes(kept, encoder, view.target, view.depth);
    }
    kept.composite = view.targets.light.as_ref().and_then(|light| {
        draw_light(kept, encoder, light, view.depth);
        let tonemapping = view.tonemapping.copied().unwrap_or(Tonemapping::None);
        composites.bind(kept.composite.take(), light, &tonemapping)
    });
    span.end(encoder);
}

impl LightSources<'_, '_> {
    /// Exposed ambient light and light of environment maps at a point.
    fn ambient_at(&self, point: Vec3, view: &CameraViewItem<'_, '_>) -> HemisphereLight {
        let global = self.ambient.as_deref().cloned().unwrap_or_default();
        let even = HemisphereLight::even(ambient_light(view.ambient, &global));
        let of_map = |map, up| Some(self.maps.get(map)?.hemispheres(up));
        let maps = self.environments.light_at(point, *view.camera_entity, view.layers, of_map);
        even.plus(maps, 1.0).scaled(view.camera.exposure)
    }

    /// Lights of fires, which are not exposed, and those of the scene.
    fn of_frame<'a>(&self, view: &CameraViewItem<'a, '_>, systems: &[ViewSystem<'_>]) -> FrameLights<'a> {
        let origins: Vec<_> = systems.iter().map(|system| system.smoke.origin).collect();
        let mut lights: Vec<_> = systems.iter().filter_map(fire_light).take(MAX_LIGHTS).collect();
        let layers = view.layers.unwrap_or_default();
        let mut scene = scene_lights(&self.points, &self.suns, layers, view.camera.exposure, &origins);
        scene.truncate(MAX_LIGHTS - lights.len());
        let is_shaded =
            systems.iter().any(|system| system.settings.receives_shadow_by_depth() || system.shades_meshes());
        let shadows = match (view.shadows.filter(|_| is_shaded), origins.first()) {
            (Some((view_lights, bindings)), Some(origin)) => {
                self.shadow_views.maps(&scene, lights.len(), view_lights, bindings, *origin)
            }
            _ => Vec::new(),
        };
        lights.extend(scene.iter().map(|scene| scene.light));
        FrameLights { lights, shadows }
    }
}

/// Depth that haze reads: a copy, because Bevy's pass is attached to the original, or the multisampled original, which haze
/// resolves first.
fn read_depth<'a>(view: &CameraViewItem<'a, '_>, encoder: &mut CommandEncoder) -> SceneDepth<'a> {
    match &view.targets.depth_copy {
        Some(copy) => {
            let size = copy.texture.size();
            encoder.copy_texture_to_texture(view.depth.texture().as_image_copy(), copy.texture.as_image_copy(), size);
            SceneDepth::Buffer(&copy.default_view)
        }
        None => SceneDepth::Multisampled(&view.depth.attachment.texture.default_view),
    }
}

fn pass_format(view: &CameraViewItem<'_, '_>) -> PassFormat {
    let direct = draws_directly(view.camera, view.tonemapping);
    PassFormat {
        color: if direct { view.target.main_texture_format() } else { LIGHT_FORMAT },
        depth: view.depth.texture().format(),
        samples: view.msaa.samples(),
        scene_color: view.target.main_texture_format(),
        composited: !direct,
    }
}

fn haze_view(camera: &CameraViewItem<'_, '_>) -> View {
    let view = camera.view;
    let [x, y, width, height] = view.viewport.to_array();
    let size = match camera.resolution {
        Some(size) => glam::UVec2::from_array(size.0.to_array()),
        None => glam::UVec2::new(width, height),
    };
    let mut clip_from_view = view.clip_from_view;
    if let Some(jitter) = camera.jitter {
        jitter.jitter_projection(&mut clip_from_view, Vec2::new(width as f32, height as f32));
    }
    let (view_from_world, clip_from_view) = convert::rigid_view(view.world_from_view.affine(), clip_from_view);
    View {
        origin: glam::UVec2::new(x, y),
        ..View::new(convert::mat4(view_from_world), convert::mat4(clip_from_view), size)
    }
}

/// Prepares the renderer. Leaves out systems that haze refuses, and logs why.
fn prepare_systems(
    kept: &mut ViewRenderer,
    camera: MainEntity,
    encoder: &mut CommandEncoder,
    frame: &FrameInput<'_>,
    mut systems: Vec<ViewSystem<'_>>,
) {
    kept.drawn.values_mut().for_each(Vec::clear);
    let mut is_complete = true;
    loop {
        let inputs: Vec<_> = systems.iter().map(ViewSystem::input).collect();
        let Err(error) = kept.renderer.prepare(encoder, &FrameInput { systems: &inputs, ..*frame }) else { break };
        kept.report(camera, &error);
        is_complete = false;
        match refused_system(&error).filter(|index| *index < systems.len()) {
            Some(index) => drop(systems.remove(index)),
            None => return,
        }
    }
    if is_complete {
        kept.report_success();
    }
    for system in &systems {
        if kept.renderer.depth_of(system.key).is_some() {
            kept.drawn.entry(system.smoke.entity).or_default().push(system.key);
        }
    }
    kept.drawn.retain(|_, keys| !keys.is_empty());
    let depth = |key: &u64| kept.renderer.depth_of(*key).unwrap_or(0.0);
    kept.drawn.values_mut().for_each(|keys| keys.sort_by(|a, b| depth(b).total_cmp(&depth(a))));
}

/// Index of the system that an error is about: its field is `systems[INDEX].…`.
fn refused_system(error: &PrepareError) -> Option<usize> {
    let PrepareError::Field(error) = error else { return None };
    error.field.strip_prefix("systems[")?.split(']').next()?.parse().ok()
}

/// Draws the light of the smoke into its own target, tested by the view's depth.
fn draw_light(kept: &ViewRenderer, encoder: &mut CommandEncoder, light: &LightTarget, depth: &ViewDepthStencilTexture) {
    let resolve_target = light.resolved.as_ref().map(|resolved| &*resolved.default_view);
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("smoke_light"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &light.color.default_view,
            depth_slice: None,
            resolve_target,
            ops: Operations {
                load: LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: if resolve_target.is_some() { StoreOp::Discard } else { StoreOp::Store },
            },
        })],
        depth_stencil_attachment: Some(read_only(depth)),
        ..Default::default()
    });
    kept.renderer.render(&mut pass);
}

/// Darkens what Bevy has drawn by the shadow of the smoke.
fn shade_meshes(
    kept: &ViewRenderer,
    encoder: &mut CommandEncoder,
    target: &ViewTarget,
    depth: &ViewDepthStencilTexture,
) {
    let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
        label: Some("smoke_shadow"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(read_only(depth)),
        ..Default::default()
    });
    kept.renderer.render_scene_shadow(&mut pass);
}

/// The view's depth, to test and to sample in one pass.
fn read_only(depth: &ViewDepthStencilTexture) -> RenderPassDepthStencilAttachment<'_> {
    let view = &depth.attachment.texture.default_view;
    RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None }
}

#[cfg(test)]
mod tests {
    use haze::FieldError;

    use super::*;

    #[test]
    fn errors_name_their_system() {
        let error = |field: &str| PrepareError::Field(FieldError::new(field, 1, "another"));
        assert_eq!(refused_system(&error("systems[12].settings.path")), Some(12));
        assert_eq!(refused_system(&error("lights[1].range")), None);
    }
}
