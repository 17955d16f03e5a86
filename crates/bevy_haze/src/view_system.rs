//! Particle systems of the entities in a view, as haze takes them.

use bevy::render::render_asset::RenderAssets;
use bevy::render::storage::GpuShaderBuffer;
use haze::fire::FireLight;
use haze::settings::Shadow;
use haze::{EmitterSnapshot, ParticleBuffer, ParticleSystem, Particles, Settings, glam, wgpu};

use crate::animation::SystemState;
use crate::environment::HemisphereLight;
use crate::extract::{ExtractedSmoke, Source};
use crate::gpu_asset::{GpuSmoke, GpuSystem};
use crate::lights::{MAX_INTENSITY, MAX_POSITION, MAX_RADIUS, haze_ambient};
use crate::renderers::system_key;

/// One particle system of one entity.
pub(crate) struct ViewSystem<'a> {
    pub smoke: &'a ExtractedSmoke,
    system: &'a GpuSystem,
    pub key: u64,
    /// Emitter at the entity's time; not used if the entity has particles of its own.
    snapshot: EmitterSnapshot,
    /// Particles on the GPU.
    buffer: Option<&'a wgpu::Buffer>,
    /// With the scene's ambient light.
    pub settings: Settings,
}

/// Systems of an entity. Particles of its own replace the emitter of the first and hide the others; a buffer that is not
/// there yet shows nothing. `ambient`: exposed light at the entity.
pub(crate) fn view_systems<'a>(
    smoke: &'a ExtractedSmoke,
    preset: &'a GpuSmoke,
    buffers: &'a RenderAssets<GpuShaderBuffer>,
    ambient: HemisphereLight,
) -> impl Iterator<Item = ViewSystem<'a>> {
    let (count, buffer) = match &smoke.source {
        Source::Preset => (preset.systems.len(), None),
        Source::Particles(_) => (1, None),
        Source::Buffer { buffer, .. } => {
            let buffer: Option<&wgpu::Buffer> = buffers.get(*buffer).map(|buffer| &*buffer.buffer);
            (usize::from(buffer.is_some()), buffer)
        }
    };
    preset.systems.iter().take(count).enumerate().map(move |(index, system)| {
        let state = SystemState::find(&smoke.systems, index, &system.preset, smoke.seconds);
        let SystemState { snapshot, settings } = state;
        let scene = if smoke.shades_meshes { settings.shadow.scene } else { 0.0 };
        let shadow = Shadow { scene, ..settings.shadow };
        ViewSystem {
            smoke,
            system,
            key: system_key(smoke.entity, index),
            snapshot,
            buffer,
            settings: Settings { ambient: haze_ambient(ambient), shadow, ..settings },
        }
    })
}

impl ViewSystem<'_> {
    /// True if its shadow falls on meshes.
    pub fn shades_meshes(&self) -> bool {
        self.settings.receives_shadow() && self.settings.shadow.scene > 0.0
    }

    /// Ambient light, averaged over all directions.
    pub fn mean_ambient(&self) -> glam::Vec3 {
        let ambient = self.settings.ambient;
        0.5 * (ambient.sky_color + ambient.ground_color)
    }

    /// The system as haze takes it.
    pub fn input(&self) -> ParticleSystem<'_, '_> {
        let (particles, bounds) = match (&self.smoke.source, self.buffer) {
            (Source::Particles(particles), _) => (Particles::Slice(particles), None),
            (Source::Buffer { count, bounds, .. }, Some(buffer)) => {
                (Particles::Buffer(ParticleBuffer::new(buffer, *count)), Some(*bounds))
            }
            _ => (Particles::Emitter(&self.snapshot), None),
        };
        ParticleSystem {
            world_from_particles: self.smoke.world_from_smoke,
            bounds,
            ..ParticleSystem::new(self.key, particles, &self.settings, &self.system.material)
        }
    }
}

/// Light that the fire of a system casts on smoke, unless it is a light of the scene.
pub(crate) fn fire_light(system: &ViewSystem<'_>) -> Option<haze::Light> {
    if !system.settings.burns() || system.smoke.has_fire_light {
        return None;
    }
    let ViewSystem { smoke, settings, .. } = system;
    let mut sample = Vec::new();
    let (particles, step) = match &smoke.source {
        Source::Particles(particles) => (particles.as_slice(), 1),
        Source::Preset => {
            system.snapshot.sample(&mut sample);
            (sample.as_slice(), system.snapshot.step)
        }
        // The CPU cannot see these.
        Source::Buffer { .. } => return None,
    };
    let seed = system.key as u32;
    let fire = FireLight {
        particles,
        particles_per_sample: step,
        settings,
        assets: &system.system.images,
        time: smoke.seconds,
        seed,
    };
    let light = fire.estimate()?;
    let scale = smoke.world_from_smoke.x_axis.length();
    let position = smoke.world_from_smoke.transform_point3(light.position);
    (position.abs().max_element() <= MAX_POSITION).then(|| haze::Light {
        position,
        intensity: (light.intensity * scale * scale).min(MAX_INTENSITY),
        range: (light.range * scale).max(0.01),
        radius: (light.radius * scale).min(MAX_RADIUS),
        ..light
    })
}
