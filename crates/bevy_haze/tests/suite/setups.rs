//! Apps that lack something.

use bevy::asset::AssetPlugin;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::settings::{RenderCreation, WgpuSettings};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock, SmokePlugin};

fn run(app: &mut App) -> f64 {
    app.finish();
    app.cleanup();
    let asset = SmokeAsset::builtin("column").unwrap();
    let assets = app.world_mut().get_resource_mut::<Assets<SmokeAsset>>();
    let smoke = assets.map_or(Smoke::default(), |mut assets| Smoke::from(assets.add(asset)));
    let entity = app.world_mut().spawn(smoke).id();
    app.world_mut().spawn(Camera3d::default());
    (0..4).for_each(|_| app.update());
    app.world().get::<SmokeClock>(entity).unwrap().seconds
}

#[test]
fn without_a_device_clocks_run() {
    let mut app = App::new();
    let no_device = RenderCreation::Automatic(Box::new(WgpuSettings { backends: None, ..default() }));
    app.add_plugins((
        DefaultPlugins
            .build()
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<PipelinedRenderingPlugin>()
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(RenderPlugin { render_creation: no_device, ..default() }),
        SmokePlugin,
    ));
    assert!(run(&mut app) > 0.0);
}

#[test]
fn without_bevys_default_plugins_nothing_happens() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, SmokePlugin));
    assert_eq!(run(&mut app).to_bits(), 0.0_f64.to_bits());
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), SmokePlugin));
    assert!(run(&mut app) > 0.0);
}
