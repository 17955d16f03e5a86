//! Compares bloom on the GPU with bloom on the CPU, and changed shaders with both.

use glam::{UVec2, UVec3, Vec4, Vec4Swizzles};
use half::f16;
use haze::wgpu;
use haze_core::assets::image::Image;
use haze_core::assets::noise::{pcg3d, unit};
use haze_demo::bloom::add_bloom;
use haze_demo::bloom_pass::{BLOOM_SHADER, BloomPass};

use crate::gpu::gpu;
use crate::presets::{offscreen_context, render_on_gpu};
use haze_demo::offscreen_renderer::OffscreenRenderer;
use haze_demo::shot::Shot;

/// Odd sides, which levels do not divide.
const SIZE: UVec2 = UVec2::new(75, 41);
const STRENGTH: f32 = 0.3;

/// Noise as dim as a scene, and a few sparks.
fn image() -> Image<Vec4> {
    let mut image = Image::new(SIZE, Vec4::W);
    image.for_each(|at, texel| {
        let random = pcg3d(UVec3::new(at.x, at.y, 5));
        let spark = if random.z.is_multiple_of(97) { 300.0 } else { 1.0 };
        let light = Vec4::new(unit(random.x), unit(random.y), unit(random.z), 0.0) * spark;
        // As half floats hold it.
        *texel = light.map(|channel| f16::from_f32(channel).to_f32()).xyz().extend(0.5);
    });
    image
}

fn on_gpu(shader: &str, image: &Image<Vec4>) -> Vec<Vec4> {
    let gpu = gpu();
    let pass = BloomPass::new(&gpu.device, shader);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("image"),
        size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let channels = image.texels.iter().flat_map(|texel| texel.to_array());
    let bytes: Vec<_> = channels.flat_map(|channel| f16::from_f32(channel).to_le_bytes()).collect();
    gpu.queue.write_texture(
        texture.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * SIZE.x), rows_per_image: None },
        texture.size(),
    );
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    pass.record(&mut encoder, &pass.levels(&texture), STRENGTH);
    gpu.submit(encoder).unwrap();
    gpu.read_rgba16float(&texture).unwrap()
}

/// Largest difference of two images, relative to the brightness around it.
fn largest_error(texels: &[Vec4], expected: &Image<Vec4>) -> f32 {
    let error = |(texel, expected): (&Vec4, &Vec4)| ((texel - expected) / expected.abs().max(Vec4::splat(0.1))).abs();
    texels.iter().zip(&expected.texels).map(error).fold(0.0, |most, error| most.max(error.max_element()))
}

#[test]
fn bloom_on_the_gpu_is_that_on_the_cpu_and_changed_shaders_differ() {
    let image = image();
    let mut expected = image.clone();
    add_bloom(&mut expected, STRENGTH);
    // Roundings to half floats, one for each level.
    const TOLERANCE: f32 = 4.0e-3;
    let error = largest_error(&on_gpu(BLOOM_SHADER, &image), &expected);
    assert!(error < TOLERANCE, "{error}");
    for (code, mutant) in [
        ("vec4f(1.0, 3.0, 3.0, 1.0)", "vec4f(2.0, 2.0, 2.0, 2.0)"),
        ("vec2i(x, y) - 1", "vec2i(x, y)"),
        ("at / 2", "(at + 1) / 2"),
        ("(at & vec2i(1)) * 2 - 1", "1 - (at & vec2i(1)) * 2"),
        ("row * 3.0 + next_row", "row + next_row * 3.0"),
        ("vec2i(0, aside.y)", "vec2i(aside.x, aside.y)"),
    ] {
        assert!(BLOOM_SHADER.contains(code), "{code}");
        let error = largest_error(&on_gpu(&BLOOM_SHADER.replace(code, mutant), &image), &expected);
        assert!(error > 2.0 * TOLERANCE, "{mutant}: {error}");
    }
}

#[test]
fn light_beyond_half_floats_stays_finite() {
    let mut image = image();
    image.texels[700] = Vec4::new(f32::INFINITY, 6.5e4, 3.0, 1.0);
    let texels = on_gpu(BLOOM_SHADER, &image);
    let others = texels.iter().enumerate().filter(|(index, _)| *index != 700);
    assert!(others.clone().all(|(_, texel)| texel.is_finite()), "infinite light spreads");
}

#[test]
fn a_picture_with_bloom_is_the_same_on_gpu_and_cpu_and_can_lose_it() {
    let mut shot = Shot::load("campfire", UVec2::new(160, 90)).unwrap();
    let plain = render_on_gpu(&shot, true);
    shot.preset.camera.bloom = 0.2;
    let expected = shot.render_on_cpu().unwrap();
    let mut renderer = OffscreenRenderer::new(offscreen_context(), true).unwrap();
    renderer.draw(gpu(), &shot).unwrap();
    let bloomed = renderer.read(gpu(), &shot).unwrap();
    let mean = |image: &Image<Vec4>| image.texels.iter().map(|texel| texel.xyz().element_sum()).sum::<f32>();
    let apart = |a: &Image<Vec4>, b: &Image<Vec4>| {
        let sum: f32 = a.texels.iter().zip(&b.texels).map(|(a, b)| (a - b).xyz().abs().element_sum()).sum();
        sum / mean(b)
    };
    assert!(apart(&bloomed, &expected) < 0.01, "{}", apart(&bloomed, &expected));
    assert!(apart(&bloomed, &plain) > 0.05, "{}", apart(&bloomed, &plain));
    assert!((mean(&bloomed) / mean(&plain) - 1.0).abs() < 0.03, "{}", mean(&bloomed) / mean(&plain));
    shot.preset.camera.bloom = 0.0;
    renderer.draw(gpu(), &shot).unwrap();
    assert!(renderer.read(gpu(), &shot).unwrap().texels == plain.texels);
}
