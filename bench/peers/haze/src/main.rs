//! Cost of a layer of haze's smoke in Bevy.

#[path = "../../scene.rs"]
mod scene;

use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy_haze::haze::glam::{UVec2, Vec3 as HazeVec3};
use bevy_haze::haze::ramp::Ramp;
use bevy_haze::haze::settings::RenderPath;
use bevy_haze::haze::sprite::Sprite;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock, SmokeParticle, SmokeParticles, SmokePlugin};

use scene::{Case, Options, RADIUS, SPRITE_SIZE};

const VARIANTS: [(&str, RenderPath, u32); 4] = [
    ("raster 1/1", RenderPath::Raster, 1),
    ("raster 1/2", RenderPath::Raster, 2),
    ("tiled 1/2", RenderPath::Tiled, 2),
    ("auto 1/2", RenderPath::Auto, 2),
];

fn main() -> Result<(), String> {
    let options = Options::from_arguments()?;
    let (mut app, _) = scene::app(&options, SmokePlugin);
    let asset = asset().map_err(|error| error.to_string())?;
    let assets = VARIANTS.map(|(name, path, scale)| {
        let mut asset = asset.clone();
        for system in &mut asset.systems {
            system.preset.settings.path = path;
            system.preset.settings.accumulate.downscale = scale;
        }
        (name, app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(asset))
    });
    let (_, first) = &assets[0];
    let parts = (Smoke::from(first.clone()), SmokeClock::paused_at(0.0), NotShadowCaster);
    let smoke = app.world_mut().spawn(parts).id();
    let place = |app: &mut App, case: Case| {
        let puff = |position| SmokeParticle { position, radius: RADIUS, amount: 1.0, ..default() };
        let particles = SmokeParticles::new(scene::centers(case.layers).map(puff));
        if let Some((_, asset)) = assets.iter().find(|(name, _)| *name == case.variant) {
            app.world_mut().entity_mut(smoke).insert((Smoke::from(asset.clone()), particles));
        }
    };
    let variants = VARIANTS.map(|(name, ..)| name);
    scene::measure(app, &options, &variants, &["smoke", "main_transparent_pass_3d"], place)
}

/// Smoke with the sprite of the scene: soft at the scene, lit through a ramp.
fn asset() -> Result<SmokeAsset, bevy_haze::haze::AssetError> {
    let mut asset = SmokeAsset::builtin("column")?;
    for system in &mut asset.systems {
        let texel = |index| {
            let ([x, y, z], amount) = scene::texel(index);
            [x, y, z, amount]
        };
        system.images.sprite = Sprite::with_levels(SPRITE_SIZE, 1, (0..SPRITE_SIZE * SPRITE_SIZE).map(texel).collect());
        system.images.detail = None;
        system.images.six_way = None;
        let lambert = |index: u32| HazeVec3::splat((2.0 * (index as f32 + 0.5) / 256.0 - 1.0).max(0.0));
        system.images.diffuse_ramp = Ramp::from_linear(UVec2::new(256, 1), (0..256).map(lambert));
        system.preset.settings = Default::default();
    }
    Ok(asset)
}
