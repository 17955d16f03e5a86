//! The path `tiled`: the picture of `raster` and of the reference, whatever the settings, and however workgroups walk.

mod auto;
mod emission;
mod lists;

use std::sync::LazyLock;

use glam::UVec2;
use glam::camera::rh::proj::directx;
use glam::{Vec3, Vec4, vec3};
use haze::builtin;
use haze::picture::Picture;
use haze::settings::*;
use haze::sprite::{Sprite, SpriteLayout};
use haze::{Bounds, Context, Error, Particle, Particles, wgpu};
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;

use crate::common::{AGREEMENT, STEP_AGREEMENT, gpu, has_tiles, psnr};
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

fn walking(in_step: bool) -> Context {
    let context = Context::new(&gpu().device, &gpu().queue, None);
    context.walk_in_step(in_step);
    context
}

/// The walk alone has the sampler's own filter.
fn drawn(stage: &Stage, path: Path, in_step: bool) -> Picture<Vec4> {
    let mut stage = stage.clone();
    (stage.settings.path, stage.host.exact_filtering) = (path, in_step);
    static CONTEXTS: [LazyLock<Context>; 2] = [LazyLock::new(|| walking(false)), LazyLock::new(|| walking(true))];
    let mut host = Host::on(gpu(), &stage, Some(&CONTEXTS[usize::from(in_step)])).unwrap();
    host.draw(gpu(), &stage).unwrap();
    gpu().check().unwrap();
    host.picture(gpu()).unwrap()
}

pub fn agreement(name: &str, stage: &Stage) {
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
        crate::presets::drawn(&shot, false)
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
            let particles =
                Particles::Buffer { buffer: &buffer, offset, count: particles.len() as u32, is_sorted: false };
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
    let particles = Particles::Buffer { buffer: &buffer, offset: 4, count: 1, is_sorted: false };
    let message = refused(host.draw_particles(gpu(), &stage, particles));
    assert!(message.contains("particles.offset") && message.contains("16"), "{message}");
    let vertices = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 128,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let particles = Particles::Buffer { buffer: &vertices, offset: 0, count: 1, is_sorted: false };
    let message = refused(host.draw_particles(gpu(), &stage, particles));
    assert!(message.contains("STORAGE"), "{message}");
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
