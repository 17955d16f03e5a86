//! Smoke from a preset, a lamp, a camera. `assets/column.smoke.json` is the preset.

mod common;

use bevy::prelude::*;
use bevy_haze::{Smoke, SmokePlugin};

fn main() -> AppExit {
    App::new().add_plugins((common::ExamplePlugins, SmokePlugin)).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 2.0, 8.0)));
    commands.spawn((PointLight::default(), Transform::from_xyz(-3.0, 3.0, 2.0)));
    commands.spawn((Smoke::from(assets.load("column.smoke.json")), Transform::from_xyz(0.0, 0.5, 0.0)));
}
