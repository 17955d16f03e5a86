//! Environment maps as light from above and below.
//!
//! The map of a point is that of the reflection probes around it, and the camera's for the rest of their weight, as Bevy
//! mixes them. A diffuse map holds the light E(n) of a white matte surface with the normal n. Haze's ambient light is even
//! in each hemisphere: E(n) = mean + slope · n of the vertical axis alone. Means of the map are the closest such light (least
//! squares over all normals); light that comes from one side is shared by both hemispheres.

use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::prelude::*;
use bevy::image::Image;
use bevy::light::{EnvironmentMapLight, GeneratedEnvironmentMapLight, LightProbe};
use bevy::math::{Affine3A, Vec3};
use bevy::prelude::{AssetEvent, GlobalTransform, InheritedVisibility, MessageReader};
use bevy::render::Extract;
use bevy::render::sync_world::MainEntity;

/// Light of the hemispheres above and below, as a white matte surface that faces them shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HemisphereLight {
    pub sky: Vec3,
    pub ground: Vec3,
}

impl HemisphereLight {
    /// The same light from all sides.
    pub fn even(light: Vec3) -> Self {
        Self { sky: light, ground: light }
    }

    pub fn plus(self, other: Self, weight: f32) -> Self {
        Self { sky: self.sky + other.sky * weight, ground: self.ground + other.ground * weight }
    }

    pub fn scaled(self, factor: f32) -> Self {
        Self::default().plus(self, factor)
    }
}

/// Environment maps of this frame.
#[derive(Resource, Default)]
pub(crate) struct ExtractedEnvironments {
    pub environments: Vec<ExtractedEnvironment>,
    /// Images that have changed since the last frame.
    pub changed: Vec<AssetId<Image>>,
}

/// Environment map of a camera or of a reflection probe.
pub(crate) struct ExtractedEnvironment {
    entity: MainEntity,
    /// Diffuse map.
    pub map: AssetId<Image>,
    /// True if Bevy fills the map on the GPU, maybe in every frame.
    pub is_generated: bool,
    /// cd/m² for a value of 1 in the map.
    intensity: f32,
    /// Direction in the map of the world's upward direction.
    up: Vec3,
    probe: Option<Probe>,
    layers: RenderLayers,
}

/// Box in which a reflection probe lights.
struct Probe {
    /// To a cube from −0.5 to 0.5.
    probe_from_world: Affine3A,
    falloff: Vec3,
}

impl Probe {
    /// Weight at a point of the world, 0 to 1. Formula: `light_probe.wesl` of `bevy_pbr`.
    fn weight(&self, point: Vec3) -> f32 {
        let position = self.probe_from_world.transform_point3(point);
        let falloff = self.falloff.max(Vec3::splat(1.0e-4));
        let weight = ((Vec3::ONE - 2.0 * position.abs()) / (2.0 * falloff)).min_element().clamp(0.0, 1.0);
        if weight.is_finite() { weight } else { 0.0 }
    }
}

pub(crate) fn extract_environments(
    mut extracted: ResMut<ExtractedEnvironments>,
    environments: Extract<
        Query<(
            Entity,
            &EnvironmentMapLight,
            Option<&LightProbe>,
            Option<&GlobalTransform>,
            Option<&InheritedVisibility>,
            Option<&RenderLayers>,
            Has<GeneratedEnvironmentMapLight>,
        )>,
    >,
    mut images: Extract<MessageReader<AssetEvent<Image>>>,
) {
    extracted.changed.clear();
    extracted.changed.extend(images.read().filter_map(|event| match event {
        AssetEvent::Modified { id } => Some(*id),
        _ => None,
    }));
    extracted.environments.clear();
    for (entity, light, probe, transform, visibility, layers, is_generated) in &environments {
        if probe.is_some() && visibility.is_some_and(|visibility| !visibility.get()) {
            continue;
        }
        let map_from_world = match (probe, transform) {
            (Some(_), Some(transform)) => (transform.affine() * Affine3A::from_quat(light.rotation)).inverse(),
            _ => Affine3A::from_quat(light.rotation.inverse()),
        };
        extracted.environments.push(ExtractedEnvironment {
            entity: entity.into(),
            map: light.diffuse_map.id(),
            is_generated,
            intensity: if light.intensity.is_finite() { light.intensity.max(0.0) } else { 0.0 },
            up: map_from_world.transform_vector3(Vec3::Y).normalize_or_zero(),
            probe: probe.map(|probe| Probe { probe_from_world: map_from_world, falloff: probe.falloff }),
            layers: layers.cloned().unwrap_or_default(),
        });
    }
}

impl ExtractedEnvironments {
    /// Light of the maps on smoke at a point, cd/m². `of_map` returns the light of a map whose upward direction is given, in units
    /// of its texels, or `None` if it has not been measured yet: it is dark then.
    pub fn light_at(
        &self,
        point: Vec3,
        camera: MainEntity,
        layers: Option<&RenderLayers>,
        of_map: impl Fn(AssetId<Image>, Vec3) -> Option<HemisphereLight>,
    ) -> HemisphereLight {
        let layers = layers.unwrap_or_default();
        let light = |environment: &ExtractedEnvironment| {
            Some(of_map(environment.map, environment.up)?.scaled(environment.intensity))
        };
        let mut sum = HemisphereLight::default();
        let mut total = 0.0;
        for environment in self.environments.iter().filter(|environment| environment.layers.intersects(layers)) {
            let weight = environment.probe.as_ref().map_or(0.0, |probe| probe.weight(point));
            if weight > 0.0
                && let Some(light) = light(environment)
            {
                sum = sum.plus(light, weight);
                total += weight;
            }
        }
        let of_camera =
            |environment: &&ExtractedEnvironment| environment.entity == camera && environment.probe.is_none();
        if total < 1.0
            && let Some(light) = self.environments.iter().find(of_camera).and_then(light)
        {
            sum = sum.plus(light, 1.0 - total);
            total = 1.0;
        }
        if total > 0.0 { sum.scaled(1.0 / total) } else { sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_fades_towards_its_faces_and_ends_there() {
        let transform = Affine3A::from_scale(Vec3::new(4.0, 2.0, 2.0));
        let probe = Probe { probe_from_world: transform.inverse(), falloff: Vec3::splat(0.25) };
        let weights = [0.0, 0.9, 1.5, 1.9, 2.1].map(|x| probe.weight(Vec3::new(x, 0.0, 0.0)));
        for (weight, expected) in weights.into_iter().zip([1.0, 1.0, 0.5, 0.1, 0.0]) {
            assert!((weight - expected).abs() < 1e-5, "{weights:?}");
        }
        assert!(probe.weight(Vec3::NAN).abs() < 1e-5);
    }
}
