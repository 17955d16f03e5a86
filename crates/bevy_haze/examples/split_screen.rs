//! Two views of a campfire side by side: with `Hdr` and multisampling on the left, without both on the right.

mod common;
#[path = "common/yard.rs"]
mod yard;

use bevy::camera::{Hdr, Viewport};
use bevy::prelude::*;
use bevy::render::view::Msaa;
use bevy_haze::{Smoke, SmokeAsset, SmokeFireLight, SmokePlugin};

#[derive(Component, Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

fn main() -> AppExit {
    App::new()
        .add_plugins((common::ExamplePlugins, SmokePlugin, yard::YardPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, fit_viewports)
        .run()
}

fn setup(mut commands: Commands, mut smokes: ResMut<Assets<SmokeAsset>>) -> Result {
    commands.spawn((Camera3d::default(), Hdr, Msaa::Sample4, Side::Left, yard::look_from(1.5, 2.0, 6.5)));
    // Each camera clears: with and without Hdr, they draw into textures of their own first.
    let second = Camera { order: 1, ..default() };
    commands.spawn((Camera3d::default(), second, Msaa::Off, Side::Right, yard::look_from(-4.5, 2.4, 4.5)));
    let fire = Smoke::from(smokes.add(SmokeAsset::builtin("campfire")?));
    let fire_light = PointLight { shadow_maps_enabled: true, ..default() };
    commands.spawn((fire, children![(SmokeFireLight::default(), fire_light)]));
    let lamp = PointLight { intensity: 300_000.0, color: Color::srgb(0.5, 0.65, 1.0), range: 30.0, ..default() };
    commands.spawn((lamp, Transform::from_xyz(-3.5, 4.0, 3.0)));
    Ok(())
}

/// Keeps a half of the target for each view, whatever its size.
fn fit_viewports(mut cameras: Query<(&mut Camera, &Side)>) {
    for (mut camera, side) in &mut cameras {
        let Some(size) = camera.physical_target_size() else { continue };
        let half = UVec2::new(size.x / 2, size.y);
        let x = if *side == Side::Left { 0 } else { size.x - half.x };
        let viewport = Viewport { physical_position: UVec2::new(x, 0), physical_size: half, ..default() };
        if camera.viewport.as_ref().is_none_or(|old| old.physical_position.x != x || old.physical_size != half) {
            camera.viewport = Some(viewport);
        }
    }
}
