//! Particles in the host's buffers, systems by their keys, and what is kept of both.

use glam::{Mat4, UVec2, Vec3, vec3};
use haze::settings::*;
use haze::{Bounds, Error, Frame, Particle, Particles, SceneDepth, Settings, System, View, wgpu};
use haze_demo::headless::Headless;

use super::{SIZE, encoder, field};
use crate::common::gpu;
use crate::host::Host;
use crate::stage::{BACKDROP, Stage};

#[test]
fn a_buffer_may_begin_anywhere() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let mut draw = |offset: u64| {
        let mut bytes = vec![0x7f; offset as usize];
        bytes.extend_from_slice(bytemuck::cast_slice(&stage.particles));
        let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu().queue.write_buffer(&buffer, 0, &bytes);
        let particles =
            Particles::Buffer { buffer: &buffer, offset, count: stage.particles.len() as u32, is_sorted: true };
        host.draw_particles(gpu(), &stage, particles).map(|()| host.picture(gpu()).unwrap())
    };
    let first = draw(0).unwrap();
    assert!(first.texels.iter().any(|&texel| texel != BACKDROP));
    for offset in [4, 32, 100] {
        assert!(draw(offset).unwrap() == first, "{offset}");
    }
}

#[test]
fn offsets_that_do_not_fit_are_refused() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 96,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let mut refused = |offset, count| {
        field(host.draw_particles(gpu(), &stage, Particles::Buffer { buffer: &buffer, offset, count, is_sorted: true }))
    };
    assert_eq!(refused(2, 1), "systems[0].particles.offset");
    assert_eq!(refused(36, 2), "systems[0].particles");
    assert_eq!(refused(u64::MAX - 3, 2), "systems[0].particles");
}

/// Frames of several systems, without a picture.
pub struct Systems {
    host: Host,
    pub stage: Stage,
}

impl Systems {
    pub fn new(gpu: &Headless, size: UVec2) -> Self {
        let stage = Stage::new(size);
        Self { host: Host::new(gpu, &stage).unwrap(), stage }
    }

    pub fn frame(&mut self, gpu: &Headless, systems: &[(u64, &[Particle], Settings)]) -> Result<(), Error> {
        let systems: Vec<_> = systems
            .iter()
            .map(|(key, particles, settings)| System {
                key: *key,
                ..System::new(Particles::Slice(particles), settings, &self.host.material)
            })
            .collect();
        let frame = Frame { systems: &systems, ..Frame::new(self.stage.view, SceneDepth::Linear(&self.host.linear)) };
        let mut encoder = encoder(gpu);
        self.host.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, &frame)?;
        gpu.submit(encoder)
    }

    fn accumulation(&self, key: u64) -> wgpu::TextureView {
        self.host.renderer.targets(key).unwrap().accumulation[0].clone()
    }
}

/// Longer than a renderer keeps what it does not need.
const LONG: u32 = 125;

#[test]
fn a_system_is_known_by_its_key() {
    let mut systems = Systems::new(gpu(), SIZE);
    let settings = Settings::default();
    let wide = systems.stage.particles.clone();
    let small = [Particle { position: vec3(0.0, 0.0, -6.0), radius: 0.2, ..Particle::default() }];
    systems.frame(gpu(), &[(7, &wide, settings), (9, &small, settings)]).unwrap();
    let targets = [systems.accumulation(7), systems.accumulation(9)];
    // Another order, and one of them gone for a while: each keeps its own.
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    systems.frame(gpu(), &[(9, &small, settings)]).unwrap();
    assert!(systems.host.renderer.targets(7).is_none());
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    assert_eq!(targets, [systems.accumulation(7), systems.accumulation(9)]);
    let twice = systems.frame(gpu(), &[(9, &small, settings), (9, &wide, settings)]);
    assert_eq!(field(twice), "systems[1].key");
}

#[test]
fn what_is_no_longer_needed_is_given_back() {
    let mut systems = Systems::new(gpu(), UVec2::new(1280, 720));
    let settings = Settings::default();
    let few = systems.stage.particles[..2].to_vec();
    // One over the whole view, and many that are uploaded but out of it.
    let mut near = vec![Particle { position: vec3(0.0, 0.0, 9.0), radius: 0.1, ..Particle::default() }; 20_000];
    near[0] = Particle { position: vec3(0.0, 0.0, -1.0), radius: 4.0, amount: 0.1, ..Particle::default() };
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    let small = systems.host.renderer.memory_use();
    systems.frame(gpu(), &[(1, &near, settings)]).unwrap();
    let spike = systems.host.renderer.memory_use();
    assert!(spike.targets > 4 * small.targets && spike.buffers > 100_000, "{small:?} {spike:?}");
    // Not at once: the next spike may be near.
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    assert_eq!(systems.host.renderer.memory_use(), spike);
    for _ in 0..LONG {
        systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    }
    assert_eq!(systems.host.renderer.memory_use(), small);
    // A system behind the viewer keeps no targets, one that is gone keeps nothing.
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
fn baked_light_outlives_a_resize() {
    let mut stage = Stage::new(SIZE);
    stage.settings.diffuse.mode = DiffuseMode::Cubemap;
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.draw(gpu(), &stage).unwrap();
    let views = |host: &Host| {
        let targets = host.renderer.targets(0).unwrap();
        (targets.accumulation.to_vec(), targets.baked_diffuse.to_vec())
    };
    let (small, baked) = views(&host);
    assert_eq!(baked.len(), 6);
    stage.view = Stage::new(SIZE * 4).view;
    let mut larger = Host::new(gpu(), &stage).unwrap();
    std::mem::swap(&mut larger.renderer, &mut host.renderer);
    std::mem::swap(&mut larger.material, &mut host.material);
    larger.draw(gpu(), &stage).unwrap();
    let (large, still_baked) = views(&larger);
    assert!(small != large && baked == still_baked);
}

#[test]
fn a_depth_buffer_that_the_host_replaces_is_let_go() {
    // A device of its own, whose memory can be counted.
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
        let mut stage = Stage::new(SIZE);
        (stage.settings.accumulate.depth_source, stage.settings.accumulate.scale) = (source, 1);
        let mut host = Host::new(&gpu, &stage).unwrap();
        host.draw(&gpu, &stage).unwrap();
        let before = allocated();
        for _ in 0..3 {
            // The renderer goes to a new host, with new textures; the old ones go.
            let mut next = Host::new(&gpu, &stage).unwrap();
            std::mem::swap(&mut next.renderer, &mut host.renderer);
            std::mem::swap(&mut next.material, &mut host.material);
            host = next;
            host.draw(&gpu, &stage).unwrap();
        }
        assert_eq!(allocated(), before, "{}", source.name());
    }
}

#[test]
fn a_view_of_the_whole_target_needs_no_origin() {
    let view = View::new(Mat4::IDENTITY, Mat4::IDENTITY, SIZE);
    assert_eq!(view.origin, UVec2::ZERO);
}
