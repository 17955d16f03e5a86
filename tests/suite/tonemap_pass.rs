//! Compares the tonemap on the GPU, for windows, with the tonemap on the CPU, for files.

use glam::{UVec2, Vec4};
use haze::wgpu;
use haze_core::settings::{DebugView, Tonemap};
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{TonemapPass, TonemapUniform, display_transform, tonemap};

use crate::gpu::gpu;
use crate::presets::offscreen_context;
use crate::resource_counter;
use crate::test_host::convert_to_rgba16float;

const SIZE: UVec2 = UVec2::new(160, 90);

/// Tonemaps two rendered shots on the GPU into a rectangle inside a larger target; returns the rectangle's pixels,
/// sRGB-encoded.
fn tonemap_on_gpu(a: (&OffscreenRenderer, &Shot), b: (&OffscreenRenderer, &Shot), shown: TonemapUniform) -> Vec<Vec4> {
    let device = &gpu().device;
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let tonemap_pass = TonemapPass::new(device, format);
    let image = |(renderer, shot): (&OffscreenRenderer, &Shot)| renderer.image(shot.debug_view).unwrap().clone();
    let tonemap_bindings = tonemap_pass.bind(device, &image(a), &image(b));
    let offset = UVec2::new(13, 7);
    let screen = gpu().target("screen", SIZE + 2 * offset, format);
    let origin = offset.as_vec2();
    let size = SIZE.as_vec2();
    let uniform = TonemapUniform { origin, size, ..shown }.with_transforms([a.1, b.1].map(display_transform));
    tonemap_pass.prepare(&gpu().queue, &tonemap_bindings, &uniform);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("screen"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &screen.create_view(&wgpu::TextureViewDescriptor::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::RED), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_viewport(origin.x, origin.y, size.x, size.y, 0.0, 1.0);
        pass.set_scissor_rect(offset.x, offset.y, SIZE.x, SIZE.y);
        tonemap_pass.record(&mut pass, &tonemap_bindings);
    }
    gpu().submit(encoder).unwrap();
    let whole = gpu().read_rgba16float(&convert_to_rgba16float(gpu(), &screen)).unwrap();
    let width = screen.width();
    let inside = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| ((y + offset.y) * width + x + offset.x) as usize));
    inside.map(|index| whole[index]).collect()
}

fn shot(preset: &str, debug_view: DebugView) -> (OffscreenRenderer, Shot) {
    let mut renderer = OffscreenRenderer::new(offscreen_context(), true).unwrap();
    let mut shot = Shot { debug_view, ..Shot::load(preset, SIZE).unwrap() };
    shot.preset.camera.exposure = 0.7;
    renderer.draw(gpu(), &shot).unwrap();
    (renderer, shot)
}

#[test]
fn window_shows_the_same_pixels_as_a_written_file() {
    let curves = Tonemap::ALL.iter().map(|&tonemap| (DebugView::Final, tonemap));
    for (debug_view, tonemap_curve) in curves.chain([(DebugView::Normals, Tonemap::Neutral)]) {
        let (renderer, mut shot) = shot("column", debug_view);
        shot.preset.camera.tonemap = tonemap_curve;
        let written = tonemap(&renderer.read(gpu(), &shot).unwrap(), &shot);
        let shown = tonemap_on_gpu((&renderer, &shot), (&renderer, &shot), TonemapUniform::default());
        let mut off = 0;
        for (written, shown) in written.pixels().zip(shown) {
            for (written, shown) in written.0.into_iter().zip(shown.to_array()) {
                let apart = (f32::from(written) - shown * 255.0).abs();
                assert!(apart < 1.5, "file {written}, window {}", shown * 255.0);
                off += u32::from(apart > 0.5);
            }
        }
        // The driver's power function may round to the other side of a half.
        assert!(off < SIZE.element_product() / 100, "{off} channels differ");
    }
}

#[test]
fn split_and_difference_views_combine_both_images() {
    let a = shot("column", DebugView::Final);
    let b = shot("column", DebugView::Amount);
    let alone =
        |of: &(OffscreenRenderer, Shot)| tonemap_on_gpu((&of.0, &of.1), (&of.0, &of.1), TonemapUniform::default());
    let left = alone(&a);
    let right = alone(&b);
    let both = |shown| tonemap_on_gpu((&a.0, &a.1), (&b.0, &b.1), shown);
    let split = both(TonemapUniform { split: 60.0, ..TonemapUniform::default() });
    for (index, texel) in split.iter().enumerate() {
        let is_left = index as u32 % SIZE.x < 60;
        assert_eq!(*texel, if is_left { left[index] } else { right[index] });
    }
    let differing = both(TonemapUniform { difference: 2.0, ..TonemapUniform::default() });
    for ((texel, a), b) in differing.iter().zip(&left).zip(&right) {
        // Two dithered 8-bit roundings, doubled by `difference`.
        let expected = ((*a - *b).abs() * 2.0).min(Vec4::ONE);
        assert!((*texel - expected).truncate().abs().max_element() < 6.5 / 255.0, "{texel}, expected {expected}");
    }
}

#[test]
fn renderers_of_one_context_share_uploaded_images() {
    let context = OffscreenContext::new(&gpu().adapter, &gpu().device, &gpu().queue);
    let shot = Shot::load("column", SIZE).unwrap();
    let drawn = || {
        let mut renderer = OffscreenRenderer::new(&context, true).unwrap();
        let created = resource_counter::count(|| {
            renderer.draw(gpu(), &shot).unwrap();
        });
        (renderer, created)
    };
    // The first draw compiles all pipelines.
    let (first, _) = drawn();
    let (second, beside) = drawn();
    drop((first, second));
    // No renderer that holds the uploads is left, so they are made again.
    let (_, alone) = drawn();
    assert!(beside < alone, "created {beside} objects beside another renderer, {alone} alone");
}
