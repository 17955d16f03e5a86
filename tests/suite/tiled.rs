//! Compares the path `tiled` with `raster` and with the CPU renderer, for every setting and for both traversals of the
//! sprite lists: cooperative and per invocation.

mod auto;
mod emission;
mod lists;
mod precision;

use std::sync::LazyLock;

use glam::UVec2;
use glam::camera::rh::proj::directx;
use glam::{Vec3, Vec4, vec3};
use haze::{Bounds, Context, Particle, ParticleBuffer, Particles, wgpu};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::settings::*;
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;
use haze_preset::builtin;

use crate::gpu::{gpu, is_tiled_available, own_context};
use crate::psnr::{MIN_PSNR, MIN_PSNR_WITH_STEPS, psnr};
use crate::techniques;
use crate::test_host::Host;
use crate::test_scene::TestScene;

/// Least agreement with `raster`, dB. The paths differ because the blend unit rounds every layer.
const MIN_PSNR_TO_RASTER: f32 = 55.0;

/// Least agreement with the CPU renderer, which rounds as the blend unit does, dB.
const MIN_PSNR_TO_CPU: f32 = MIN_PSNR;

fn scene(technique: Technique) -> TestScene {
    let mut scene = techniques::scene(technique);
    scene.settings.accumulate.layers = Traversal::All;
    scene
}

fn context_with_traversal(cooperative: bool) -> Context {
    let context = own_context();
    context.set_cooperative_traversal(cooperative);
    context
}

/// Renders with one path and one traversal. Exact filtering would force the cooperative traversal, so the other one
/// uses the sampler's filter.
fn render_with(scene: &TestScene, path: RenderPath, cooperative: bool) -> Image<Vec4> {
    let mut scene = scene.clone();
    scene.settings.path = path;
    scene.host.exact_filtering = cooperative;
    static CONTEXTS: [LazyLock<Context>; 2] =
        [LazyLock::new(|| context_with_traversal(false)), LazyLock::new(|| context_with_traversal(true))];
    let mut host = Host::with_context(gpu(), &scene, Some(&CONTEXTS[usize::from(cooperative)])).unwrap();
    host.draw(gpu(), &scene).unwrap();
    gpu().check().unwrap();
    host.image(gpu()).unwrap()
}

/// Asserts that both traversals agree with `raster`, and the cooperative one also with the CPU renderer.
pub fn assert_agreement(name: &str, scene: &TestScene) {
    let steps = scene.settings.debug.checkerboard;
    let reference = scene.on_cpu();
    for cooperative in [true, false] {
        let [tiled, raster] = [RenderPath::Tiled, RenderPath::Raster].map(|path| render_with(scene, path, cooperative));
        let to_raster = psnr(&tiled, &raster);
        let to_reference = psnr(&tiled, &reference);
        println!("{name}, cooperative {cooperative}: raster {to_raster:.1} dB, CPU renderer {to_reference:.1} dB");
        assert!(
            to_raster >= if steps { MIN_PSNR_WITH_STEPS } else { MIN_PSNR_TO_RASTER },
            "{name}: {to_raster:.1} dB against raster"
        );
        if cooperative {
            let least = if steps { MIN_PSNR_WITH_STEPS } else { MIN_PSNR_TO_CPU };
            assert!(to_reference >= least, "{name}: {to_reference:.1} dB against the CPU renderer");
        }
    }
}

#[test]
fn tiled_path_agrees_on_every_technique() {
    if !is_tiled_available() {
        return;
    }
    for &technique in Technique::ALL {
        let name = technique.name();
        assert_agreement(name, &scene(technique));
        let mut always = scene(technique);
        always.settings.soft_fade.curve = FadeCurve::Always;
        assert_agreement(&format!("{name} always"), &always);
        let mut host_depth = scene(technique);
        let accumulate = &mut host_depth.settings.accumulate;
        accumulate.depth_source = DepthSource::Host;
        accumulate.downscale = 1;
        assert_agreement(&format!("{name} host depth"), &host_depth);
        let mut orthographic = scene(technique);
        orthographic.view.clip_from_view = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
        assert_agreement(&format!("{name} orthographic"), &orthographic);
    }
}

#[test]
fn tiled_path_agrees_in_every_accumulation_mode() {
    if !is_tiled_available() {
        return;
    }
    type Change = fn(&mut TestScene);
    let changes: [(&str, Change); 9] = [
        ("weighted", |s| s.settings.accumulate.order = BlendOrder::Weighted),
        ("biased", |s| s.settings.accumulate.encoding = NormalEncoding::Biased),
        ("weighted and biased", |s| {
            s.settings.accumulate.order = BlendOrder::Weighted;
            s.settings.accumulate.encoding = NormalEncoding::Biased;
        }),
        ("lit at the target's resolution", |s| s.settings.accumulate.lighting_resolution = LightingResolution::Target),
        ("scale 3", |s| s.settings.accumulate.downscale = 3),
        ("drawn three times", |s| {
            s.settings.debug.draw_count = 3;
            s.settings.accumulate.opacity = 0.2;
        }),
        ("checkerboard", |s| s.settings.debug.checkerboard = true),
        ("motion", |s| s.settings.sprite.motion = 1.0),
        // Most sprites cross the borders of the image, and some surround the camera.
        ("near", |s| s.particles.iter_mut().for_each(|p| p.position.z += 5.5)),
    ];
    for (name, change) in changes {
        let mut scene = scene(Technique::Soft);
        change(&mut scene);
        assert_agreement(name, &scene);
    }
}

#[test]
fn skipping_hidden_layers_barely_changes_the_image() {
    if !is_tiled_available() {
        return;
    }
    // A stack of layers that is opaque after about twenty.
    let mut scene = scene(Technique::Soft);
    let layer = |index: u32| Particle {
        position: vec3(0.0, 0.0, -4.0 - 0.01 * index as f32),
        radius: 3.0,
        amount: 0.5,
        rotation: index as f32,
        ..Particle::default()
    };
    scene.particles = (0..400).map(layer).collect();
    for cooperative in [true, false] {
        scene.settings.accumulate.layers = Traversal::All;
        let all = render_with(&scene, RenderPath::Tiled, cooperative);
        scene.settings.accumulate.layers = Traversal::UntilOpaque;
        let visible = render_with(&scene, RenderPath::Tiled, cooperative);
        let apart = psnr(&visible, &all);
        println!("visible layers against all: {apart:.1} dB");
        // The layers that are skipped add at most a thousandth of the light.
        assert!((55.0..150.0).contains(&apart), "visible layers against all: {apart} dB");
    }
}

#[test]
fn tiled_path_agrees_on_every_preset() {
    if !is_tiled_available() {
        return;
    }
    let renderer = |shot: &Shot, path, layers| {
        let mut shot = shot.clone();
        for system in &mut shot.preset.systems {
            system.settings.path = path;
            system.settings.accumulate.layers = layers;
        }
        crate::presets::render_on_gpu(&shot, false)
    };
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, UVec2::new(320, 180)).unwrap();
        let mut behind = shot.clone();
        behind.preset.systems.clear();
        behind.materials.clear();
        let behind = renderer(&behind, RenderPath::Raster, Traversal::All);
        let raster = renderer(&shot, RenderPath::Raster, Traversal::All);
        for &layers in Traversal::ALL {
            let tiled = renderer(&shot, RenderPath::Tiled, layers);
            let apart = crate::psnr::psnr_over([&tiled, &raster], [&behind, &behind]);
            println!("{}, {} layers: {apart:.1} dB", preset.name, layers.name());
            assert!(apart >= MIN_PSNR_TO_RASTER, "{}: {apart:.1} dB", preset.name);
        }
    }
}

#[test]
fn tiled_path_is_deterministic_and_sorts_buffers() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene(Technique::Soft);
    // More particles than a block of the sort holds, many at the same depth, some hidden.
    let all = |index: u32| {
        let mut particle = scene.particles[index as usize % 60];
        particle.position.x += 0.001 * (index / 60) as f32;
        particle.amount *= 0.1;
        if index.is_multiple_of(7) {
            particle.amount = 0.0;
        }
        particle
    };
    let all: Vec<_> = (0..3000_u32).map(all).collect();
    scene.particles.clone_from(&all);
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    scene.settings.path = RenderPath::Tiled;
    scene.host.exact_filtering = false;
    let mut host = Host::new(gpu(), &scene).unwrap();
    for cooperative in [true, false] {
        host.renderer.context().set_cooperative_traversal(cooperative);
        let image = |host: &mut Host| {
            host.draw(gpu(), &scene).unwrap();
            host.image(gpu()).unwrap()
        };
        let first = image(&mut host);
        assert!(image(&mut host) == first);
        // The GPU sorts particles from a buffer, with either traversal.
        let mut buffered = |particles: &[Particle], offset: u64| {
            let mut bytes = vec![0x7f; offset as usize];
            bytes.extend_from_slice(bytemuck::cast_slice(particles));
            let buffer = storage_buffer(&bytes);
            let particles =
                Particles::Buffer(ParticleBuffer { offset, ..ParticleBuffer::new(&buffer, particles.len() as u32) });
            host.draw_particles(gpu(), &scene, particles).unwrap();
            host.image(gpu()).unwrap()
        };
        // The sort is stable: particles at the same depth keep their order.
        let mut sorted = all.clone();
        sorted.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
        let sorted = buffered(&sorted, 0);
        for offset in [0, 16, 272] {
            assert!(buffered(&all, offset) == sorted, "differs at offset {offset}");
        }
    }
    gpu().check().unwrap();
}

fn storage_buffer(bytes: &[u8]) -> wgpu::Buffer {
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu().queue.write_buffer(&buffer, 0, bytes);
    buffer
}

#[test]
fn devices_and_buffers_without_tiles_are_errors_on_the_tiled_path() {
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Tiled;
    let refused = |result: Result<(), Error>| match result {
        Err(Error::Field(error)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let webgl2 = Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty()).unwrap();
    let mut host = Host::new(&webgl2, &scene).unwrap();
    let message = refused(host.draw(&webgl2, &scene));
    assert!(message.contains("systems[0].settings.path") && message.contains("raster"), "{message}");
    scene.settings.path = RenderPath::Auto;
    host.draw(&webgl2, &scene).unwrap();
    if !is_tiled_available() {
        return;
    }
    scene.settings.path = RenderPath::Tiled;
    scene.bounds = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let mut host = Host::new(gpu(), &scene).unwrap();
    let buffer = storage_buffer(&[0; 128]);
    let particles = Particles::Buffer(ParticleBuffer { offset: 4, ..ParticleBuffer::new(&buffer, 1) });
    let message = refused(host.draw_particles(gpu(), &scene, particles));
    assert!(message.contains("particles.offset") && message.contains("16"), "{message}");
    let vertices = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 128,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let particles = Particles::Buffer(ParticleBuffer::new(&vertices, 1));
    let message = refused(host.draw_particles(gpu(), &scene, particles));
    assert!(message.contains("STORAGE"), "{message}");
}
