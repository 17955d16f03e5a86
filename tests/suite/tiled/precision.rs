//! Precision of the accumulated sums: half floats and 8 bits, on both paths.

use glam::vec3;
use haze::Particle;
use haze_core::assets::image::Image;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::settings::*;

use super::{render_with, scene};
use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr, psnr_over};
use crate::test_host::{Host, convert_to_rgba16float};

#[test]
fn tiled_path_rounds_eight_bit_targets_only_once() {
    if !is_tiled_available() {
        return;
    }
    // Raster rounds after every layer, so the sum stalls. The path `tiled` sums in f32 and rounds once.
    let mut scene = scene(Technique::Soft);
    let accumulate = &mut scene.settings.accumulate;
    accumulate.format = AccumulationFormat::Rgba8Unorm;
    accumulate.encoding = NormalEncoding::Biased;
    scene.debug_view = DebugView::Amount;
    let mut exact = scene.clone();
    exact.settings.accumulate.format = AccumulationFormat::Rgba16Float;
    let exact = exact.on_cpu();
    let black = Image::new(exact.size, scene.backdrop());
    let [tiled, raster] = [RenderPath::Tiled, RenderPath::Raster]
        .map(|path| psnr_over([&render_with(&scene, path, true), &exact], [&black, &black]));
    println!("8 bits: tiled {tiled:.1} dB, raster {raster:.1} dB");
    assert!(tiled >= 50.0 && tiled > raster, "tiled {tiled} dB, raster {raster} dB");
}

/// Smoke of thin layers, which 8 bits change most. The CPU renderer rounds once for `tiled` and every layer for `raster`.
/// Blend units round in ways of their own: compared with the CPU renderer, llvmpipe gives 51 dB and an NVIDIA H200 45;
/// rounding once instead of every layer gives 42.7.
#[test]
fn cpu_renderer_rounds_thin_smoke_as_the_path_does() {
    let mut scene = scene(Technique::Soft);
    scene.particles.iter_mut().for_each(|particle| particle.amount *= 0.03);
    scene.settings.boost = 12.0;
    let accumulate = &mut scene.settings.accumulate;
    accumulate.format = AccumulationFormat::Rgba8Unorm;
    accumulate.encoding = NormalEncoding::Biased;
    let paths = [RenderPath::Raster, RenderPath::Tiled].map(|path| {
        scene.settings.path = path;
        (path, scene.on_cpu())
    });
    println!("the paths differ by {:.1} dB", psnr(&paths[0].1, &paths[1].1));
    for (path, on_cpu) in &paths {
        if *path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        let psnr = psnr(&render_with(&scene, *path, true), on_cpu);
        println!("{}: {psnr:.1} dB", path.name());
        let least = if *path == RenderPath::Tiled { MIN_PSNR } else { 44.0 };
        assert!(psnr >= least, "{}: {psnr:.1} dB", path.name());
    }
}

#[test]
fn two_hundred_faint_layers_add_up() {
    if !is_tiled_available() {
        return;
    }
    const LAYERS: usize = 256;
    // Opaque except for the border, which must be clear.
    let mut sheet = image::RgbaImage::from_pixel(64, 64, image::Rgba([128, 128, 255, 255]));
    for i in 0..64 {
        for (x, y) in [(i, 0), (i, 63), (0, i), (63, i)] {
            sheet.put_pixel(x, y, image::Rgba([128, 128, 255, 0]));
        }
    }
    let mut scene = scene(Technique::Hard);
    let sprite = Sprite::from_image(std::path::Path::new("full"), &sheet, SpriteLayout::default()).unwrap();
    scene.material.sprite = sprite;
    scene.settings.accumulate.downscale = 1;
    let particle = Particle { position: vec3(0.0, 0.0, -3.0), radius: 4.0, amount: 0.02, ..Particle::default() };
    scene.particles = vec![particle; LAYERS];
    // The sum in f64, front to back.
    let mut through = 1.0_f64;
    for _ in 0..LAYERS {
        through *= 1.0 - f64::from(particle.amount);
    }
    let oracle = 1.0 - through;
    let mut decibels = |path, format, encoding| {
        scene.settings.path = path;
        scene.settings.accumulate.format = format;
        scene.settings.accumulate.encoding = encoding;
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.draw(gpu(), &scene).unwrap();
        let targets = host.renderer.targets(0).unwrap();
        let texels = convert_to_rgba16float(gpu(), targets.accumulation[0].texture());
        let width = texels.width();
        let size = targets.size;
        let texels = gpu().read_rgba16float(&texels).unwrap();
        // The middle of the image.
        let mut squares = 0.0;
        let mut count = 0;
        for y in size.y / 4..size.y * 3 / 4 {
            for x in size.x / 4..size.x * 3 / 4 {
                squares += (f64::from(texels[(y * width + x) as usize].w) - oracle).powi(2);
                count += 1;
            }
        }
        -10.0 * (squares / f64::from(count)).max(1.0e-12).log10()
    };
    let half = AccumulationFormat::Rgba16Float;
    let byte = AccumulationFormat::Rgba8Unorm;
    let tiled = decibels(RenderPath::Tiled, half, NormalEncoding::Signed);
    let tiled_byte = decibels(RenderPath::Tiled, byte, NormalEncoding::Biased);
    let raster = decibels(RenderPath::Raster, half, NormalEncoding::Signed);
    let raster_byte = decibels(RenderPath::Raster, byte, NormalEncoding::Biased);
    println!("tiled {tiled:.1} dB, 8 bits {tiled_byte:.1}; raster {raster:.1}, 8 bits {raster_byte:.1}");
    assert!(tiled >= 60.0, "tiled {tiled} dB");
    // A step of 8 bits is 48 dB; the rounding error of 8 bits is 59 dB.
    assert!(tiled_byte >= 50.0, "tiled, 8 bits: {tiled_byte} dB");
    assert!(raster_byte < 30.0, "expected 8-bit blending to stall below 30 dB: {raster_byte}");
}
