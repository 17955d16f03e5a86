//! Compares the camera's passes, smooth edges and hot air, on the GPU with those on the CPU, and changed shaders with both.

use glam::{Mat4, UVec2, UVec3, Vec3, Vec4, Vec4Swizzles, vec3};
use half::f16;
use haze::{Light, View, wgpu};
use haze_core::assets::image::Image;
use haze_core::assets::noise::{pcg3d, unit};
use haze_demo::antialiasing::{ANTIALIASING_SHADER, antialiased};
use haze_demo::heat_haze::{HEAT_HAZE_SHADER, HeatHaze};
use haze_demo::image_pass::ImagePass;
use haze_demo::offscreen_renderer::OffscreenRenderer;
use haze_demo::shot::Shot;

use crate::gpu::gpu;
use crate::presets::{offscreen_context, render_on_gpu};

const SIZE: UVec2 = UVec2::new(96, 72);

fn view() -> View {
    let clip_from_view = glam::camera::rh::proj::directx::perspective(0.8, 96.0 / 72.0, 0.1, 100.0);
    View::new(Mat4::from_translation(vec3(0.0, 0.0, -6.0)), clip_from_view, SIZE)
}

/// Two fires, of which one is partly outside the image, at a time long after the start. Stronger than a camera allows, so that
/// shifts are several of these few pixels.
fn hot_air() -> HeatHaze {
    let fire = |x: f32, radius: f32| Light { position: vec3(x, -1.2, 0.0), radius, ..Light::default() };
    HeatHaze::new(&view(), &[fire(-0.4, 0.7), fire(2.8, 0.4)], 4.0, 86_400.3).unwrap()
}

/// True for posts in front of the air.
fn is_in_front(at: UVec2) -> bool {
    at.y > 30 && at.x % 6 < 2
}

/// Light and depth of a scene with posts in front of the air.
fn scene() -> (Image<Vec4>, Image<f32>) {
    let mut image = Image::new(SIZE, Vec4::W);
    image.for_each(|at, texel| {
        let random = pcg3d(UVec3::new(at.x / 3, at.y / 3, 9));
        let light = Vec4::new(unit(random.x), unit(random.y), unit(random.z), 1.0);
        // As half floats hold it.
        *texel = light.map(|channel| f16::from_f32(channel).to_f32());
    });
    let clip = view().clip_from_view;
    let ndc = |depth: f32| clip.project_point3(vec3(0.0, 0.0, -depth)).z;
    let mut depth = Image::new(SIZE, 1.0);
    depth.for_each(|at, texel| *texel = ndc(if is_in_front(at) { 3.0 } else { 5.6 + 0.01 * at.x as f32 }));
    (image, depth)
}

fn upload(texture: &wgpu::Texture, bytes: &[u8]) {
    let bytes_per_row = Some(bytes.len() as u32 / texture.height());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
    gpu().queue.write_texture(texture.as_image_copy(), bytes, layout, texture.size());
}

fn on_gpu(shader: &str, uniform: &[u8], image: &Image<Vec4>, depth: &Image<f32>) -> Vec<Vec4> {
    let gpu = gpu();
    let scene_depth = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    upload(&scene_depth, bytemuck::cast_slice(&depth.texels));
    let pass = ImagePass::new(&gpu.device, &gpu.queue, shader);
    let scene_depth = scene_depth.create_view(&wgpu::TextureViewDescriptor::default());
    let inputs = pass.inputs(SIZE, &scene_depth, uniform.len());
    let channels = image.texels.iter().flat_map(|texel| texel.to_array());
    let light: Vec<_> = channels.flat_map(|channel| f16::from_f32(channel).to_le_bytes()).collect();
    upload(&inputs.image, &light);
    let target = gpu.target("through the pass", SIZE, wgpu::TextureFormat::Rgba16Float);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    pass.record(&mut encoder, &inputs, uniform, &target);
    gpu.submit(encoder).unwrap();
    gpu.read_rgba16float(&target).unwrap()
}

/// Mean difference of the colors of two images.
fn apart(texels: &[Vec4], expected: &Image<Vec4>) -> f32 {
    let sum: f32 = texels.iter().zip(&expected.texels).map(|(a, b)| (a - b).xyz().abs().element_sum()).sum();
    sum / texels.len() as f32
}

#[test]
fn hot_air_on_the_gpu_is_that_on_the_cpu_and_changed_shaders_differ() {
    let haze = hot_air();
    let (image, depth) = scene();
    let expected = haze.distorted(&image, &depth);
    assert!(apart(&image.texels, &expected) > 0.004, "{}", apart(&image.texels, &expected));
    // Roundings to half floats, and of positions.
    const TOLERANCE: f32 = 1.0e-3;
    let uniform = bytemuck::bytes_of(&haze);
    let error = apart(&on_gpu(HEAT_HAZE_SHADER, uniform, &image, &depth), &expected);
    assert!(error < TOLERANCE, "{error}");
    for (code, mutant) in [
        ("1.0 + along)", "1.0)"),
        ("inside * inside", "inside"),
        ("(1.0 - along)", "1.0"),
        ("plume.thickness + 0.5", "plume.thickness"),
        ("largest = max(largest,", "largest = min(largest,"),
        ("t = f * f * (3.0 - 2.0 * f)", "t = f"),
        ("octave * PERIOD", "octave"),
        ("vec3f(0.0, haze.phase)", "vec3f(haze.phase, 0.0)"),
        ("0.5 * noise(", "noise("),
        ("vec3f(2.0, 2.0, 1.0)", "vec3f(2.0)"),
        ("floor(position - 0.5)", "floor(position)"),
        ("view_depth_at(moved)", "view_depth_at(pixel)"),
    ] {
        assert!(HEAT_HAZE_SHADER.contains(code), "{code}");
        let shader = HEAT_HAZE_SHADER.replace(code, mutant);
        let error = apart(&on_gpu(&shader, uniform, &image, &depth), &expected);
        assert!(error > 1.5 * TOLERANCE, "{mutant}: {error}");
    }
}

#[test]
fn what_is_in_front_of_hot_air_stays() {
    let (image, depth) = scene();
    let seen = hot_air().distorted(&image, &depth);
    let in_front = |index: usize| is_in_front(UVec2::new(index as u32 % SIZE.x, index as u32 / SIZE.x));
    let moved = |index: &usize| image.texels[*index] != seen.texels[*index];
    assert_eq!((0..image.texels.len()).filter(|index| in_front(*index)).filter(moved).count(), 0);
    assert!((0..image.texels.len()).filter(moved).count() > 500);
}

#[test]
fn without_fire_or_strength_there_is_no_hot_air() {
    let fire = Light { position: Vec3::ZERO, radius: 0.5, ..Light::default() };
    let behind = Light { position: vec3(0.0, 0.0, 9.0), ..fire };
    assert!(HeatHaze::new(&view(), &[fire], 0.0, 1.0).is_none());
    assert!(HeatHaze::new(&view(), &[behind], 1.0, 1.0).is_none());
    assert!(HeatHaze::new(&view(), &[], 1.0, 1.0).is_none());
    assert!(HeatHaze::new(&view(), &[fire; 20], 1.0, 1.0).is_some());
}

#[test]
fn an_image_with_both_passes_is_the_same_on_gpu_and_cpu_and_can_lose_them() {
    let mut shot = Shot::load("campfire", UVec2::new(160, 90)).unwrap();
    shot.preset.camera.heat_haze = 0.0;
    shot.preset.camera.antialiasing = false;
    let plain = render_on_gpu(&shot, true);
    shot.preset.camera.heat_haze = 1.0;
    shot.preset.camera.antialiasing = true;
    let expected = shot.render_on_cpu().unwrap();
    let mut renderer = OffscreenRenderer::new(offscreen_context(), true).unwrap();
    renderer.draw(gpu(), &shot).unwrap();
    let seen = renderer.read(gpu(), &shot).unwrap();
    assert!(apart(&seen.texels, &expected) < 0.25 * apart(&seen.texels, &plain), "{}", apart(&seen.texels, &expected));
    shot.preset.camera.heat_haze = 0.0;
    shot.preset.camera.antialiasing = false;
    renderer.draw(gpu(), &shot).unwrap();
    assert!(renderer.read(gpu(), &shot).unwrap().texels == plain.texels);
}

/// A bright line, three pixels thick, that is not smooth: of 30 times the brightness of what is behind it.
fn spark(slope: f32) -> Image<Vec4> {
    let mut image = Image::new(SIZE, Vec4::W);
    image.for_each(|at, texel| {
        let aside = at.y as f32 - 36.0 - slope * (at.x as f32 - 48.0);
        *texel = if aside.abs() < 1.5 { vec3(12.0, 6.0, 2.0) } else { vec3(0.4, 0.3, 0.3) }.extend(1.0);
        *texel = texel.map(|channel| f16::from_f32(channel).to_f32());
    });
    image
}

#[test]
fn antialiasing_on_the_gpu_is_that_on_the_cpu_and_changed_shaders_differ() {
    let mut image = spark(0.3);
    // Light beyond half floats, and next to nothing.
    image.texels[500] = Vec4::new(f32::INFINITY, 6.5e4, 3.0, 1.0);
    image.texels[700] = Vec4::W;
    let depth = Image::new(SIZE, 1.0);
    let expected = antialiased(&image);
    // Relative to the brightness: an error in compressed light grows with it.
    let apart = |texels: &[Vec4]| {
        let error = |(a, b): (&Vec4, &Vec4)| ((a - b).xyz() / b.xyz().max(Vec3::splat(0.1))).abs().element_sum();
        texels.iter().zip(&expected.texels).filter(|(_, b)| b.is_finite()).map(error).sum::<f32>() / texels.len() as f32
    };
    const TOLERANCE: f32 = 1.0e-3;
    let error = apart(&on_gpu(ANTIALIASING_SHADER, &[], &image, &depth));
    assert!(error < TOLERANCE, "{error}");
    for (code, mutant) in [
        ("/ (1.0 + max(color.r", "/ (2.0 + max(color.r"),
        ("max(1.0 - max(color.r", "max(1.1 - max(color.r"),
        ("EDGE_CONTRAST: f32 = 0.25", "EDGE_CONTRAST: f32 = 0.75"),
        ("sw + se - nw - ne", "nw + ne - sw - se"),
        ("MAX_SPAN: f32 = 8.0", "MAX_SPAN: f32 = 4.0"),
        ("along / 6.0", "along / 3.0"),
        ("0.5 * near + 0.25", "0.25 * near + 0.375"),
        ("brightness < darkest ||", "brightness > darkest ||"),
        ("floor(position - 0.5)", "floor(position)"),
    ] {
        assert!(ANTIALIASING_SHADER.contains(code), "{code}");
        let error = apart(&on_gpu(&ANTIALIASING_SHADER.replace(code, mutant), &[], &image, &depth));
        assert!(error > 1.5 * TOLERANCE, "{mutant}: {error}");
    }
}

#[test]
fn edges_of_a_spark_become_smooth_and_the_rest_stays() {
    for slope in [0.0, 0.12, 0.3, 0.7] {
        let image = spark(slope);
        let smooth = antialiased(&image);
        let at = |image: &Image<Vec4>, x: i32, y: i32| image.load(glam::IVec2::new(x, y)).x;
        // Far from the line nothing changes.
        assert!((48..96).all(|x| at(&smooth, x, 2).to_bits() == at(&image, x, 2).to_bits()), "{slope}");
        // Steps along the line, as a display shows them.
        let shown = |light: f32| light / (1.0 + light);
        let largest_step = |image: &Image<Vec4>| {
            let rows = (10..86).map(|x| {
                let y = (36.0 + slope * (x as f32 - 48.0) - 1.5).round() as i32;
                (shown(at(image, x, y)) - shown(at(image, x + 1, y))).abs()
            });
            rows.fold(0.0, f32::max)
        };
        let [before, after] = [&image, &smooth].map(largest_step);
        assert!(after <= if slope == 0.0 { 1.0e-5 } else { 0.75 * before }, "{slope}: {before} {after}");
    }
}
