//! Cost of a layer of [`bevy_firework`](https://github.com/mbrea-c/bevy_firework)'s particles: lit forward by Bevy's own
//! shader, with its normal map and its fade at the scene.

#[path = "../../scene.rs"]
mod scene;

use bevy::asset::RenderAssetUsages;
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_firework::core::{
    BlendMode, EmissionPacing, EmissionSettings, ParticleData, ParticleSettings, ParticleSpawner, ParticleSpawnerData,
};
use bevy_firework::plugin::ParticleSystemPlugin;

use scene::{Case, Options, RADIUS, SPRITE_SIZE};

fn main() -> Result<(), String> {
    let options = Options::from_arguments()?;
    let (mut app, camera) = scene::app(&options, ParticleSystemPlugin::default());
    // For the fade at the scene.
    app.world_mut().entity_mut(camera).insert(DepthPrepass);
    let texels = 0..SPRITE_SIZE * SPRITE_SIZE;
    let amounts = texels.clone().flat_map(|index| [255, 255, 255, scene::texel(index).1]).collect();
    let normals = texels.map(scene::texel).flat_map(|([x, y, z], _)| [x, y, z, 255]).collect();
    let base_color_texture = Some(texture(&mut app, amounts, TextureFormat::Rgba8UnormSrgb));
    let normal_map_texture = Some(texture(&mut app, normals, TextureFormat::Rgba8Unorm));
    let settings = ParticleSettings {
        acceleration: Vec3::ZERO,
        base_color_texture,
        normal_map_texture,
        fade_edge: 0.0,
        blend_mode: BlendMode::Blend,
        pbr: true,
        ..default()
    };
    let emission = EmissionSettings { emission_pacing: EmissionPacing::OnDemand, ..default() };
    let spawner = ParticleSpawner { particle_settings: vec![settings], emission_settings: vec![emission], ..default() };
    let spawner = app.world_mut().spawn(spawner).id();
    // The plugin makes the spawner's lists.
    app.update();
    let place = |app: &mut App, case: Case| {
        let particles = scene::centers(case.layers).map(|position| ParticleData {
            position,
            velocity: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            angular_velocity: Vec3::ZERO,
            initial_scale: 2.0 * RADIUS,
            scale: 2.0 * RADIUS,
            age: 0.0,
            lifetime: 1.0,
            base_color: LinearRgba::WHITE,
            emissive_color: LinearRgba::BLACK,
            pbr: true,
            last_emitted_age: vec![f32::MIN],
        });
        let particles = particles.collect();
        if let Some(mut data) = app.world_mut().get_mut::<ParticleSpawnerData>(spawner) {
            data.particles = vec![particles];
        }
    };
    scene::measure(app, &options, &["bevy_firework"], &["main_transparent_pass_3d"], place)
}

fn texture(app: &mut App, bytes: Vec<u8>, format: TextureFormat) -> Handle<Image> {
    let size = Extent3d { width: SPRITE_SIZE, height: SPRITE_SIZE, depth_or_array_layers: 1 };
    let image = Image::new(size, TextureDimension::D2, bytes, format, RenderAssetUsages::RENDER_WORLD);
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}
