//! The path `tiled`: the picture of `raster` and of the reference, whatever the settings, and however workgroups walk.

use glam::camera::rh::proj::directx;
use glam::{UVec2, Vec3, Vec4, vec3};
#[cfg(feature = "app")]
use haze::builtin;
#[cfg(feature = "app")]
use haze::demo::shot::Shot;
use haze::emitter::{Emitter, EmitterShape};
use haze::formula::uniforms::TilesUniform;
use haze::headless::Headless;
use haze::picture::Picture;
use haze::settings::*;
use haze::sprite::{Sprite, SpriteLayout};
use haze::{
    Bounds, Error, Particle, Particles, PathCosts, PathModel, PathModelSource, PathReason, TiledMemory, shader, wgpu,
};

use crate::common::{AGREEMENT, STEP_AGREEMENT, gpu, has_tiles, psnr};
use crate::creations;
use crate::host::{Host, as_floats};
use crate::stage::Stage;
use crate::techniques;

/// Of the picture of `raster`, dB: they differ by what the blend unit rounds, layer by layer.
const TO_RASTER: f32 = 55.0;
/// Of the reference's, which rounds as the blend unit does.
const TO_REFERENCE: f32 = AGREEMENT;

fn stage(technique: Technique) -> Stage {
    let mut stage = techniques::stage(technique);
    stage.settings.accumulate.layers = Layers::All;
    stage
}

/// The walk alone has the sampler's own filter.
fn drawn(stage: &Stage, path: Path, in_step: bool) -> Picture<Vec4> {
    let mut stage = stage.clone();
    (stage.settings.path, stage.host.exact_filtering) = (path, in_step);
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.renderer.context().walk_in_step(in_step);
    host.draw(gpu(), &stage).unwrap();
    gpu().check().unwrap();
    host.picture(gpu()).unwrap()
}

fn agreement(name: &str, stage: &Stage) {
    let steps = stage.settings.sprite.debug_sprite;
    for in_step in [true, false] {
        let [tiled, raster] = [Path::Tiled, Path::Raster].map(|path| drawn(stage, path, in_step));
        let (to_raster, to_reference) = (psnr(&tiled, &raster), psnr(&tiled, &stage.on_cpu()));
        println!("{name}, in step {in_step}: {to_raster:.1} dB of raster, {to_reference:.1} dB of the reference");
        assert!(to_raster >= if steps { STEP_AGREEMENT } else { TO_RASTER }, "{name}: {to_raster:.1} dB of raster");
        let least = if steps { STEP_AGREEMENT } else { TO_REFERENCE };
        assert!(!in_step || to_reference >= least, "{name}: {to_reference:.1} dB of the reference");
    }
}

#[test]
fn every_technique_is_the_same_on_tiles() {
    if !has_tiles() {
        return;
    }
    for &technique in Technique::ALL {
        let name = technique.name();
        agreement(name, &stage(technique));
        let mut always = stage(technique);
        always.settings.soft_fade.curve = FadeCurve::Always;
        agreement(&format!("{name} always"), &always);
        let mut host_depth = stage(technique);
        let accumulate = &mut host_depth.settings.accumulate;
        (accumulate.depth_source, accumulate.scale) = (DepthSource::Host, 1);
        agreement(&format!("{name} host depth"), &host_depth);
        let mut orthographic = stage(technique);
        orthographic.view.clip_from_view = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
        agreement(&format!("{name} orthographic"), &orthographic);
    }
}

#[test]
fn every_way_to_accumulate_is_the_same_on_tiles() {
    if !has_tiles() {
        return;
    }
    type Change = fn(&mut Stage);
    let changes: [(&str, Change); 9] = [
        ("weighted", |s| s.settings.accumulate.order = Order::Weighted),
        ("biased", |s| s.settings.accumulate.encoding = NormalEncoding::Biased),
        ("weighted and biased", |s| {
            s.settings.accumulate.order = Order::Weighted;
            s.settings.accumulate.encoding = NormalEncoding::Biased;
        }),
        ("light of the target", |s| s.settings.accumulate.lighting_resolution = LightingResolution::Target),
        ("scale 3", |s| s.settings.accumulate.scale = 3),
        ("drawn three times", |s| {
            s.settings.sprite.debug_loop = 3;
            s.settings.accumulate.opacity = 0.2;
        }),
        ("checks", |s| s.settings.sprite.debug_sprite = true),
        ("motion", |s| s.settings.sprite.motion = 1.0),
        // Most of the sprites over the borders, some round the eye.
        ("near", |s| s.particles.iter_mut().for_each(|p| p.position.z += 5.5)),
    ];
    for (name, change) in changes {
        let mut stage = stage(Technique::Soft);
        change(&mut stage);
        agreement(name, &stage);
    }
}

#[test]
fn eight_bits_are_rounded_once() {
    if !has_tiles() {
        return;
    }
    // Where each layer is rounded the sum stalls, which the path `tiled` does not know.
    let mut stage = stage(Technique::Soft);
    let accumulate = &mut stage.settings.accumulate;
    (accumulate.format, accumulate.encoding) = (AccumulationFormat::Rgba8Unorm, NormalEncoding::Biased);
    stage.shade_tree = ShadeTree::Amount;
    let mut exact = stage.clone();
    exact.settings.accumulate.format = AccumulationFormat::Rgba16Float;
    let exact = exact.on_cpu();
    let [tiled, raster] = [Path::Tiled, Path::Raster].map(|path| psnr(&drawn(&stage, path, true), &exact));
    println!("8 bits: tiled {tiled:.1} dB, raster {raster:.1} dB");
    assert!(tiled >= 50.0 && tiled > raster, "{tiled} {raster}");
}

#[test]
fn what_cannot_be_seen_is_left_out() {
    if !has_tiles() {
        return;
    }
    // A stack of layers, opaque after some twenty.
    let mut stage = stage(Technique::Soft);
    let layer = |index: u32| Particle {
        position: vec3(0.0, 0.0, -4.0 - 0.01 * index as f32),
        radius: 3.0,
        amount: 0.5,
        rotation: index as f32,
        ..Particle::default()
    };
    stage.particles = (0..400).map(layer).collect();
    for in_step in [true, false] {
        stage.settings.accumulate.layers = Layers::All;
        let all = drawn(&stage, Path::Tiled, in_step);
        stage.settings.accumulate.layers = Layers::Visible;
        let visible = drawn(&stage, Path::Tiled, in_step);
        let apart = psnr(&visible, &all);
        println!("visible: {apart:.1} dB of all");
        // A thousandth of the light, at the most.
        assert!((55.0..150.0).contains(&apart), "{apart}");
    }
}

#[cfg(feature = "app")]
#[test]
fn every_preset_is_the_same_on_tiles() {
    if !has_tiles() {
        return;
    }
    let renderer = |shot: &Shot, path, layers| {
        let mut shot = shot.clone();
        for system in &mut shot.preset.systems {
            system.settings.path = path;
            system.settings.accumulate.layers = layers;
        }
        shot.render_on_gpu(gpu(), false).unwrap()
    };
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, UVec2::new(320, 180)).unwrap();
        let mut behind = shot.clone();
        behind.preset.systems.clear();
        behind.materials.clear();
        let behind = renderer(&behind, Path::Raster, Layers::All);
        let raster = renderer(&shot, Path::Raster, Layers::All);
        for &layers in Layers::ALL {
            let tiled = renderer(&shot, Path::Tiled, layers);
            let apart = crate::common::psnr_over([&tiled, &raster], [&behind, &behind]);
            println!("{}, {} layers: {apart:.1} dB", preset.name, layers.name());
            assert!(apart >= TO_RASTER, "{}: {apart:.1} dB", preset.name);
        }
    }
}

#[test]
fn a_run_gives_the_same_bits_and_needs_no_order() {
    if !has_tiles() {
        return;
    }
    let mut stage = stage(Technique::Soft);
    // More than a block of the sort, many at one depth, some hidden.
    let all = |index: u32| {
        let mut particle = stage.particles[index as usize % 60];
        particle.position.x += 0.001 * (index / 60) as f32;
        particle.amount *= 0.1;
        if index.is_multiple_of(7) {
            particle.amount = 0.0;
        }
        particle
    };
    let all: Vec<_> = (0..3000_u32).map(all).collect();
    stage.particles.clone_from(&all);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    (stage.settings.path, stage.host.exact_filtering) = (Path::Tiled, false);
    let mut host = Host::new(gpu(), &stage).unwrap();
    for in_step in [true, false] {
        host.renderer.context().walk_in_step(in_step);
        let picture = |host: &mut Host| {
            host.draw(gpu(), &stage).unwrap();
            host.picture(gpu()).unwrap()
        };
        let first = picture(&mut host);
        assert!(picture(&mut host) == first);
        // From a buffer they are sorted by the GPU, whoever walks.
        let mut buffered = |particles: &[Particle], offset: u64| {
            let mut bytes = vec![0x7f; offset as usize];
            bytes.extend_from_slice(bytemuck::cast_slice(particles));
            let buffer = storage_buffer(&bytes);
            let particles = Particles::Buffer { buffer: &buffer, offset, count: particles.len() as u32 };
            host.draw_particles(gpu(), &stage, particles).unwrap();
            host.picture(gpu()).unwrap()
        };
        // Those at one depth stay as they are.
        let mut sorted = all.clone();
        sorted.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
        let sorted = buffered(&sorted, 0);
        for offset in [0, 16, 272] {
            assert!(buffered(&all, offset) == sorted, "{offset}");
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
fn lists_that_find_no_room_are_drawn_all_the_same() {
    if !has_tiles() {
        return;
    }
    // Every sprite in every bin: at first the lists hold a part of that.
    let mut stage = stage(Technique::Soft);
    let size = UVec2::new(960, 540);
    (stage.view, stage.settings.accumulate.scale) = (Stage::new(size).view, 1);
    let wide = |index: u32| Particle {
        position: vec3(0.0, 0.0, -6.0 - 0.001 * index as f32),
        radius: 12.0,
        amount: 0.01,
        ..Particle::default()
    };
    stage.particles = (0..140).map(wide).collect();
    for in_step in [true, false] {
        let raster = drawn(&stage, Path::Raster, in_step);
        (stage.settings.path, stage.host.exact_filtering) = (Path::Tiled, in_step);
        let mut host = Host::new(gpu(), &stage).unwrap();
        host.renderer.context().walk_in_step(in_step);
        let mut picture = || {
            host.draw(gpu(), &stage).unwrap();
            (host.picture(gpu()).unwrap(), host.renderer.memory_use().buffers)
        };
        let (first, held) = picture();
        let (second, held_then) = picture();
        assert!(held_then > held, "the lists have not grown from {held} bytes");
        assert!(first == second);
        // The blend unit has rounded a hundred layers.
        let apart = psnr(&first, &raster);
        assert!(apart >= 50.0, "{apart}");
    }
    gpu().check().unwrap();
}

#[test]
fn steady_frames_on_tiles_create_nothing() {
    if !has_tiles() {
        return;
    }
    let mut stage = stage(Technique::Soft);
    stage.settings.path = Path::Tiled;
    let mut host = Host::new(gpu(), &stage).unwrap();
    for in_step in [true, false] {
        host.renderer.context().walk_in_step(in_step);
        host.draw(gpu(), &stage).unwrap();
        let created = creations::count(|| {
            for frame in 0..5 {
                // Fewer sprites, elsewhere.
                stage.particles.truncate(60 - frame);
                stage.particles.iter_mut().for_each(|particle| particle.position.x += 0.001);
                host.draw(gpu(), &stage).unwrap();
            }
        });
        assert_eq!(created, 0);
    }
    // What is not tiled any more gives its buffers back.
    let held = host.renderer.memory_use().buffers;
    stage.settings.path = Path::Raster;
    for _ in 0..130 {
        host.draw(gpu(), &stage).unwrap();
    }
    assert!(host.renderer.memory_use().buffers < held / 4);
}

#[test]
fn what_cannot_be_tiled_is_refused() {
    let mut stage = stage(Technique::Soft);
    stage.settings.path = Path::Tiled;
    let refused = |result: Result<(), Error>| match result {
        Err(Error::Field(error)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let webgl2 = Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty()).unwrap();
    let mut host = Host::new(&webgl2, &stage).unwrap();
    let message = refused(host.draw(&webgl2, &stage));
    assert!(message.contains("systems[0].settings.path") && message.contains("raster"), "{message}");
    stage.settings.path = Path::Auto;
    host.draw(&webgl2, &stage).unwrap();
    if !has_tiles() {
        return;
    }
    stage.settings.path = Path::Tiled;
    stage.bounds = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let buffer = storage_buffer(&[0; 128]);
    let particles = Particles::Buffer { buffer: &buffer, offset: 4, count: 1 };
    let message = refused(host.draw_particles(gpu(), &stage, particles));
    assert!(message.contains("particles.offset") && message.contains("16"), "{message}");
    let vertices = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 128,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let particles = Particles::Buffer { buffer: &vertices, offset: 0, count: 1 };
    let message = refused(host.draw_particles(gpu(), &stage, particles));
    assert!(message.contains("STORAGE"), "{message}");
}

/// An emitter before the stage's camera.
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
fn an_emitter_is_evaluated_where_it_is_drawn() {
    if !has_tiles() {
        return;
    }
    for shape in [EmitterShape::Sphere, EmitterShape::Box, EmitterShape::Disc] {
        let emitter = Emitter { shape, ..emitter() };
        for time in [0.3, 7.0, 10_000.0] {
            let emission = emitter.at(time);
            let mut stage = stage(Technique::Soft);
            emission.evaluate(&mut stage.particles);
            // Those of the slice, so that both are lit at one place.
            stage.bounds = Some(emission.bounds(stage.settings.reach()));
            stage.settings.accumulate.order = Order::Sorted;
            let mut host = Host::new(gpu(), &stage).unwrap();
            let particles = stage.particles.clone();
            let mut drawn = |path, particles| {
                stage.settings.path = path;
                host.draw_particles(gpu(), &stage, particles).unwrap();
                host.picture(gpu()).unwrap()
            };
            let tiled = drawn(Path::Tiled, Particles::Emission(&emission));
            assert!(drawn(Path::Tiled, Particles::Emission(&emission)) == tiled, "not the same again");
            let raster = drawn(Path::Raster, Particles::Emission(&emission));
            let slice = drawn(Path::Tiled, Particles::Slice(&particles));
            let (to_raster, to_slice) = (psnr(&tiled, &raster), psnr(&tiled, &slice));
            println!("{shape:?} at {time}: {to_raster:.1} dB of raster, {to_slice:.1} dB of the slice");
            assert!(to_raster >= TO_RASTER && to_slice >= 70.0, "{to_raster} {to_slice}");
        }
    }
    gpu().check().unwrap();
}

#[test]
fn a_million_particles_never_are_on_the_cpu_and_fit_into_200_megabytes() {
    if !has_tiles() {
        return;
    }
    let emitter = Emitter { rate: 100_000.0, lifetime: 8.7, lifetime_spread: 0.2, radius_end: 0.02, ..emitter() };
    emitter.validate(String::new).unwrap();
    let emission = emitter.at(60.0);
    assert!((1_000_000..=haze::emitter::MAX_PARTICLES + 2).contains(&emission.count()), "{}", emission.count());
    let mut stage = stage(Technique::Soft);
    (stage.settings.path, stage.settings.accumulate.scale) = (Path::Tiled, 2);
    stage.view = Stage::new(UVec2::new(1920, 1080)).view;
    let mut host = Host::new(gpu(), &stage).unwrap();
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    host.prepare(gpu(), &mut encoder, &stage, Particles::Emission(&emission)).unwrap();
    let memory = host.renderer.memory_use();
    println!("{memory:?}");
    let TiledMemory { emitted, sprites, keys, counts, lists } = memory.tiled;
    assert!([emitted, sprites, keys, counts, lists].iter().all(|&bytes| bytes > 1 << 20), "{memory:?}");
    assert_eq!(memory.tiled.total(), emitted + sprites + keys + counts + lists);
    assert!(memory.buffers >= memory.tiled.total() && memory.targets > 960 * 540 * 8);
    assert!(memory.targets + memory.buffers <= 200_000_000, "{memory:?}");
    // Nothing of it was sorted or uploaded.
    assert!(memory.buffers - memory.tiled.total() < 1 << 16, "{memory:?}");
    gpu().check().unwrap();
}

#[test]
fn two_hundred_faint_layers_add_up() {
    if !has_tiles() {
        return;
    }
    const LAYERS: usize = 256;
    // Full of amount but for the border.
    let mut sheet = image::RgbaImage::from_pixel(64, 64, image::Rgba([128, 128, 255, 255]));
    for i in 0..64 {
        for (x, y) in [(i, 0), (i, 63), (0, i), (63, i)] {
            sheet.put_pixel(x, y, image::Rgba([128, 128, 255, 0]));
        }
    }
    let mut stage = stage(Technique::Hard);
    let sprite = Sprite::from_picture(std::path::Path::new("full"), &sheet, SpriteLayout::default()).unwrap();
    stage.material.sprite = sprite;
    stage.settings.accumulate.scale = 1;
    let particle = Particle { position: vec3(0.0, 0.0, -3.0), radius: 4.0, amount: 0.02, ..Particle::default() };
    stage.particles = vec![particle; LAYERS];
    // The sum in f64, front to back.
    let mut through = 1.0_f64;
    for _ in 0..LAYERS {
        through *= 1.0 - f64::from(particle.amount);
    }
    let oracle = 1.0 - through;
    let mut decibels = |path, format, encoding| {
        stage.settings.path = path;
        (stage.settings.accumulate.format, stage.settings.accumulate.encoding) = (format, encoding);
        let mut host = Host::new(gpu(), &stage).unwrap();
        host.draw(gpu(), &stage).unwrap();
        let targets = host.renderer.targets(0).unwrap();
        let texels = as_floats(gpu(), targets.accumulation[0].texture());
        let (width, size) = (texels.width(), targets.size);
        let texels = gpu().read_rgba16float(&texels).unwrap();
        // The middle of the picture.
        let (mut squares, mut count) = (0.0, 0);
        for y in size.y / 4..size.y * 3 / 4 {
            for x in size.x / 4..size.x * 3 / 4 {
                squares += (f64::from(texels[(y * width + x) as usize].w) - oracle).powi(2);
                count += 1;
            }
        }
        -10.0 * (squares / f64::from(count)).max(1.0e-12).log10()
    };
    let (half, byte) = (AccumulationFormat::Rgba16Float, AccumulationFormat::Rgba8Unorm);
    let tiled = decibels(Path::Tiled, half, NormalEncoding::Signed);
    let tiled_byte = decibels(Path::Tiled, byte, NormalEncoding::Biased);
    let raster = decibels(Path::Raster, half, NormalEncoding::Signed);
    let raster_byte = decibels(Path::Raster, byte, NormalEncoding::Biased);
    println!("tiled {tiled:.1} dB, 8 bits {tiled_byte:.1}; raster {raster:.1}, 8 bits {raster_byte:.1}");
    assert!(tiled >= 60.0, "{tiled}");
    // A step of 8 bits is 48 dB, its rounding 59.
    assert!(tiled_byte >= 50.0, "{tiled_byte}");
    assert!(raster_byte < 30.0, "blending in 8 bits sticks: {raster_byte}");
}

#[test]
fn lists_of_more_than_32_bits_can_count_do_not_wrap() {
    if !has_tiles() {
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
        entry_point: Some("allocate_alone"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    // The first two come to 2^32 words and more, three for each; the others to 30.
    let lengths = [3_000_000_000_u32, 1_294_967_292, 4, 6];
    let tiles = TilesUniform { count: 9, columns: 2, rows: 2, runs: 1, capacity: 20, ..TilesUniform::default() };
    let buffer = |bytes: &[u8], usage| {
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let size = bytes.len() as u64;
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        let buffer = gpu.device.create_buffer(&descriptor);
        gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let (uniform, storage) = (wgpu::BufferUsages::UNIFORM, wgpu::BufferUsages::STORAGE);
    let uniform = buffer(bytemuck::bytes_of(&tiles), uniform);
    let [counts, bins, tally] = [bytemuck::cast_slice(&lengths), &[0; 32], bytemuck::cast_slice(&[9_u32, 0])]
        .map(|bytes| buffer(bytes, storage));
    let bound = [(0, &uniform), (5, &counts), (7, &bins), (8, &tally)];
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
    // Those that are longer than their share of 32 bits are left out.
    assert_eq!(words(&tally)[1], 30);
    let bins = words(&bins);
    assert_eq!((bins[0], bins[2]), (u32::MAX, u32::MAX));
    assert!(bins[4] != u32::MAX || bins[6] != u32::MAX, "neither fits: {bins:?}");
    for (bin, length) in bins.chunks(2).zip(lengths) {
        match bin[0] {
            u32::MAX => assert_eq!(bin[1], 9, "it reads all sprites"),
            first => assert!(bin[1] == length && first + 3 * length <= 20, "{bins:?}"),
        }
    }
}

#[test]
fn auto_takes_what_is_cheaper_and_says_why() {
    if !has_tiles() {
        return;
    }
    let mut stage = stage(Technique::Soft);
    stage.settings.path = Path::Auto;
    let mut host = Host::new(gpu(), &stage).unwrap();
    let class = host.renderer.context().path_model();
    let dear = |costs: PathCosts| PathCosts { fragment: 1.0e3, ..costs };
    // The first frame takes what is cheaper at once.
    let models = [(dear(class.raster), class.tiled, Path::Tiled), (class.raster, dear(class.tiled), Path::Raster)];
    for (raster, tiled, path) in models {
        let mut host = Host::new(gpu(), &stage).unwrap();
        let model = PathModel { raster, tiled, source: PathModelSource::Host };
        host.renderer.context().set_path_model(model).unwrap();
        assert_eq!(host.renderer.path_choice(0), None);
        host.draw(gpu(), &stage).unwrap();
        let choice = host.renderer.path_choice(0).unwrap();
        assert_eq!(choice.path, path);
        let PathReason::Expected { raster_ms, tiled_ms, layers: Some(layers), source } = choice.reason else {
            panic!("{choice}")
        };
        assert_eq!((raster_ms < tiled_ms, source), (path == Path::Raster, PathModelSource::Host));
        // As the renderer counts them, but for the part of the target that the box does not cover.
        let counted = host.renderer.overdraw().mean() as f32;
        assert!((0.5..1.1).contains(&(layers / counted)), "{layers} {counted}");
        assert!(choice.to_string().contains("overdraw"), "{choice}");
        assert_eq!(host.renderer.memory_use().tiled.total() > 0, path == Path::Tiled);
    }
    // A buffer that compute shaders cannot read is drawn all the same.
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    host.renderer.context().set_path_model(PathModel { raster: dear(class.raster), ..class }).unwrap();
    host.draw_buffer(gpu(), &stage, &stage.particles).unwrap();
    let choice = host.renderer.path_choice(0).unwrap();
    assert_eq!((choice.path, choice.reason), (Path::Raster, PathReason::BufferOfVertices));
    let bytes: Vec<u8> = bytemuck::cast_slice(&stage.particles).to_vec();
    let (buffer, count) = (storage_buffer(&bytes), stage.particles.len() as u32);
    host.draw_particles(gpu(), &stage, Particles::Buffer { buffer: &buffer, offset: 0, count }).unwrap();
    let choice = host.renderer.path_choice(0).unwrap();
    assert!(choice.path == Path::Tiled && choice.to_string().contains("unknown, taken for 16"), "{choice}");
    // No choice, no reason.
    stage.settings.path = Path::Raster;
    host.draw(gpu(), &stage).unwrap();
    assert_eq!(host.renderer.path_choice(0), None);
    let model = PathModel { raster: PathCosts { entry: -1.0, ..class.raster }, ..class };
    let message = host.renderer.context().set_path_model(model).unwrap_err().to_string();
    assert_eq!(message, "raster.entry: -1 is not valid; expected nanoseconds, 0 or more");
    gpu().check().unwrap();
}

#[test]
fn auto_changes_seldom_and_then_creates_a_few_things_once() {
    if !has_tiles() {
        return;
    }
    let mut stage = stage(Technique::Soft);
    stage.settings.path = Path::Auto;
    let mut host = Host::new(gpu(), &stage).unwrap();
    let model = host.renderer.context().path_model();
    let set = |host: &Host, raster: f32, tiled: f32| {
        let costs = |fragment| PathCosts { frame: 0.0, texel: 0.0, sprite: 0.0, entry: 0.0, fragment, ..model.raster };
        let model = PathModel { raster: costs(raster), tiled: costs(tiled), source: PathModelSource::Host };
        host.renderer.context().set_path_model(model).unwrap();
    };
    let path = |host: &Host| host.renderer.path_choice(0).unwrap().path;
    set(&host, 1.0, 100.0);
    host.draw(gpu(), &stage).unwrap();
    assert_eq!(path(&host), Path::Raster);
    // What seems better every other frame never is.
    let created = creations::count(|| {
        for frame in 0..80 {
            set(&host, [1.0, 100.0][frame % 2], [100.0, 1.0][frame % 2]);
            host.draw(gpu(), &stage).unwrap();
            assert_eq!(path(&host), Path::Raster);
        }
    });
    assert_eq!(created, 0);
    set(&host, 100.0, 1.0);
    let frames = (0..200).take_while(|_| {
        host.draw(gpu(), &stage).unwrap();
        path(&host) == Path::Raster
    });
    assert!((20..60).contains(&frames.count()));
    let created = creations::count(|| (0..5).for_each(|_| host.draw(gpu(), &stage).unwrap()));
    assert_eq!(created, 0);
}

#[test]
fn a_probe_measures_both_paths() {
    if !has_tiles() {
        return;
    }
    let stage = stage(Technique::Soft);
    let host = Host::new(gpu(), &stage).unwrap();
    let context = host.renderer.context();
    let before = context.path_model();
    let model = context.measure_paths(&gpu().device, &gpu().queue, |encoder| gpu().submit(encoder)).unwrap();
    assert_eq!((model, model.source), (context.path_model(), PathModelSource::Probe));
    // Whatever the machine, no millisecond a fragment, and no two thousand a picosecond.
    for costs in [model.raster, model.tiled] {
        assert!((1.0e-4..1.0e6).contains(&costs.fragment), "{costs:?}");
    }
    assert!(before.source != PathModelSource::Probe);
    gpu().check().unwrap();
}
