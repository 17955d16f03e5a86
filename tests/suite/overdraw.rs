//! Compares the CPU's estimate of sprite fragments ([`Overdraw`]) with fragments counted by the GPU.

use glam::camera::rh::proj::directx;
use glam::{Mat4, UVec2, Vec4, vec3};
use haze::{Overdraw, Particle, Particles, View, wgpu};
use haze_core::assets::image::Image;
use haze_core::formula::color::overdraw_color;
use haze_core::settings::{DebugView, DepthSource, RenderPath, Technique};
use haze_demo::headless::Headless;

use crate::gpu::{can_test, gpu};
use crate::psnr::{MIN_PSNR, psnr_over};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, DepthKind, TestScene};

const SIZE: UVec2 = UVec2::new(320, 180);

/// Sprites at scale 1 in front of the whole scene and without near fade, so that no fragment is discarded.
fn scene() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.settings.accumulate.downscale = 1;
    scene.settings.soft_fade.near_fade_start = 0.0;
    scene.settings.soft_fade.near_fade_end = 0.0;
    scene.debug_view = DebugView::Overdraw;
    moved(scene, 2.5)
}

fn moved(mut scene: TestScene, metres: f32) -> TestScene {
    scene.particles.iter_mut().for_each(|particle| particle.position.z += metres);
    scene
}

fn overdraw(scene: &TestScene) -> Overdraw {
    scene.on_gpu(gpu()).renderer.overdraw()
}

/// Decodes the number of layers of every covered pixel from an image of the overdraw debug view.
fn layers(image: &Image<Vec4>) -> Vec<u32> {
    let colors: Vec<_> = (0..=60).map(|layers| overdraw_color(layers as f32)).collect();
    let layers = |texel: &Vec4| {
        let off = |color: &glam::Vec3| (texel.truncate() - color).abs().max_element();
        // Tolerance for half floats; the colors of two layer counts differ by at least 0.02.
        colors
            .iter()
            .position(|color| off(color) < 0.005)
            .unwrap_or_else(|| panic!("{texel} is the color of no layer count")) as u32
    };
    image.texels.iter().filter(|texel| **texel != BACKDROP).map(layers).collect()
}

/// Stages with different projections and positions of sprites.
fn cases() -> Vec<(&'static str, TestScene)> {
    let off_center = directx::frustum(-0.05, 0.15, -0.1, 0.06, 0.1, 80.0);
    let orthographic = directx::orthographic(-1.6, 1.2, -0.9, 0.7, 0.1, 80.0);
    let seen = |clip_from_view| TestScene { view: View::new(Mat4::IDENTITY, clip_from_view, SIZE), ..scene() };
    let mut depth_sprites = moved(scene(), 2.6);
    depth_sprites.settings.technique = Technique::DepthSpriteSoft;
    vec![
        ("in sight", scene()),
        ("around the camera", moved(scene(), 2.6)),
        ("slabs through the near plane", depth_sprites),
        ("off center", seen(off_center)),
        ("orthographic", seen(orthographic)),
    ]
}

#[test]
fn estimated_fragments_match_the_overdraw_view() {
    for (name, scene) in cases() {
        let drawn = scene.on_gpu(gpu());
        let found = drawn.renderer.overdraw();
        let counted: u32 = layers(&drawn.image).iter().sum();
        println!("{name}: {found:?}, counted {counted}, {:.2} layers", found.mean());
        // The number of pixel centers in a square differs from its area by about the square root of its outline in
        // pixels. For 60 squares with outlines of 400 pixels that is about 150 of 100 000 fragments in total.
        assert!((found.fragments / f64::from(counted) - 1.0).abs() < 0.003, "{name}: {found:?}, counted {counted}");
    }
}

#[test]
fn mean_overdraw_is_taken_over_the_pixels_of_the_bounding_box() {
    // This view shows the whole box.
    let scene = TestScene { debug_view: DebugView::ReducedDepth, ..scene() };
    let drawn = scene.on_gpu(gpu());
    let found = drawn.renderer.overdraw();
    let in_box = drawn.image.texels.iter().filter(|texel| **texel != BACKDROP).count();
    // Seen head-on, the bounding box is a rectangle; its edges may lie anywhere within their pixels.
    let outline = 2 * (SIZE.x + SIZE.y);
    assert!((found.texels - in_box as f64).abs() <= f64::from(outline), "{found:?}, drawn pixels {in_box}");
    assert_eq!(found.mean(), found.fragments / found.texels);
    assert_eq!(Overdraw::default().mean(), 0.0);
}

#[test]
fn overdraw_is_independent_of_scale_and_counts_repeated_draws() {
    let of = |change: &dyn Fn(&mut TestScene)| {
        let mut scene = scene();
        // The debug sprite fills its square at every mip level. Other sprites extend further at coarser levels.
        scene.settings.debug.checkerboard = true;
        change(&mut scene);
        overdraw(&scene)
    };
    let whole = of(&|_| {});
    let coarse = of(&|scene| scene.settings.accumulate.downscale = 4);
    // Sprite areas are exact; the box's sides are rounded up to whole texels.
    assert!((16.0 * coarse.fragments / whole.fragments - 1.0).abs() < 1.0e-3, "scale 4 {coarse:?}, scale 1 {whole:?}");
    assert!((coarse.mean() / whole.mean() - 1.0).abs() < 0.05, "scale 4 {coarse:?}, scale 1 {whole:?}");
    let forward = of(&|scene| (scene.settings.path, scene.debug_view) = (RenderPath::Forward, DebugView::Final));
    // The forward path has no accumulation target, and so none of its border texels.
    assert!(
        (forward.fragments / whole.fragments - 1.0).abs() < 0.01 && forward.texels == whole.texels,
        "forward {forward:?}"
    );
    // Passes the linear target too: OpenGL cannot sample a depth buffer that the same pass tests.
    let host_depth =
        of(&|scene| (scene.settings.accumulate.depth_source, scene.depth) = (DepthSource::Host, DepthKind::Both));
    assert!((host_depth.fragments / whole.fragments - 1.0).abs() < 0.01 && host_depth.texels == whole.texels);
    assert_eq!(of(&|scene| scene.settings.debug.draw_count = 3).fragments, 3.0 * whole.fragments);
    // Sprites without amount, out of view, or in a buffer that the CPU cannot read add nothing.
    let hide = |particle: &mut Particle| particle.amount = 0.0;
    assert_eq!(of(&|scene| scene.particles.iter_mut().for_each(hide)), Overdraw::default());
    assert_eq!(of(&|scene| scene.particles.iter_mut().for_each(|p| p.position.z = 9.0)), Overdraw::default());
    let mut buffered = scene();
    buffered.bounds = Some(haze::Bounds { min: vec3(-3.0, -3.0, -8.0), max: vec3(3.0, 3.0, 0.0) });
    let mut host = Host::new(gpu(), &buffered).unwrap();
    host.draw(gpu(), &buffered).unwrap();
    assert!(host.renderer.overdraw().fragments > 0.0);
    host.draw_buffer(gpu(), &buffered, &buffered.particles).unwrap();
    assert_eq!(host.renderer.overdraw(), Overdraw::default());
}

#[test]
fn overdraw_of_many_sprites_is_estimated_from_a_sample() {
    let few = scene();
    // 101 sprites instead of each: every second sprite is counted, 50 or 51 of them, so the estimate is off by up to 1 %.
    let many = TestScene {
        particles: few.particles.iter().flat_map(|particle| std::iter::repeat_n(*particle, 101)).collect(),
        ..scene()
    };
    assert!(many.particles.len() > 4096);
    let few = overdraw(&few);
    let many = overdraw(&many);
    assert!((many.fragments / (101.0 * few.fragments) - 1.0).abs() < 0.02, "{many:?}, one of each {few:?}");
}

/// Device with pipeline statistics queries; `None` if the adapter lacks them.
fn counting_gpu() -> Option<Headless> {
    let gpu = Headless::with(wgpu::Limits::default(), wgpu::Features::PIPELINE_STATISTICS_QUERY).unwrap();
    can_test("statistics", gpu.device.features().contains(wgpu::Features::PIPELINE_STATISTICS_QUERY)).then_some(gpu)
}

/// Fragment shader invocations while the host's pass draws forward sprites, and the CPU's estimate for that frame.
fn shaded(gpu: &Headless, scene: &TestScene) -> (u64, Overdraw) {
    let mut host = Host::new(gpu, scene).unwrap();
    let buffer = |usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: None, size: 8, usage, mapped_at_creation: false })
    };
    let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
    let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
        label: None,
        ty: wgpu::QueryType::PipelineStatistics(wgpu::PipelineStatisticsTypes::FRAGMENT_SHADER_INVOCATIONS),
        count: 1,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    host.prepare(&mut encoder, scene, Particles::Slice(&scene.particles)).unwrap();
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &host.color.create_view(&wgpu::TextureViewDescriptor::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..Default::default()
        });
        pass.begin_pipeline_statistics_query(&queries, 0);
        host.renderer.render(&mut pass);
        pass.end_pipeline_statistics_query();
    }
    encoder.resolve_query_set(&queries, 0..1, &resolved, 0);
    gpu.submit(encoder).unwrap();
    let bytes = gpu.read_buffer(&resolved).unwrap();
    (bytemuck::pod_read_unaligned(&bytes), host.renderer.overdraw())
}

/// Side lengths of the sprites on screen, pixels.
fn sides(scene: &TestScene) -> Vec<f64> {
    let pixels_per_metre = |depth: f32| 0.5 * SIZE.y as f32 * scene.view.clip_from_view.y_axis.y / depth;
    let side = |particle: &Particle| 2.0 * particle.radius * pixels_per_metre(-particle.position.z);
    scene.particles.iter().map(|particle| f64::from(side(particle))).collect()
}

/// A GPU shades blocks of b by b pixels for each of the two triangles of a square (b = 4 on llvmpipe), and its query
/// counts either all pixels of a block or only the covered ones. With edges at random positions in their blocks, a
/// right triangle with legs of s pixels touches blocks of s²/2 + 2s(b-1) + (b-1)² pixels on average.
#[test]
fn estimated_fragments_match_the_gpus_shader_invocations() {
    let Some(gpu) = counting_gpu() else { return };
    let mut scene = moved(scene(), -6.0);
    scene.settings.path = RenderPath::Forward;
    scene.debug_view = DebugView::Final;
    scene.attach_depth = false;
    scene.particles.iter_mut().for_each(|particle| particle.rotation = 0.0);
    // The debug sprite fills its whole square.
    scene.settings.debug.checkerboard = true;
    let sides = sides(&scene);
    let (shaded, found) = shaded(&gpu, &scene);
    let blocks = |side: f64| {
        let of_two = |own: f64| own * own + 4.0 * own * (side - 1.0) + 2.0 * (side - 1.0).powi(2);
        sides.iter().map(|own| of_two(*own)).sum::<f64>()
    };
    // The areas have f32 rounding.
    assert!((found.fragments / blocks(1.0) - 1.0).abs() < 1.0e-4, "{found:?}, area of the squares {}", blocks(1.0));
    let off = [1.0, 2.0, 4.0].map(|side| (shaded as f64 / blocks(side) - 1.0).abs());
    println!("{found:?}, shaded {shaded}, relative errors for blocks of 1, 2, 4: {off:?}");
    // One block more or less along a side changes a square by 1/6, and the sum over 60 squares by 1/50. Counting twice
    // or by half would be off by far more.
    assert!(off.iter().any(|off| *off < 0.02), "{found:?}, shaded {shaded}, relative errors {off:?}");
}

#[test]
fn amount_and_overdraw_show_all_systems() {
    let alone = scene();
    let mut both = alone.clone();
    // A second system in front, whose box covers all of the first and whose smoke covers little of it.
    let faint = Particle { position: vec3(0.0, 0.0, -1.0), radius: 0.02, amount: 0.5, ..Particle::default() };
    let corners = [vec3(-9.0, -9.0, -1.0), vec3(9.0, 9.0, -1.0)].map(|position| Particle { position, ..faint });
    both.others = vec![([faint].into_iter().chain(corners).collect(), alone.settings)];
    for debug_view in [DebugView::Amount, DebugView::Overdraw] {
        let [first, all] = [&alone, &both].map(|scene| {
            let scene = TestScene { debug_view, ..scene.clone() };
            let on_gpu = scene.on_gpu(gpu()).image;
            let on_cpu = scene.on_cpu();
            let behind = Image::new(on_gpu.size, scene.backdrop());
            let found = psnr_over([&on_gpu, &on_cpu], [&behind, &behind]);
            assert!(found >= MIN_PSNR, "{debug_view:?}: {found:.1} dB");
            on_gpu
        });
        let same = first.texels.iter().zip(&all.texels).filter(|(first, all)| first == all).count();
        let fraction = same as f64 / first.texels.len() as f64;
        assert!(fraction > 0.9 && fraction < 1.0, "{debug_view:?}: {fraction}");
    }
}
