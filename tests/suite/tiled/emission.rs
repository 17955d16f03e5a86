//! Emitters that the GPU evaluates.

use glam::{UVec2, Vec3, vec3};
use haze::{Particles, TiledMemory, wgpu};
use haze_core::emitter::{Emitter, EmitterShape};
use haze_core::frame::SpriteExtent;
use haze_core::settings::*;

use super::{MIN_PSNR_TO_RASTER, scene};
use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::psnr;
use crate::test_host::Host;
use crate::test_scene::TestScene;

/// An emitter in front of the test camera.
fn emitter() -> Emitter {
    Emitter {
        rate: 60.0,
        lifetime: 3.0,
        position: vec3(0.0, -1.0, -5.0),
        extent: Vec3::splat(0.4),
        radius_end: 0.6,
        amount: 0.2,
        ..Emitter::default()
    }
}

#[test]
fn emitter_on_the_gpu_matches_its_particles_as_a_slice() {
    if !is_tiled_available() {
        return;
    }
    for shape in [EmitterShape::Sphere, EmitterShape::Box, EmitterShape::Disc] {
        let emitter = Emitter { shape, ..emitter() };
        for time in [0.3, 7.0, 10_000.0] {
            let emission = emitter.snapshot(time);
            let mut scene = scene(Technique::Soft);
            emission.evaluate(&mut scene.particles);
            // The same bounding box for both, so that both are lit on the same plane.
            scene.bounds = Some(emission.bounds(SpriteExtent::from_settings(&scene.settings)));
            scene.settings.accumulate.order = BlendOrder::Sorted;
            let mut host = Host::new(gpu(), &scene).unwrap();
            let particles = scene.particles.clone();
            let mut drawn = |path, particles| {
                scene.settings.path = path;
                host.draw_particles(gpu(), &scene, particles).unwrap();
                host.image(gpu()).unwrap()
            };
            let tiled = drawn(RenderPath::Tiled, Particles::Emitter(&emission));
            assert!(drawn(RenderPath::Tiled, Particles::Emitter(&emission)) == tiled, "a second draw differs");
            let raster = drawn(RenderPath::Raster, Particles::Emitter(&emission));
            let slice = drawn(RenderPath::Tiled, Particles::Slice(&particles));
            let to_raster = psnr(&tiled, &raster);
            let to_slice = psnr(&tiled, &slice);
            println!("{shape:?} at {time} s: {to_raster:.1} dB against raster, {to_slice:.1} dB against the slice");
            assert!(to_raster >= MIN_PSNR_TO_RASTER && to_slice >= 70.0, "raster {to_raster} dB, slice {to_slice} dB");
        }
    }
    gpu().check().unwrap();
}

#[test]
fn a_million_gpu_particles_fit_into_200_megabytes() {
    if !is_tiled_available() {
        return;
    }
    let emitter = Emitter { rate: 100_000.0, lifetime: 8.7, lifetime_spread: 0.2, radius_end: 0.02, ..emitter() };
    emitter.validate(String::new).unwrap();
    let emission = emitter.snapshot(60.0);
    assert!(
        (1_000_000..=haze_core::emitter::MAX_PARTICLES + 2).contains(&emission.count()),
        "{} particles",
        emission.count()
    );
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Tiled;
    scene.settings.accumulate.downscale = 2;
    // Light per texel has two further targets, whatever the number of particles.
    scene.settings.accumulate.lighting_resolution = LightingResolution::Full;
    scene.view = TestScene::new(UVec2::new(1920, 1080)).view;
    let mut host = Host::new(gpu(), &scene).unwrap();
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    host.prepare(&mut encoder, &scene, Particles::Emitter(&emission)).unwrap();
    let memory = host.renderer.memory_use();
    println!("{memory:?}");
    let TiledMemory { emitted, sorted, sprites, keys, counts, lists, .. } = memory.tiled;
    assert!([emitted, sprites, keys, counts, lists].iter().all(|&bytes| bytes > 1 << 20), "{memory:?}");
    assert_eq!((memory.tiled.total(), sorted), (emitted + sprites + keys + counts + lists, 0));
    assert!(memory.buffers >= memory.tiled.total() && memory.targets > 960 * 540 * 8);
    assert!(memory.targets + memory.buffers <= 200_000_000, "{memory:?}");
    // The CPU neither sorts nor uploads particles.
    assert!(memory.buffers - memory.tiled.total() < 1 << 16, "{memory:?}");
    gpu().check().unwrap();
}
