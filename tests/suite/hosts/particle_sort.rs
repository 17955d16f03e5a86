//! Particles in a host buffer: the GPU measures them, and sorts them for the paths that use hardware blending.

use glam::camera::rh;
use glam::{Mat4, Vec3, vec3};
use haze::{AliveCount, Bounds, Particle, ParticleBuffer, Particles, wgpu};
use haze_core::frame::{SpriteExtent, particle_bounds};
use haze_core::settings::*;
use haze_demo::headless::Headless;

use super::warm_up::warm_up;
use super::{SIZE, rejected_field};
use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::psnr;
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

const BOUNDS: Bounds = Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) };

/// Creates a particle buffer with `offset` filler bytes before the first particle.
fn buffer(gpu: &Headless, particles: &[Particle], offset: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let mut bytes = vec![0x7f; offset as usize];
    bytes.extend_from_slice(bytemuck::cast_slice(particles));
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, &bytes);
    buffer
}

const READ: wgpu::BufferUsages = wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::STORAGE);

/// Returns `count` particles made from the scene's: several at the same depth, every seventh with amount 0.
fn repeated_particles(scene: &TestScene, count: usize) -> Vec<Particle> {
    let one = |index: usize| {
        let mut particle = scene.particles[index % scene.particles.len()];
        particle.position.x += 1.0e-4 * index as f32;
        particle.amount *= if index.is_multiple_of(7) { 0.0 } else { 0.1 };
        particle
    };
    (0..count).map(one).collect()
}

#[test]
fn unsorted_host_buffer_draws_the_same_image_as_a_sorted_one() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(BOUNDS);
    for (path, cooperative) in [(RenderPath::Raster, true), (RenderPath::Raster, false), (RenderPath::Forward, true)] {
        scene.settings.path = path;
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.renderer.context().set_cooperative_traversal(cooperative);
        // Few keys, which a GPU compares with each other; more workgroups; more than the 8192 keys for that.
        for (count, offset) in [(200, 0), (3000, 16), (9000, 272)] {
            let particles = repeated_particles(&scene, count);
            let mut drawn = |particles: &[Particle], is_sorted| {
                let buffer = buffer(gpu(), particles, offset, READ);
                let particles = Particles::Buffer(ParticleBuffer {
                    offset,
                    is_sorted,
                    ..ParticleBuffer::new(&buffer, count as u32)
                });
                host.draw_particles(gpu(), &scene, particles).unwrap();
                host.image(gpu()).unwrap()
            };
            let sorted = drawn(&particles, false);
            let unsorted = drawn(&particles, true);
            assert!(unsorted != sorted, "{count}, {path:?}, {cooperative}: the order does not change the image");
            // The camera looks along z. The sort is stable at equal depths.
            let mut back_to_front = particles;
            back_to_front.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
            // The GPU adds up the extent of the smoke in the order of the buffer, so the sums differ by rounding.
            let psnr = psnr(&drawn(&back_to_front, true), &sorted);
            assert!(psnr >= 90.0, "{count}, {path:?}, {cooperative}: {psnr:.1} dB");
        }
    }
    gpu().check().unwrap();
}

#[test]
fn a_gpu_sorts_many_particles_of_the_cpu() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = TestScene::new(SIZE);
    let particles = repeated_particles(&scene, 33_000);
    for path in [RenderPath::Raster, RenderPath::Forward] {
        scene.settings.path = path;
        let mut host = Host::new(gpu(), &scene).unwrap();
        let mut drawn = |cooperative, particles: &[Particle]| {
            host.renderer.context().set_cooperative_traversal(cooperative);
            host.draw_particles(gpu(), &scene, Particles::Slice(particles)).unwrap();
            let sort_buffers = host.renderer.memory_use().tiled.sorted;
            assert_eq!(sort_buffers > 0, cooperative && particles.len() > 32_767, "{path:?}: {sort_buffers} bytes");
            host.image(gpu()).unwrap()
        };
        for count in [9000, particles.len()] {
            // With cooperative traversal, light per pixel is computed in half floats.
            let by_cpu = drawn(false, &particles[..count]);
            let by_gpu = drawn(true, &particles[..count]);
            let psnr = psnr(&by_gpu, &by_cpu);
            assert!(psnr >= 70.0, "{path:?}, {count} particles: {psnr:.1} dB");
        }
    }
    gpu().check().unwrap();
}

/// Buffer with a number that the GPU may have written.
fn number_buffer(number: u32, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let buffer =
        gpu().device.create_buffer(&wgpu::BufferDescriptor { label: None, size: 8, usage, mapped_at_creation: false });
    gpu().queue.write_buffer(&buffer, 4, &number.to_le_bytes());
    buffer
}

#[test]
fn only_living_particles_are_drawn_measured_and_sorted() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(BOUNDS);
    let living = scene.particles.len() as u32;
    let room = scene.particles.len() as u32 + 500;
    let mut particles = scene.particles.clone();
    // Dead particles keep their last state: large, opaque, and in front.
    let dead = Particle { position: vec3(0.0, 0.0, -3.5), radius: 1.0, amount: 1.0, ..Particle::default() };
    particles.resize(room as usize, dead);
    let buffer = buffer(gpu(), &particles, 0, READ);
    let tiled = [(RenderPath::Raster, false), (RenderPath::Forward, false), (RenderPath::Tiled, false)];
    let cases = [(RenderPath::Raster, true), (RenderPath::Forward, true)];
    for (path, is_sorted) in cases.into_iter().chain(tiled.into_iter().filter(|_| is_tiled_available())) {
        scene.settings.path = path;
        let mut host = Host::new(gpu(), &scene).unwrap();
        let mut drawn = |count, alive: Option<u32>| {
            let number = alive.map(|number| number_buffer(number, wgpu::BufferUsages::COPY_SRC));
            let alive = number.as_ref().map(|buffer| AliveCount { buffer, offset: 4 });
            let particles = ParticleBuffer { alive, is_sorted, ..ParticleBuffer::new(&buffer, count) };
            host.draw_particles(gpu(), &scene, Particles::Buffer(particles)).unwrap();
            host.image(gpu()).unwrap()
        };
        let known = drawn(living, None);
        let counted = drawn(room, Some(living));
        // With more workgroups, the GPU adds up the extent of the smoke in another order.
        let psnr = psnr(&counted, &known);
        println!("{path:?}, sorted {is_sorted}: {psnr:.1} dB");
        assert!(psnr >= 90.0, "{path:?}, sorted {is_sorted}: {psnr:.1} dB");
        assert!(drawn(room, None) != counted, "{path:?}, sorted {is_sorted}");
        // A number beyond the room reads no other memory.
        assert!(drawn(living, Some(u32::MAX)) == known, "{path:?}, sorted {is_sorted}");
        assert!(drawn(room, Some(0)).texels.iter().all(|&texel| texel == BACKDROP), "{path:?}, sorted {is_sorted}");
    }
    gpu().check().unwrap();
    for (offset, usage, field) in [
        (2, wgpu::BufferUsages::COPY_SRC, "systems[0].particles.alive.offset"),
        (8, wgpu::BufferUsages::COPY_SRC, "systems[0].particles.alive"),
        (4, wgpu::BufferUsages::STORAGE, "systems[0].particles.alive"),
    ] {
        let number = number_buffer(1, usage);
        let alive = Some(AliveCount { buffer: &number, offset });
        let particles = ParticleBuffer { alive, is_sorted: true, ..ParticleBuffer::new(&buffer, living) };
        let drawn = Host::new(gpu(), &scene).unwrap().draw_particles(gpu(), &scene, Particles::Buffer(particles));
        assert_eq!(rejected_field(drawn), field);
    }
}

#[test]
fn steady_frames_of_unsorted_particles_create_no_gpu_resources() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(BOUNDS);
    let mut host = Host::new(gpu(), &scene).unwrap();
    let buffer = buffer(gpu(), &repeated_particles(&scene, 500), 0, READ);
    let mut draw = |count| {
        let particles = Particles::Buffer(ParticleBuffer::new(&buffer, count));
        host.draw_particles(gpu(), &scene, particles).unwrap();
    };
    draw(500);
    assert_eq!(resource_counter::count(|| (490..495).for_each(&mut draw)), 0);
    let held = host.renderer.memory_use().tiled;
    assert!(held.sorted >= 500 * 32 && held.keys >= 500 * 16 && held.lists == 0, "{held:?}");
    // The sort buffers of a system that no longer needs sorting are released.
    for _ in 0..130 {
        host.draw(gpu(), &scene).unwrap();
    }
    assert_eq!(host.renderer.memory_use().tiled.total(), 0);
}

#[test]
fn host_buffers_that_cannot_be_sorted_are_rejected() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(BOUNDS);
    let refused = |gpu: &Headless, scene: &TestScene, usage, offset| {
        let buffer = buffer(gpu, &scene.particles, offset, usage);
        let count = scene.particles.len() as u32;
        let particles = Particles::Buffer(ParticleBuffer { offset, ..ParticleBuffer::new(&buffer, count) });
        Host::new(gpu, scene).unwrap().draw_particles(gpu, scene, particles)
    };
    let webgl2 = Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty()).unwrap();
    let vertices = wgpu::BufferUsages::VERTEX;
    assert_eq!(rejected_field(refused(&webgl2, &scene, vertices, 0)), "systems[0].particles.is_sorted");
    if is_tiled_available() {
        assert_eq!(rejected_field(refused(gpu(), &scene, vertices, 0)), "systems[0].particles");
        assert_eq!(rejected_field(refused(gpu(), &scene, READ, 4)), "systems[0].particles.offset");
    }
    // Weighted order needs no sorting, so such buffers are accepted.
    scene.settings.accumulate.order = BlendOrder::Weighted;
    for gpu in [&webgl2, gpu()] {
        refused(gpu, &scene, vertices, 4).unwrap();
    }
}

#[test]
fn host_buffer_looks_like_the_same_particles_in_a_slice() {
    if !is_tiled_available() {
        return;
    }
    for (name, path, change) in [
        ("raster", RenderPath::Raster, (|_| {}) as fn(&mut TestScene)),
        ("tiled", RenderPath::Tiled, |_| {}),
        ("forward", RenderPath::Forward, |_| {}),
        ("own space", RenderPath::Raster, |scene| {
            scene.world_from_particles = Mat4::from_rotation_y(0.7) * Mat4::from_scale(Vec3::splat(0.8));
        }),
        ("faint", RenderPath::Raster, |scene| {
            scene.particles.iter_mut().step_by(2).for_each(|particle| particle.amount = 0.02);
        }),
        ("far away", RenderPath::Raster, |scene| {
            scene.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, -800.0));
            scene.view.clip_from_view = rh::proj::directx::perspective(0.012, 16.0 / 9.0, 1.0, 2000.0);
        }),
    ] {
        let mut scene = TestScene::new(SIZE);
        scene.settings.path = path;
        change(&mut scene);
        // The camera looks along z. In this order, the sorted and the unsorted way draw alike, and only light can differ.
        scene.particles.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
        let slice = scene.on_gpu(gpu()).image;
        let tight = particle_bounds(&scene.particles, SpriteExtent::from_settings(&scene.settings));
        // A generous box, as a host without knowledge of its particles gives.
        let center = tight.center();
        let half = 2.0 * (tight.max - tight.min);
        scene.bounds = Some(Bounds { min: center - half, max: center + half });
        let mut host = Host::new(gpu(), &scene).unwrap();
        let buffer = buffer(gpu(), &scene.particles, 0, READ);
        let count = scene.particles.len() as u32;
        let particles = Particles::Buffer(ParticleBuffer::new(&buffer, count));
        host.draw_particles(gpu(), &scene, particles).unwrap();
        gpu().check().unwrap();
        let measured = psnr(&host.image(gpu()).unwrap(), &slice);
        println!("{name}: {measured:.1} dB");
        assert!(measured >= 70.0, "{name}: {measured:.1} dB");
        // A buffer that only the vertex stage may read is lit by its box.
        let vertices = self::buffer(gpu(), &scene.particles, 0, wgpu::BufferUsages::VERTEX);
        if path == RenderPath::Raster && name == "raster" {
            let particles =
                Particles::Buffer(ParticleBuffer { is_sorted: true, ..ParticleBuffer::new(&vertices, count) });
            host.draw_particles(gpu(), &scene, particles).unwrap();
            let unmeasured = psnr(&host.image(gpu()).unwrap(), &slice);
            assert!(unmeasured < 60.0, "{unmeasured:.1} dB: the box alone gives the same image");
        }
    }
}

#[test]
fn first_frame_of_a_host_buffer_after_a_warm_up_compiles_no_pipeline() {
    if !is_tiled_available() {
        return;
    }
    for path in [RenderPath::Raster, RenderPath::Tiled, RenderPath::Forward] {
        let mut scene = TestScene::new(SIZE);
        scene.settings.path = path;
        scene.bounds = Some(BOUNDS);
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.renderer.warm_up(&warm_up(&scene, &[scene.settings])).unwrap();
        let warm = host.renderer.context().pipeline_count();
        let buffer = buffer(gpu(), &scene.particles, 0, READ);
        let count = scene.particles.len() as u32;
        let particles = Particles::Buffer(ParticleBuffer::new(&buffer, count));
        host.draw_particles(gpu(), &scene, particles).unwrap();
        assert_eq!(host.renderer.context().pipeline_count(), warm, "{}", path.name());
    }
}
