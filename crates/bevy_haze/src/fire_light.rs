//! Light of burning smoke, as a point light of the scene.

use std::f32::consts::PI;

use bevy::camera::Exposure;
use bevy::prelude::*;
use haze::fire::FireLight;

use crate::animation::{SmokeAnimation, SystemState};
use crate::asset::{SmokeAsset, SmokeSystem};
use crate::component::{Smoke, SmokeClock, SmokeParticles};

/// Point light that follows the fire of the smoke on its parent entity: its position, color, brightness and flicker. It lights
/// meshes and smoke; without it, a fire lights smoke alone.
///
/// The plugin sets color, intensity, range and radius of the [`PointLight`] and the translation of the [`Transform`]; all
/// else is the program's, such as shadow maps. Smoke that does not burn, or whose particles are in a
/// [`SmokeBuffer`](crate::SmokeBuffer), makes no light.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_haze::{Smoke, SmokeFireLight};
/// # fn setup(mut commands: Commands, assets: Res<AssetServer>) {
/// commands.spawn((Smoke::from(assets.load("campfire.smoke.json")), children![SmokeFireLight::default()]));
/// # }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone)]
#[require(PointLight, Transform)]
pub struct SmokeFireLight {
    /// Exposure of the camera for which the fire is as bright as its preset says, EV100. A fire has no brightness of its own:
    /// flames look alike at every exposure. Lower: less light on the scene, for the same flames. Default: Bevy's, 9.7.
    pub ev100: f32,
}

impl Default for SmokeFireLight {
    fn default() -> Self {
        Self { ev100: Exposure::default().ev100 }
    }
}

pub(crate) fn update_fire_lights(
    assets: Res<Assets<SmokeAsset>>,
    smokes: Query<(&Smoke, &SmokeClock, &SmokeAnimation, &GlobalTransform, Option<&SmokeParticles>)>,
    mut lights: Query<(Entity, &SmokeFireLight, &ChildOf, &mut PointLight, &mut Transform)>,
    mut sample: Local<Vec<haze::Particle>>,
) {
    for (entity, fire, parent, mut light, mut transform) in &mut lights {
        let smoke = smokes.get(parent.parent()).ok();
        let lit = smoke.and_then(|(smoke, clock, animation, placement, particles)| {
            let systems = &assets.get(smoke.id())?.systems;
            let seed = entity.index_u32();
            let of_system = |(index, system): (usize, &SmokeSystem)| {
                let state = SystemState::find(animation.systems(), index, &system.preset, clock.seconds);
                system_light(&state, &system.images, particles, clock.seconds, seed, &mut sample)
            };
            let lights = systems.iter().enumerate().filter_map(of_system);
            let brightest = lights.max_by(|a, b| a.intensity.total_cmp(&b.intensity))?;
            Some((brightest, placement.scale().element_product().abs().cbrt()))
        });
        let Some((fire_light, scale)) = lit else {
            // Does not wake change detection each frame.
            light.map_unchanged(|light| &mut light.intensity).set_if_neq(0.0);
            continue;
        };
        let haze::Light { position, color, intensity, range, radius, .. } = fire_light;
        // The reverse of what the plugin does with a lamp: Φ = 4π² I / exposure.
        let exposure = Exposure { ev100: fire.ev100 }.exposure();
        light.intensity = 4.0 * PI * PI * intensity * scale * scale / exposure;
        light.color = Color::linear_rgb(color.x, color.y, color.z);
        light.range = range * scale;
        light.radius = radius * scale;
        transform.translation = Vec3::from_array(position.to_array());
    }
}

fn system_light(
    SystemState { snapshot, settings }: &SystemState,
    images: &haze::MaterialAssets,
    particles: Option<&SmokeParticles>,
    time: f64,
    seed: u32,
    sample: &mut Vec<haze::Particle>,
) -> Option<haze::Light> {
    if !settings.burns() {
        return None;
    }
    let (particles, step) = match particles {
        Some(particles) => (particles.0.as_slice(), 1),
        None => {
            snapshot.sample(sample);
            (sample.as_slice(), snapshot.step)
        }
    };
    let fire = FireLight { particles, particles_per_sample: step, settings, assets: images, time, seed };
    fire.estimate()
}
