//! Copies of the smoke in the render world.

use std::sync::Arc;

use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::prelude::{GlobalTransform, InheritedVisibility, Time, warn_once};
use bevy::render::Extract;
use bevy::render::sync_world::MainEntity;
use haze::Particle;

use crate::asset::SmokeAsset;
use crate::component::{Smoke, SmokeClock, SmokeParticles};
use crate::convert;

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
    /// Particles in place of the emitter's.
    pub particles: Option<Arc<Vec<Particle>>>,
}

pub(crate) fn extract_smoke(
    mut extracted: ResMut<ExtractedSmokes>,
    time: Extract<Res<Time>>,
    smokes: Extract<
        Query<(
            Entity,
            &Smoke,
            &SmokeClock,
            &GlobalTransform,
            &InheritedVisibility,
            Option<&RenderLayers>,
            Option<&SmokeParticles>,
        )>,
    >,
) {
    extracted.seconds = time.elapsed_secs_f64();
    extracted.smokes.clear();
    for (entity, smoke, clock, transform, visibility, layers, particles) in &smokes {
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
            particles: particles.map(|particles| particles.0.clone()),
        });
    }
}
