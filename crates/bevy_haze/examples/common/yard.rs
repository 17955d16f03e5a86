//! Scene of the longer examples: ground, a wall and two crates at night.

use bevy::prelude::*;

pub struct YardPlugin;

impl Plugin for YardPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ClearColor(Color::srgb(0.04, 0.05, 0.08))).add_systems(Startup, spawn_yard);
    }
}

fn spawn_yard(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut solid = |size: Vec3, color: Color, at: Transform| {
        let material = StandardMaterial { base_color: color, perceptual_roughness: 0.9, ..default() };
        commands.spawn((Mesh3d(meshes.add(Cuboid::from_size(size))), MeshMaterial3d(materials.add(material)), at));
    };
    solid(Vec3::new(20.0, 0.2, 20.0), Color::srgb(0.42, 0.42, 0.44), Transform::from_xyz(0.0, -0.1, 0.0));
    solid(Vec3::new(9.0, 3.0, 0.3), Color::srgb(0.5, 0.38, 0.3), Transform::from_xyz(0.0, 1.5, -3.2));
    let turned = |x, y, z, angle| Transform::from_xyz(x, y, z).with_rotation(Quat::from_rotation_y(angle));
    solid(Vec3::splat(1.1), Color::srgb(0.3, 0.45, 0.34), turned(1.5, 0.55, 0.9, 0.4));
    solid(Vec3::splat(0.8), Color::srgb(0.55, 0.5, 0.4), turned(-1.7, 0.4, 0.2, -0.3));
}

pub fn look_from(x: f32, y: f32, z: f32) -> Transform {
    Transform::from_xyz(x, y, z).looking_at(Vec3::new(0.3, 1.7, 0.0), Vec3::Y)
}
