//! Presets from files, and their changes.

use std::path::Path;
use std::time::{Duration, Instant};

use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock};

use crate::host::{Host, SECONDS, host};
use crate::picture::count;

const PRESET: &str = include_str!("../../assets/column.smoke.json");

/// Packages cannot reach outside, so the examples have a copy.
#[test]
fn the_preset_of_the_examples_is_the_built_in_one() {
    assert_eq!(PRESET, include_str!("../../../../presets/column.json"));
}

/// The preset with a part of its text changed.
fn changed(from: &str, to: &str) -> String {
    assert!(PRESET.contains(from), "{from}");
    PRESET.replace(from, to)
}

/// Updates until the condition holds.
fn wait(host: &mut Host, condition: impl Fn(&World) -> bool) {
    let started = Instant::now();
    while !condition(host.app.world()) {
        assert!(started.elapsed() < Duration::from_secs(30), "the asset server has not answered");
        host.app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn load(host: &mut Host, name: &str) -> Handle<SmokeAsset> {
    let handle = host.app.world().resource::<AssetServer>().load(name.to_owned());
    host.app.world_mut().spawn((Smoke::from(handle.clone()), SmokeClock::paused_at(SECONDS)));
    let id = handle.id();
    wait(host, |world| {
        let state = world.resource::<AssetServer>().load_state(id);
        matches!(state, LoadState::Loaded | LoadState::Failed(_))
    });
    handle
}

fn failure(host: &Host, handle: &Handle<SmokeAsset>) -> String {
    match host.app.world().resource::<AssetServer>().load_state(handle) {
        LoadState::Failed(error) => error.to_string(),
        state => panic!("{state:?}"),
    }
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn a_broken_preset_keeps_the_last_picture_and_a_good_one_replaces_it() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "own.smoke.json", PRESET);
    let mut host = host(folder.path());
    host.camera();
    host.lights();
    let handle = load(&mut host, "own.smoke.json");
    let first = host.picture();

    write(folder.path(), "own.smoke.json", &changed("\"boost\": 1.5", "\"boost\": -1"));
    host.app.world().resource::<AssetServer>().reload("own.smoke.json");
    let id = handle.id();
    wait(&mut host, |world| matches!(world.resource::<AssetServer>().load_state(id), LoadState::Failed(_)));
    let error = failure(&host, &handle);
    assert!(error.contains("own.smoke.json") && error.contains("systems[0].settings.boost: -1"), "{error}");
    let broken = host.picture();
    let all = vec![true; first.pixels.len()];
    assert!(broken.psnr(&first, &all) > 60.0);

    write(folder.path(), "own.smoke.json", &changed("\"rate\": 37.0", "\"rate\": 0.0"));
    host.app.world().resource::<AssetServer>().reload("own.smoke.json");
    wait(&mut host, |world| {
        let assets = world.resource::<Assets<SmokeAsset>>();
        assets.get(id).is_some_and(|asset| asset.systems[0].preset.emitter.rate < 1.0)
    });
    let none = host.picture();
    assert!(count(&none.mask_of_difference(&first)) > 1000);
}

#[test]
fn images_beside_a_preset_are_read_by_the_asset_server() {
    let folder = tempfile::tempdir().unwrap();
    let images = folder.path().join("smoke/ramps");
    std::fs::create_dir_all(&images).unwrap();
    let named = changed("\"diffuse_soft\"", "\"ramps/red.png\"");
    write(folder.path(), "smoke/own.smoke.json", &named);
    let mut host = host(folder.path());
    host.camera();
    host.lights();

    let handle = load(&mut host, "smoke/own.smoke.json");
    let error = failure(&host, &handle);
    assert!(error.contains("material.diffuse_ramp") && error.contains("red.png"), "{error}");

    let red = Image::new_fill(
        bevy::render::render_resource::Extent3d { width: 4, height: 4, depth_or_array_layers: 1 },
        bevy::render::render_resource::TextureDimension::D2,
        &[255, 0, 0, 255],
        bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb,
        bevy::asset::RenderAssetUsages::default(),
    );
    red.try_into_dynamic().unwrap().save(images.join("red.png")).unwrap();
    host.app.world().resource::<AssetServer>().reload("smoke/own.smoke.json");
    let id = handle.id();
    wait(&mut host, |world| world.resource::<Assets<SmokeAsset>>().contains(id));
    let picture = host.picture();
    let reddest = picture.pixels.iter().filter(|[r, g, _, _]| *r > 0.2 && r > &(3.0 * g)).count();
    assert!(reddest > 500, "{reddest}");
}

#[test]
fn files_that_are_no_presets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let particles = changed("\"name\": \"smoke\",", "\"name\": \"smoke\", \"particle_files\": {\"path\": \"a.ply\"},");
    let no_sprite = changed("\"sprite\": \"billow\"", "\"sprite\": \"absent.png\"");
    let unknown = changed("\"sprite\": \"billow\"", "\"sprite\": \"billoww\"");
    let outside = changed("\"diffuse_soft\"", "\"../red.png\"");
    let mut host = host(folder.path());
    for (name, text, expected) in [
        ("cut.smoke.json", &PRESET[..200], "cut.smoke.json:"),
        ("particles.smoke.json", &particles, "systems[0].particle_files.path"),
        ("sprite.smoke.json", &no_sprite, "material.sprite"),
        ("unknown.smoke.json", &unknown, "billoww"),
        ("outside.smoke.json", &outside, "material.diffuse_ramp"),
    ] {
        write(folder.path(), name, text);
        let handle = load(&mut host, name);
        let error = failure(&host, &handle);
        assert!(error.contains(expected), "{error}");
    }
    std::fs::write(folder.path().join("bytes.smoke.json"), [0xff, 0xfe, 0x00]).unwrap();
    let handle = load(&mut host, "bytes.smoke.json");
    assert!(failure(&host, &handle).contains("UTF-8"));
    host.update(3);
}
