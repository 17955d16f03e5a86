//! A thousand puffs of a simulation of this program: a ring of smoke that rolls through the yard, again and again. haze sorts,
//! lights and shadows them; the program only moves them.

mod common;
#[path = "common/yard.rs"]
mod yard;

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_haze::{Smoke, SmokeAsset, SmokeParticle, SmokeParticles, SmokePlugin};

const PUFFS: u32 = 1000;
/// Seconds from one ring to the next.
const PERIOD: f32 = 8.0;

fn main() -> AppExit {
    App::new()
        .add_plugins((common::ExamplePlugins, SmokePlugin, yard::YardPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, roll)
        .run()
}

fn setup(mut commands: Commands, mut smokes: ResMut<Assets<SmokeAsset>>) -> Result {
    commands.spawn((Camera3d::default(), yard::look_from(2.5, 2.4, 7.0)));
    // The preset gives settings, ramps and the sprite.
    let preset = smokes.add(SmokeAsset::builtin("column")?);
    let ring = (SmokeParticles::default(), Transform::from_xyz(0.0, 1.7, 0.0));
    commands.spawn((Smoke::from(preset), ring));
    let lamp = PointLight { intensity: 700_000.0, color: Color::srgb(1.0, 0.75, 0.5), range: 30.0, ..default() };
    commands.spawn((lamp, Transform::from_xyz(-4.0, 4.0, 3.0)));
    let sky = DirectionalLight { illuminance: 300.0, color: Color::srgb(0.5, 0.65, 1.0), ..default() };
    commands.spawn((sky, Transform::from_xyz(3.0, 4.0, -2.0).looking_at(Vec3::ZERO, Vec3::Y)));
    Ok(())
}

fn roll(time: Res<Time>, mut rings: Query<&mut SmokeParticles>) {
    let age = time.elapsed_secs_f64().rem_euclid(f64::from(PERIOD)) as f32 / PERIOD;
    for mut ring in &mut rings {
        ring.set((0..PUFFS).map(|index| puff(index, age)));
    }
}

/// Puff of a ring that rolls around its own circle while it grows, drifts and fades.
fn puff(index: u32, age: f32) -> SmokeParticle {
    let random = |salt: u32| {
        let hash = (index ^ salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
        let hash = (hash ^ (hash >> 13)).wrapping_mul(0xc2b2_ae35);
        (hash >> 8) as f32 / (1 << 24) as f32
    };
    let around = random(1) * TAU;
    let across = random(2) * TAU;
    let reach = random(3).sqrt();
    let ring = 0.8 + 0.7 * age;
    let tube = (0.18 + 0.35 * age) * reach;
    let roll = across + 9.0 * age / (0.4 + reach);
    let radius = ring + tube * roll.cos() + 0.25 * age * (3.0 * around + TAU * age).sin();
    SmokeParticle {
        position: Vec3::new(radius * around.cos(), radius * around.sin(), tube * roll.sin() + 2.2 * age - 1.2),
        radius: 0.16 + 0.4 * age * (0.5 + random(4)),
        rotation: random(5) * TAU + 2.0 * age,
        amount: 0.5 * (6.0 * age).min(1.0) * (1.0 - age),
        frame: random(6) * 64.0,
        age,
        ..default()
    }
}
