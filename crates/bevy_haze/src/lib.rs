//! Smoke for Bevy by [haze]: accumulated as normals and amounts into a small target, and lit once per pixel by Bevy's lights.
//! It is soft where it meets meshes, hidden by them, and sorted among transparent objects.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_haze::{Smoke, SmokePlugin};
//!
//! fn main() {
//!     App::new().add_plugins((DefaultPlugins, SmokePlugin)).add_systems(Startup, setup).run();
//! }
//!
//! fn setup(mut commands: Commands, assets: Res<AssetServer>) {
//!     commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 2.0, 8.0)));
//!     commands.spawn((PointLight::default(), Transform::from_xyz(-3.0, 3.0, 2.0)));
//!     commands.spawn((Smoke::from(assets.load("column.smoke.json")), Transform::from_xyz(0.0, 0.5, 0.0)));
//! }
//! ```
//!
//! # A frame
//! ```text
//! PreUpdate         advance_clocks
//! PostUpdate        animate_smoke          keyframes and flicker at the time of each clock
//!                   update_fire_lights
//! ExtractSchedule   extract_smoke          entities with Smoke ─► render world
//!                   extract_environments   environment maps, reflection probes
//! Queue             queue_smoke            an item for each entity in each view's transparent phase
//! PrepareResources  measure_maps           light of environment maps from above and below, read some frames later
//!                   prepare_targets        copy of the depth; light of the smoke, for views without Hdr
//! Core3d            opaque and transmissive passes (Bevy)
//!                   prepare_smoke          depth copy, lights, accumulation (haze's `prepare`)
//!                   transparent pass (Bevy): DrawSmoke lights each pixel (haze's `render_system`), or composites
//! ```
//!
//! # Units
//! Metres and seconds. Lights are in Bevy's units, multiplied by the camera's exposure: white smoke is as bright as a white
//! matte surface beside it. Light that belongs to the preset (fire and soft scatter) is not exposed, like
//! [`StandardMaterial::emissive`](bevy::pbr::StandardMaterial::emissive) with its default exposure weight.

mod animation;
mod asset;
mod component;
mod composite;
mod convert;
mod environment;
mod extract;
mod fire_light;
mod gpu_asset;
mod lights;
mod map_light;
mod prepare;
mod queue;
mod renderers;
mod shadow_maps;
mod targets;
mod view_system;

pub use asset::{SmokeAsset, SmokeAssetError, SmokeSystem};
pub use component::{Smoke, SmokeBuffer, SmokeClock, SmokeParticle, SmokeParticles};
pub use fire_light::SmokeFireLight;
pub use haze;

use bevy::asset::{AssetEventSystems, embedded_asset};
use bevy::core_pipeline::core_3d::{
    Transparent3d, main_opaque_pass_3d, main_transparent_pass_3d, prepare_core_3d_depth_textures,
};
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{PbrPlugin, main_transmissive_pass_3d};
use bevy::prelude::*;
use bevy::render::render_asset::RenderAssetPlugin;
use bevy::render::render_phase::DrawFunctions;
use bevy::render::render_resource::SpecializedRenderPipelines;
use bevy::render::{ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderSystems};

use composite::CompositePipeline;
use environment::ExtractedEnvironments;
use extract::ExtractedSmokes;
use gpu_asset::GpuSmoke;
use map_light::MapLights;
use renderers::SmokeRenderers;

/// Draws entities with [`Smoke`] in every 3D camera. Add it after `DefaultPlugins`; without them, it logs an error and does
/// nothing. Without a graphics device or `PbrPlugin`, assets load and clocks run, and nothing is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct SmokePlugin;

impl Plugin for SmokePlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<AssetPlugin>() {
            error!("SmokePlugin comes before AssetPlugin, or without it; expected (DefaultPlugins, SmokePlugin)");
            return;
        }
        embedded_asset!(app, "composite.wesl");
        app.init_asset::<SmokeAsset>()
            .init_asset_loader::<asset::SmokeLoader>()
            .register_type::<SmokeClock>()
            .register_type::<SmokeFireLight>()
            .add_plugins(RenderAssetPlugin::<GpuSmoke>::default())
            .add_systems(PreUpdate, component::advance_clocks.run_if(resource_exists::<Time>))
            .add_systems(
                PostUpdate,
                (
                    component::animate_smoke.after(AssetEventSystems),
                    fire_light::update_fire_lights.before(TransformSystems::Propagate),
                )
                    .chain(),
            );
        if !app.is_plugin_added::<PbrPlugin>() {
            return;
        }
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else { return };
        render_app
            .init_resource::<ExtractedSmokes>()
            .init_resource::<SpecializedRenderPipelines<CompositePipeline>>()
            .init_resource::<ExtractedEnvironments>()
            .init_gpu_resource::<SmokeRenderers>()
            .init_gpu_resource::<MapLights>()
            .init_gpu_resource::<CompositePipeline>()
            .add_systems(ExtractSchedule, (extract::extract_smoke, environment::extract_environments))
            .add_systems(
                Render,
                (
                    queue::queue_smoke.in_set(RenderSystems::Queue),
                    targets::allow_depth_reads
                        .in_set(RenderSystems::PrepareResources)
                        .before(prepare_core_3d_depth_textures),
                    map_light::measure_maps.in_set(RenderSystems::PrepareResources),
                    targets::prepare_targets.in_set(RenderSystems::PrepareResources),
                    renderers::drop_renderers.in_set(RenderSystems::Cleanup),
                ),
            )
            .add_systems(
                Core3d,
                prepare::prepare_smoke
                    .after(main_opaque_pass_3d)
                    .after(main_transmissive_pass_3d)
                    .before(main_transparent_pass_3d)
                    .in_set(Core3dSystems::MainPass),
            );
        if let Some(draw_functions) = render_app.world().get_resource::<DrawFunctions<Transparent3d>>() {
            draw_functions.write().add(queue::DrawSmoke);
        }
    }
}

/// Compiles the code in the README as a test.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../README.md")]
    struct Readme;
}
