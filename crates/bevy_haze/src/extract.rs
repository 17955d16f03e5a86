//! Copies of the smoke in the render world.

use std::sync::Arc;

use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::prelude::*;
use bevy::light::NotShadowCaster;
use bevy::math::Vec3;
use bevy::prelude::{ChildOf, GlobalTransform, InheritedVisibility, Time, warn_once};
use bevy::render::Extract;
use bevy::render::storage::ShaderBuffer;
use bevy::render::sync_world::MainEntity;
use haze::{Bounds, Particle};

use crate::animation::{SmokeAnimation, SystemState};
use crate::asset::SmokeAsset;
use crate::component::{Smoke, SmokeBuffer, SmokeClock, SmokeParticles};
use crate::convert;
use crate::fire_light::SmokeFireLight;

/// Visible smoke of this frame.
#[derive(Resource, Default)]
pub(crate) struct ExtractedSmokes {
    pub smokes: Vec<ExtractedSmoke>,
    /// Bevy's virtual time, seconds. It moves the noise of volumetric sprites.
    pub seconds: f64,
}

/// One entity with [`Smoke`].
pub(crate) struct ExtractedSmoke {
    pub entity: MainEntity,
    pub asset: AssetId<SmokeAsset>,
    pub world_from_smoke: haze::glam::Mat4,
    pub origin: Vec3,
    pub layers: RenderLayers,
    pub seconds: f64,
    /// Systems at this time; none if the preset has neither keyframes nor flicker.
    pub systems: Vec<SystemState>,
    pub source: Source,
    /// True if its fire is a light of the scene.
    pub has_fire_light: bool,
    /// True if its shadow falls on meshes.
    pub shades_meshes: bool,
}

/// Source of the particles of an entity's smoke.
pub(crate) enum Source {
    /// The emitters of the preset.
    Preset,
    Particles(Arc<Vec<Particle>>),
    Buffer {
        buffer: AssetId<ShaderBuffer>,
        count: u32,
        bounds: Bounds,
    },
}

pub(crate) fn extract_smoke(
    mut extracted: ResMut<ExtractedSmokes>,
    time: Extract<Res<Time>>,
    smokes: Extract<
        Query<(
            Entity,
            &Smoke,
            (&SmokeClock, &SmokeAnimation),
            &GlobalTransform,
            &InheritedVisibility,
            Option<&RenderLayers>,
            Option<&SmokeParticles>,
            Option<&SmokeBuffer>,
            Has<NotShadowCaster>,
        )>,
    >,
    fire_lights: Extract<Query<&ChildOf, With<SmokeFireLight>>>,
) {
    extracted.seconds = time.elapsed_secs_f64();
    extracted.smokes.clear();
    let burning: Vec<_> = fire_lights.iter().map(ChildOf::parent).collect();
    for (entity, smoke, (clock, animation), transform, visibility, layers, particles, buffer, is_shadowless) in &smokes
    {
        if !visibility.get() {
            continue;
        }
        let Some((world_from_smoke, changed)) = convert::placement(transform.affine()) else { continue };
        if changed {
            warn_once!("{entity}: the scale of smoke differs between axes; its geometric mean is used");
        }
        extracted.smokes.push(ExtractedSmoke {
            entity: entity.into(),
            asset: smoke.id(),
            world_from_smoke,
            origin: transform.translation(),
            layers: layers.cloned().unwrap_or_default(),
            seconds: clock.seconds,
            systems: animation.systems().to_vec(),
            source: match (particles, buffer) {
                (Some(particles), _) => Source::Particles(particles.0.clone()),
                (None, Some(SmokeBuffer { buffer, count, bounds })) => {
                    let [min, max] = [bounds.min(), bounds.max()].map(|corner| convert::vec3(corner.into()));
                    Source::Buffer { buffer: buffer.id(), count: *count, bounds: Bounds { min, max } }
                }
                (None, None) => Source::Preset,
            },
            has_fire_light: burning.contains(&entity),
            shades_meshes: !is_shadowless,
        });
    }
}
