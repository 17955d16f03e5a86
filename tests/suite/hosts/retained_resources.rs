//! Particles in host buffers, systems identified by keys, and the GPU resources that are kept for them.

use glam::{Mat4, UVec2, Vec3, vec3};
use haze::{Bounds, FrameInput, Particle, ParticleBuffer, ParticleSystem, Particles, SceneDepth, Settings, View, wgpu};
use haze_core::error::Error;
use haze_core::settings::*;
use haze_demo::headless::Headless;

use super::{SIZE, encoder, rejected_field};
use crate::gpu::gpu;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

#[test]
fn offset_of_particles_in_a_host_buffer_does_not_change_the_image() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &scene).unwrap();
    let mut draw = |offset: u64| {
        let mut bytes = vec![0x7f; offset as usize];
        bytes.extend_from_slice(bytemuck::cast_slice(&scene.particles));
        let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu().queue.write_buffer(&buffer, 0, &bytes);
        let particles = Particles::Buffer(ParticleBuffer {
            offset,
            is_sorted: true,
            ..ParticleBuffer::new(&buffer, scene.particles.len() as u32)
        });
        host.draw_particles(gpu(), &scene, particles).map(|()| host.image(gpu()).unwrap())
    };
    let first = draw(0).unwrap();
    assert!(first.texels.iter().any(|&texel| texel != BACKDROP));
    for offset in [4, 32, 100] {
        assert!(draw(offset).unwrap() == first, "{offset}");
    }
}

#[test]
fn invalid_offsets_in_a_host_buffer_are_rejected() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let mut host = Host::new(gpu(), &scene).unwrap();
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 96,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let mut refused = |offset, count| {
        rejected_field(host.draw_particles(
            gpu(),
            &scene,
            Particles::Buffer(ParticleBuffer { offset, is_sorted: true, ..ParticleBuffer::new(&buffer, count) }),
        ))
    };
    assert_eq!(refused(2, 1), "systems[0].particles.offset");
    assert_eq!(refused(36, 2), "systems[0].particles");
    assert_eq!(refused(u64::MAX - 3, 2), "systems[0].particles");
}

/// Prepares frames of several systems, without drawing an image.
pub struct SystemsFixture {
    host: Host,
    pub scene: TestScene,
}

impl SystemsFixture {
    pub fn new(gpu: &Headless, size: UVec2) -> Self {
        let scene = TestScene::new(size);
        Self { host: Host::new(gpu, &scene).unwrap(), scene }
    }

    pub fn frame(&mut self, gpu: &Headless, systems: &[(u64, &[Particle], Settings)]) -> Result<(), Error> {
        let systems: Vec<_> = systems
            .iter()
            .map(|(key, particles, settings)| {
                ParticleSystem::new(*key, Particles::Slice(particles), settings, &self.host.material)
            })
            .collect();
        let frame =
            FrameInput { systems: &systems, ..FrameInput::new(self.scene.view, SceneDepth::Linear(&self.host.linear)) };
        let mut encoder = encoder(gpu);
        self.host.renderer.prepare(&mut encoder, &frame)?;
        gpu.submit(encoder)
    }

    fn accumulation(&self, key: u64) -> wgpu::TextureView {
        self.host.renderer.targets(key).unwrap().accumulation[0].clone()
    }
}

/// Number of frames after which a renderer has released resources that it no longer needs.
const LONG: u32 = 125;

#[test]
fn systems_in_another_order_keep_their_targets_by_key() {
    let mut systems = SystemsFixture::new(gpu(), SIZE);
    let settings = Settings::default();
    let wide = systems.scene.particles.clone();
    let small = [Particle { position: vec3(0.0, 0.0, -6.0), radius: 0.2, ..Particle::default() }];
    systems.frame(gpu(), &[(7, &wide, settings), (9, &small, settings)]).unwrap();
    let targets = [systems.accumulation(7), systems.accumulation(9)];
    // Each system keeps its targets when the order changes and when a system is absent for a frame.
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    systems.frame(gpu(), &[(9, &small, settings)]).unwrap();
    assert!(systems.host.renderer.targets(7).is_none());
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    assert_eq!(targets, [systems.accumulation(7), systems.accumulation(9)]);
    let twice = systems.frame(gpu(), &[(9, &small, settings), (9, &wide, settings)]);
    assert_eq!(rejected_field(twice), "systems[1].key");
}

#[test]
fn unused_targets_and_buffers_are_released_after_some_frames() {
    let mut systems = SystemsFixture::new(gpu(), UVec2::new(1280, 720));
    let settings = Settings::default();
    let few = systems.scene.particles[..2].to_vec();
    // One particle covers the whole view; the others are uploaded but outside the view.
    let mut near = vec![Particle { position: vec3(0.0, 0.0, 9.0), radius: 0.1, ..Particle::default() }; 20_000];
    near[0] = Particle { position: vec3(0.0, 0.0, -1.0), radius: 4.0, amount: 0.1, ..Particle::default() };
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    let small = systems.host.renderer.memory_use();
    systems.frame(gpu(), &[(1, &near, settings)]).unwrap();
    let spike = systems.host.renderer.memory_use();
    assert!(spike.targets > 4 * small.targets && spike.buffers > 100_000, "{small:?} {spike:?}");
    // Memory is not released at once, because another spike may follow soon.
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    assert_eq!(systems.host.renderer.memory_use(), spike);
    for _ in 0..LONG {
        systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    }
    assert_eq!(systems.host.renderer.memory_use(), small);
    // A system behind the viewer keeps no targets; a system that is removed keeps nothing.
    let behind: Vec<_> = few.iter().map(|p| Particle { position: -p.position, ..*p }).collect();
    for _ in 0..LONG {
        systems.frame(gpu(), &[(1, &behind, settings)]).unwrap();
    }
    assert_eq!(systems.host.renderer.memory_use().targets, 0);
    for _ in 0..LONG {
        systems.frame(gpu(), &[]).unwrap();
    }
    let view_only = systems.host.renderer.memory_use();
    assert!(view_only.targets == 0 && view_only.buffers < 1000, "{view_only:?}");
}

#[test]
fn baked_light_textures_are_kept_when_the_view_is_resized() {
    let mut scene = TestScene::new(SIZE);
    scene.settings.diffuse.mode = DiffuseMode::Cubemap;
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let views = |host: &Host| {
        let targets = host.renderer.targets(0).unwrap();
        (targets.accumulation.to_vec(), targets.baked_diffuse.to_vec())
    };
    let (small, baked) = views(&host);
    assert_eq!(baked.len(), 6);
    scene.view = TestScene::new(SIZE * 4).view;
    let mut larger = Host::new(gpu(), &scene).unwrap();
    std::mem::swap(&mut larger.renderer, &mut host.renderer);
    std::mem::swap(&mut larger.material, &mut host.material);
    larger.draw(gpu(), &scene).unwrap();
    let (large, still_baked) = views(&larger);
    assert!(small != large && baked == still_baked);
}

#[test]
fn depth_buffer_replaced_by_the_host_is_released() {
    // A separate device, so that its allocated memory can be counted.
    let gpu = Headless::new().unwrap();
    let allocated = || {
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        gpu.device.generate_allocator_report().map(|report| report.total_allocated_bytes)
    };
    let read_only = haze::read_only_depth_is_supported(&gpu.device);
    for source in [DepthSource::Reduced, DepthSource::Host] {
        if source == DepthSource::Host && !read_only {
            continue;
        }
        let mut scene = TestScene::new(SIZE);
        scene.settings.accumulate.depth_source = source;
        scene.settings.accumulate.downscale = 1;
        let mut host = Host::new(&gpu, &scene).unwrap();
        host.draw(&gpu, &scene).unwrap();
        let before = allocated();
        for _ in 0..3 {
            // The renderer is moved to a new host with new textures; the old textures are dropped.
            let mut next = Host::new(&gpu, &scene).unwrap();
            std::mem::swap(&mut next.renderer, &mut host.renderer);
            std::mem::swap(&mut next.material, &mut host.material);
            host = next;
            host.draw(&gpu, &scene).unwrap();
        }
        assert_eq!(allocated(), before, "{}", source.name());
    }
}

#[test]
fn new_view_begins_at_the_origin_of_the_target() {
    let view = View::new(Mat4::IDENTITY, Mat4::IDENTITY, SIZE);
    assert_eq!(view.origin, UVec2::ZERO);
}
