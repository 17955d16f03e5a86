//! Keyframes and flicker of presets.

use std::path::Path;

use bevy::prelude::*;
use bevy_haze::haze::preset::Preset;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock, SmokeFireLight, SmokeSystem};

use crate::host::{Host, host};
use crate::picture::count;

const COLUMN: &str = include_str!("../../assets/column.smoke.json");
/// The lights of the preset are not used.
const TRACKS: &str = r#"[
    {"setting": "lights[0].intensity", "keys": [{"time": 0, "value": 0}]},
    {"setting": "systems[0].settings.boost", "keys": [{"time": 5, "value": 0.4}, {"time": 15, "value": 3}]},
    {"setting": "systems[0].settings.accumulate.downscale", "keys": [{"time": 0, "value": 1}, {"time": 10, "value": 3}]},
    {"setting": "systems[0].emitter.wind", "keys": [{"time": 5, "value": [-0.4, 0, 0]}, {"time": 15, "value": [0.4, 0, 0]}]},
    {"setting": "systems[0].settings.diffuse.intensity", "flicker": {"amount": 0.8, "rate": 3}}
]"#;

fn with_tracks(preset: &str, tracks: &str) -> String {
    format!("{}, \"animation\": {tracks}}}", preset.trim_end().strip_suffix('}').unwrap())
}

fn add(host: &mut Host, asset: SmokeAsset) -> Smoke {
    Smoke::from(host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(asset))
}

#[test]
fn settings_have_the_values_of_their_tracks_at_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let text = with_tracks(COLUMN, TRACKS);
    std::fs::write(folder.path().join("own.smoke.json"), &text).unwrap();
    let preset = Preset::parse(Path::new("own.smoke.json"), &text).unwrap();
    let images = preset.load_materials(Path::new("own.smoke.json")).unwrap();
    let mut host = host(folder.path());
    let [_, smoke] = host.scene();
    let animated = Smoke::from(host.app.world().resource::<AssetServer>().load("own.smoke.json"));
    let pictures = [6.0, 14.0, 6.0].map(|seconds: f64| {
        let clock = SmokeClock::paused_at(seconds);
        host.app.world_mut().entity_mut(smoke).insert((animated.clone(), clock));
        let with_tracks = host.picture();
        let still = preset.evaluate(seconds).systems.into_iter().zip(images.clone());
        let systems = still.map(|(preset, images)| SmokeSystem { preset, images }).collect();
        let still = add(&mut host, SmokeAsset { systems, animation: Vec::new() });
        host.app.world_mut().entity_mut(smoke).insert(still);
        let still = host.picture();
        let decibels = with_tracks.psnr(&still, &vec![true; still.pixels.len()]);
        assert!(decibels > 60.0, "{seconds} s: {decibels} dB");
        with_tracks
    });
    let [early, late, again] = &pictures;
    let apart = count(&early.mask_of_difference(late));
    assert!(apart > 2000 && count(&early.mask_of_difference(again)) == 0, "{apart}");
}

#[test]
fn entities_of_one_preset_have_times_of_their_own_and_changed_tracks_are_followed() {
    let mut host = host("assets".as_ref());
    let mut asset = SmokeAsset::builtin("campfire").unwrap();
    let track = |value: f32| {
        let text = format!(
            r#"{{"setting": "systems[0].settings.fire.intensity", "keys": [{{"time": 10, "value": 0}}, {{"time": 20, "value": {value}}}]}}"#
        );
        let preset = Preset::parse(
            Path::new("a.json"),
            &with_tracks(r#"{"version": 1, "name": "a", "systems": [{"name": "a"}]}"#, &format!("[{text}]")),
        );
        preset.unwrap().animation
    };
    asset.systems.truncate(1);
    asset.animation = track(1.0);
    let smoke = add(&mut host, asset);
    let lights = [5.0, 20.0, 30.0].map(|seconds| {
        let smoke = host.app.world_mut().spawn((smoke.clone(), SmokeClock::paused_at(seconds))).id();
        host.app.world_mut().spawn((SmokeFireLight::default(), ChildOf(smoke))).id()
    });
    let intensities = |host: &mut Host| {
        host.update(2);
        lights.map(|light| host.app.world().get::<PointLight>(light).unwrap().intensity)
    };
    let [out, lit, later] = intensities(&mut host);
    assert!(out <= 0.0 && lit > 0.0 && later > 0.0, "{out} {lit} {later}");
    for (_, asset) in host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().iter_mut() {
        asset.animation = track(4.0);
    }
    let [out, brighter, _] = intensities(&mut host);
    assert!(out <= 0.0 && brighter > 1.5 * lit, "{lit} {brighter}");
}
