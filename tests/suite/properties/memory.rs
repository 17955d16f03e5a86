//! Memory of the targets, and steady frames that create no GPU resources.

use glam::{UVec2, Vec3, vec3};
use haze::{Bounds, Context, MaterialAssets, wgpu};
use haze_core::assets::ramp::Ramp;
use haze_core::settings::{DiffuseMode, LightingResolution, Upsample};
use haze_demo::headless::Headless;

use super::SIZE;
use crate::gpu::gpu;
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::TestScene;

#[test]
fn a_system_at_1080p_half_scale_takes_at_most_8_mb_and_16_bytes_a_texel_more_if_lit_there() {
    let mut scene = TestScene::new(UVec2::new(1920, 1080));
    scene.settings.accumulate.lighting_resolution = LightingResolution::Full;
    // The worst case: the bounds cover the whole screen.
    scene.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
    let drawn = scene.on_gpu(gpu());
    let whole = drawn.renderer.memory_use().targets;
    println!("{:.2} MB", whole as f64 / 1e6);
    assert!(whole <= 8_000_000, "{whole} bytes");
    assert_eq!(drawn.renderer.targets(0).unwrap().size, UVec2::new(960, 540));
    // Light and its slopes over depth: four half floats each. Two bytes for each cell of 4x4 texels.
    let cells = 240 * 135 * 2;
    scene.settings.accumulate.lighting_resolution = LightingResolution::Target;
    assert_eq!(scene.on_gpu(gpu()).renderer.memory_use().targets, whole + 960 * 540 * 16 + cells);
    // Other filters than `guided` need no slopes.
    scene.settings.accumulate.upsample = Upsample::JointBilateral;
    assert_eq!(scene.on_gpu(gpu()).renderer.memory_use().targets, whole + 960 * 540 * 8 + cells);
    scene.settings.accumulate.lighting_resolution = LightingResolution::Full;
    // Targets cover only the screen rectangle of the bounds.
    scene.bounds = Some(Bounds { min: vec3(-0.5, -0.5, -6.5), max: vec3(0.5, 0.5, -5.5) });
    let drawn = scene.on_gpu(gpu());
    let size = drawn.renderer.targets(0).unwrap().size;
    assert!(size.x < 200 && size.y < 200, "{size}");
    assert!(drawn.renderer.memory_use().targets < whole / 8);
}

#[test]
fn steady_frames_create_no_gpu_resources() {
    let mut scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    for (mode, lighting_resolution) in [
        (DiffuseMode::Ramp, LightingResolution::Full),
        (DiffuseMode::Cubemap, LightingResolution::Full),
        (DiffuseMode::Cubemap, LightingResolution::Target),
    ] {
        scene.settings.diffuse.mode = mode;
        scene.settings.accumulate.lighting_resolution = lighting_resolution;
        // The first frame creates resources, and the counter counts them.
        assert!(resource_counter::count(|| host.draw(gpu(), &scene).unwrap()) > 0);
        let renderer_of = |host: &Host| {
            let targets = host.renderer.targets(0).unwrap();
            (targets.accumulation.to_vec(), targets.reduced_depth.cloned(), host.renderer.memory_use())
        };
        let before = renderer_of(&host);
        for frame in 0..10 {
            // The smoke moves and the lights flicker.
            for particle in &mut scene.particles {
                particle.rotation += 0.01;
            }
            scene.lights[0].intensity = 20.0 + frame as f32;
            let created = resource_counter::count(|| host.draw(gpu(), &scene).unwrap());
            assert_eq!(created, 0, "{mode:?}, frame {frame}: a steady frame creates GPU resources");
        }
        assert_eq!(before, renderer_of(&host));
    }
    // Mutant: a resource that is dropped at once is counted too.
    let view = host.depth.texture();
    assert_eq!(resource_counter::count(|| drop(view.create_view(&wgpu::TextureViewDescriptor::default()))), 1);
}

#[test]
fn the_library_never_submits() {
    // headless.rs, the demo and the program are hosts; everything else is the library.
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let host = ["headless.rs", "demo", "app", "main.rs"].iter().any(|name| path.ends_with(name));
            if path.is_dir() && !host {
                folders.push(path);
            } else if !path.is_dir() && !host {
                let text = std::fs::read_to_string(&path).unwrap();
                assert!(!text.contains(".submit(") && !text.contains("PollType"), "{}", path.display());
            }
        }
    }
}

#[test]
fn materials_share_the_images_that_they_have_in_common() {
    let Headless { device, queue, .. } = gpu();
    let context = Context::new(device, queue);
    let assets = TestScene::new(SIZE).material;
    let first = context.create_material(&assets).unwrap();
    let of_one = context.material_memory();
    assert_eq!(of_one, first.memory_use());
    let diffuse_ramp = Ramp::from_linear(UVec2::new(4, 1), [Vec3::ONE; 4]);
    let second = context.create_material(&MaterialAssets { diffuse_ramp, ..assets.clone() }).unwrap();
    // Four texels of four half floats.
    assert_eq!(context.material_memory(), of_one + 4 * 8);
    assert!(second.memory_use() > of_one / 2, "its own count has the shared images too");
    drop(first);
    assert_eq!(context.material_memory(), second.memory_use());
    drop(second);
    assert_eq!(context.material_memory(), 0);
}
