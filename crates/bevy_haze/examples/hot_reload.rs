//! Reads a preset again whenever it is saved. Run this beside haze's tweaker, `haze tweak assets/column.smoke.json`, or an
//! editor. A preset with a mistake is reported, and the last good smoke stays.
//!
//! Needs Bevy's feature `file_watcher`, as in this crate's `Cargo.toml`. Space holds the clock, the arrow keys seek.

mod common;
#[path = "common/yard.rs"]
mod yard;

use bevy::prelude::*;
use bevy_haze::{Smoke, SmokeClock, SmokePlugin};

fn main() -> AppExit {
    App::new()
        .add_plugins((common::ExamplePlugins, SmokePlugin, yard::YardPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, seek)
        .run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((Camera3d::default(), yard::look_from(0.5, 2.0, 8.0)));
    commands.spawn((Smoke::from(assets.load("column.smoke.json")), SmokeClock::at(14.0)));
    let lamp = PointLight { intensity: 600_000.0, color: Color::srgb(1.0, 0.7, 0.45), range: 30.0, ..default() };
    commands.spawn((lamp, Transform::from_xyz(-4.0, 3.4, 2.5)));
}

fn seek(keys: Res<ButtonInput<KeyCode>>, time: Res<Time>, mut clocks: Query<&mut SmokeClock>) {
    for mut clock in &mut clocks {
        if keys.just_pressed(KeyCode::Space) {
            clock.paused = !clock.paused;
        }
        for (key, direction) in [(KeyCode::ArrowLeft, -4.0), (KeyCode::ArrowRight, 4.0)] {
            if keys.pressed(key) {
                clock.seconds += direction * time.delta_secs_f64();
            }
        }
    }
}
