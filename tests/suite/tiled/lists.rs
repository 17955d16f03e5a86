//! Sprite lists of the path `tiled`: overflow, sizes beyond 32 bits, sprites out of view, and steady frames.

use glam::{UVec2, vec3};
use haze::{Bounds, Particle, ParticleBuffer, Particles, shader, wgpu};
use haze_core::formula::uniforms::TilesUniform;
use haze_core::settings::*;

use super::{scene, storage_buffer};
use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::psnr;
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::TestScene;

#[test]
fn bins_draw_all_sprites_while_their_lists_overflow() {
    if !is_tiled_available() {
        return;
    }
    // Every sprite touches every bin. The renderer computes that for a slice, but assumes less for a buffer, so at
    // first lists overflow.
    let mut scene = scene(Technique::Soft);
    let size = UVec2::new(960, 540);
    scene.view = TestScene::new(size).view;
    scene.settings.accumulate.downscale = 1;
    let wide = |index: u32| Particle {
        position: vec3(0.0, 0.0, -6.0 - 0.001 * index as f32),
        radius: 12.0,
        amount: 0.01,
        ..Particle::default()
    };
    scene.particles = (0..140).rev().map(wide).collect();
    scene.bounds = Some(Bounds { min: vec3(-12.0, -12.0, -6.2), max: vec3(12.0, 12.0, -5.9) });
    let buffer = storage_buffer(bytemuck::cast_slice(&scene.particles));
    let count = scene.particles.len() as u32;
    for cooperative in [true, false] {
        scene.host.exact_filtering = cooperative;
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.renderer.context().set_cooperative_traversal(cooperative);
        let mut image = |path| {
            scene.settings.path = path;
            host.draw_particles(gpu(), &scene, Particles::Buffer(ParticleBuffer::new(&buffer, count))).unwrap();
            (host.image(gpu()).unwrap(), host.renderer.memory_use().tiled.lists)
        };
        let (raster, _) = image(RenderPath::Raster);
        let (first, held) = image(RenderPath::Tiled);
        let (second, held_then) = image(RenderPath::Tiled);
        assert!(held_then > held, "the list buffer has not grown from {held} bytes");
        assert!(first == second);
        // The blend unit rounds each of the 140 layers.
        let apart = psnr(&first, &raster);
        assert!(apart >= 50.0, "{apart} dB against raster");
        let mut known = Host::new(gpu(), &scene).unwrap();
        known.renderer.context().set_cooperative_traversal(cooperative);
        known.draw(gpu(), &scene).unwrap();
        let lists = known.renderer.memory_use().tiled.lists;
        known.draw(gpu(), &scene).unwrap();
        assert_eq!(known.renderer.memory_use().tiled.lists, lists);
    }
    gpu().check().unwrap();
}

#[test]
fn steady_frames_of_the_tiled_path_create_no_resources() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Tiled;
    let mut host = Host::new(gpu(), &scene).unwrap();
    for cooperative in [true, false] {
        host.renderer.context().set_cooperative_traversal(cooperative);
        host.draw(gpu(), &scene).unwrap();
        let created = resource_counter::count(|| {
            for frame in 0..5 {
                // Fewer sprites, at other positions.
                scene.particles.truncate(60 - frame);
                scene.particles.iter_mut().for_each(|particle| particle.position.x += 0.001);
                host.draw(gpu(), &scene).unwrap();
            }
        });
        assert_eq!(created, 0);
    }
    // A system that is no longer tiled releases its buffers.
    let held = host.renderer.memory_use().buffers;
    scene.settings.path = RenderPath::Raster;
    for _ in 0..130 {
        host.draw(gpu(), &scene).unwrap();
    }
    assert!(host.renderer.memory_use().buffers < held / 4);
}

#[test]
fn sprites_out_of_view_do_not_change_the_image() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Tiled;
    scene.bounds = Some(Bounds { min: vec3(-3.0, -2.0, -7.0), max: vec3(3.0, 2.0, -3.0) });
    // More than 2^15 sprites, so that several dispatches build the lists.
    let small = |index: u32| Particle {
        position: vec3(
            (index % 200) as f32 * 0.02 - 2.0,
            (index / 200) as f32 * 0.01 - 1.0,
            -4.0 - (index % 7) as f32 * 0.3,
        ),
        radius: 0.03,
        amount: 0.2,
        ..Particle::default()
    };
    let shown: Vec<_> = (0..33_000).map(small).collect();
    let behind = |particle: &Particle| Particle { position: particle.position * -1.0, ..*particle };
    let hidden: Vec<_> = shown.iter().map(behind).collect();
    let both = shown.iter().zip(&hidden).flat_map(|(shown, hidden)| [*shown, *hidden]).collect();
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.renderer.context().set_cooperative_traversal(true);
    let [shown, both, hidden, none] = [shown, both, hidden, Vec::new()].map(|particles| {
        scene.particles = particles;
        host.draw(gpu(), &scene).unwrap();
        host.image(gpu()).unwrap()
    });
    assert!(shown == both && hidden == none && shown != none);
}

#[test]
fn list_sizes_beyond_32_bits_do_not_wrap() {
    if !is_tiled_available() {
        return;
    }
    let gpu = gpu();
    let source = shader::compose(shader::source("tile_bin.wgsl").unwrap()).unwrap();
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("allocate_per_invocation"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    // Each bin also needs 32 words for its sprites' visibility. The first two lists take more than 2^32 words in total,
    // the others 74.
    let lengths = [3_000_000_000_u32, 1_294_967_292, 4, 6];
    let tiles = TilesUniform { count: 9, columns: 2, rows: 2, runs: 1, capacity: 40, ..TilesUniform::default() };
    let buffer = |bytes: &[u8], usage| {
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let size = bytes.len() as u64;
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        let buffer = gpu.device.create_buffer(&descriptor);
        gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let uniform = wgpu::BufferUsages::UNIFORM;
    let storage = wgpu::BufferUsages::STORAGE;
    let uniform = buffer(bytemuck::bytes_of(&tiles), uniform);
    let [counts, bins, tally] = [bytemuck::cast_slice(&lengths), &[0; 32], bytemuck::cast_slice(&[9_u32, 0])]
        .map(|bytes| buffer(bytes, storage));
    let bound = [(0, &uniform), (3, &counts), (5, &bins), (6, &tally)];
    let entries = bound.map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    let layout = pipeline.get_bind_group_layout(0);
    let group =
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.submit(encoder).unwrap();
    let words = |buffer| bytemuck::pod_collect_to_vec::<u8, u32>(&gpu.read_buffer(buffer).unwrap());
    // A list that exceeds its fraction of the 32-bit counter is not allocated.
    assert_eq!(words(&tally)[1], 74);
    let bins = words(&bins);
    assert_eq!((bins[0], bins[2]), (u32::MAX, u32::MAX));
    assert!(bins[4] != u32::MAX || bins[6] != u32::MAX, "neither fits: {bins:?}");
    for (bin, length) in bins.chunks(2).zip(lengths) {
        match bin[0] {
            u32::MAX => assert_eq!(bin[1], 9, "a bin without a list must read all sprites"),
            first => assert!(bin[1] == length && first + length + 32 <= 40, "{bins:?}"),
        }
    }
}
