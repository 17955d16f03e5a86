//! Two lamps circle a column of smoke, one warm and one cold, and a spot light swings above it.

mod common;
#[path = "common/yard.rs"]
mod yard;

use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy_haze::{Smoke, SmokePlugin};

/// Lamp on a circle around the smoke: its height in metres, and its angle at the start in radians.
#[derive(Component)]
struct Circling {
    height: f32,
    start: f32,
}

#[derive(Component)]
struct Swinging;

fn main() -> AppExit {
    App::new()
        .add_plugins((common::ExamplePlugins, SmokePlugin, yard::YardPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, (circle, swing))
        .run()
}

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Camera3d::default(), yard::look_from(1.6, 2.0, 9.0)));
    commands.spawn(Smoke::from(assets.load("column.smoke.json")));

    let bulb = meshes.add(Sphere::new(0.06));
    for (color, height, start) in [(Color::srgb(1.0, 0.6, 0.3), 2.4, 2.5), (Color::srgb(0.35, 0.55, 1.0), 1.5, 5.6)] {
        let light = PointLight { color, intensity: 400_000.0, range: 20.0, shadow_maps_enabled: true, ..default() };
        // Blended meshes are drawn after the shadow of the smoke, which would darken the bulbs.
        let alpha_mode = AlphaMode::Blend;
        let material = materials.add(StandardMaterial { base_color: color, unlit: true, alpha_mode, ..default() });
        let body = (Mesh3d(bulb.clone()), MeshMaterial3d(material), NotShadowCaster);
        commands.spawn((light, Transform::default(), Circling { height, start }, children![body]));
    }
    let spot = SpotLight { intensity: 2_000_000.0, range: 30.0, outer_angle: 0.35, inner_angle: 0.2, ..default() };
    commands.spawn((spot, Swinging, Transform::default()));
}

fn circle(time: Res<Time>, mut lamps: Query<(&Circling, &mut Transform)>) {
    for (lamp, mut transform) in &mut lamps {
        let angle = lamp.start + 0.5 * time.elapsed_secs();
        transform.translation = Vec3::new(2.6 * angle.cos(), lamp.height, 2.6 * angle.sin());
    }
}

fn swing(time: Res<Time>, mut spots: Query<&mut Transform, With<Swinging>>) {
    for mut transform in &mut spots {
        let target = Vec3::new(0.4 + 0.8 * (0.7 * time.elapsed_secs()).sin(), 2.6, 0.0);
        *transform = Transform::from_xyz(-2.5, 6.5, 1.5).looking_at(target, Vec3::Y);
    }
}
