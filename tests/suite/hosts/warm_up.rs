//! Pipelines that are compiled ahead of time, on another thread, or loaded from a pipeline cache.

use glam::Vec3;
use haze::{Bounds, Context, Renderer, RendererDescriptor, SceneDepthKind, Settings, WarmUp, wgpu};
use haze_core::formula::hash::{pcg3d, unit};
use haze_core::settings::*;

use super::{SIZE, device_with_optional_features, rejected_field};
use crate::gpu::{can_test, gpu};
use crate::test_host::Host;
use crate::test_scene::{DepthKind, TestScene};

pub fn warm_up<'a>(scene: &'a TestScene, settings: &'a [Settings]) -> WarmUp<'a> {
    let scene_depth = match scene.depth {
        DepthKind::Buffer => SceneDepthKind::Buffer(scene.host.depth_format),
        DepthKind::Multisampled => SceneDepthKind::Multisampled,
        DepthKind::Linear => SceneDepthKind::Linear,
        DepthKind::Both => SceneDepthKind::BufferAndLinear(scene.host.depth_format),
    };
    WarmUp { view: scene.view, scene_depth, settings, debug_views: std::slice::from_ref(&scene.debug_view) }
}

#[test]
fn first_frame_after_a_warm_up_compiles_no_pipeline() {
    for &technique in Technique::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            let mut scene = TestScene::new(SIZE);
            scene.depth = DepthKind::Both;
            scene.attach_depth = true;
            scene.settings.technique = technique;
            scene.settings.path = path;
            scene.settings.diffuse.mode = DiffuseMode::Cubemap;
            // A warm-up does not know whether sprites have one frame or several, so both cases are tested.
            if path == RenderPath::Raster {
                (scene.material.sprite, scene.material.detail, scene.material.six_way) = crate::techniques::flipbook();
            }
            scene.settings.accumulate.lighting_resolution = LightingResolution::Target;
            let mut host = Host::new(gpu(), &scene).unwrap();
            assert_eq!(host.renderer.context().pipeline_count(), 0);
            host.renderer.warm_up(&warm_up(&scene, &[scene.settings])).unwrap();
            let warm = host.renderer.context().pipeline_count();
            assert!(warm > 0);
            host.draw(gpu(), &scene).unwrap();
            // The same with the camera inside the bounds.
            scene.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
            host.draw(gpu(), &scene).unwrap();
            assert_eq!(host.renderer.context().pipeline_count(), warm, "{} {}", technique.name(), path.name());
        }
    }
}

#[test]
fn warm_up_can_run_on_another_thread() {
    let mut scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let context = host.renderer.context().clone();
    scene.settings.technique = Technique::SphericalBillboard;
    let settings = [scene.settings];
    let attach_depth = scene.attach_depth;
    let expected = warm_up(&scene, &settings);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let depth_format = attach_depth.then_some(wgpu::TextureFormat::Depth32Float);
            let own = RendererDescriptor { depth_format, exact_filtering: true, ..RendererDescriptor::default() };
            Renderer::new(&context, &own).unwrap().warm_up(&expected).unwrap();
        });
    });
    let warm = context.pipeline_count();
    host.draw(gpu(), &scene).unwrap();
    assert_eq!(context.pipeline_count(), warm);
    let unusable = WarmUp { settings: &[Settings { boost: -1.0, ..Settings::default() }], ..expected };
    assert_eq!(rejected_field(host.renderer.warm_up(&unusable)), "settings[0].boost");
}

#[test]
#[allow(unsafe_code, reason = "wgpu cannot validate cache data; this data comes from wgpu itself")]
fn pipelines_are_stored_in_and_loaded_from_the_hosts_pipeline_cache() {
    let gpu = device_with_optional_features();
    if !can_test("pipeline_cache", gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE)) {
        return;
    }
    let draw = |data: Option<&[u8]>| {
        let descriptor = wgpu::PipelineCacheDescriptor { label: None, data, fallback: true };
        let cache = unsafe { gpu.device.create_pipeline_cache(&descriptor) };
        let empty = cache.get_data().map_or(0, |data| data.len());
        let context = Context::with_pipeline_cache(&gpu.device, &gpu.queue, &cache);
        let scene = TestScene::new(SIZE);
        let mut host = Host::with_context(gpu, &scene, Some(&context)).unwrap();
        host.draw(gpu, &scene).unwrap();
        gpu.check().unwrap();
        (empty, cache.get_data().unwrap(), host.image(gpu).unwrap())
    };
    let (empty, filled, image) = draw(None);
    let (loaded, _, again) = draw(Some(&filled));
    assert!(loaded == filled.len() && again == image, "{loaded} bytes of {}", filled.len());
    // Mesa's software driver stores only a header.
    let keeps = !gpu.adapter.get_info().name.contains("llvmpipe");
    assert!(!keeps || filled.len() > empty, "{} bytes after {empty}", filled.len());
}

/// Measures the CPU time of the first `prepare` after a warm-up, and of steady ones with ten thousand particles.
#[test]
#[ignore = "a measurement, to be run by hand"]
fn measure_cpu_time_of_prepare() {
    for path in RenderPath::ALL.iter().filter(|&&path| path != RenderPath::Tiled || crate::gpu::is_tiled_available()) {
        let mut scene = TestScene::new(glam::UVec2::new(1280, 720));
        scene.settings.path = *path;
        let prepare = |host: &mut Host, scene: &TestScene| {
            let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let started = std::time::Instant::now();
            host.prepare(&mut encoder, scene, haze::Particles::Slice(&scene.particles)).unwrap();
            let ms = started.elapsed().as_secs_f64() * 1000.0;
            host.render(&mut encoder, scene);
            gpu().submit(encoder).unwrap();
            ms
        };
        let mut host = Host::new(gpu(), &scene).unwrap();
        host.renderer.warm_up(&warm_up(&scene, &[scene.settings])).unwrap();
        let first = prepare(&mut host, &scene);

        let few = std::mem::take(&mut scene.particles);
        let spread = |index: usize| {
            let mut particle = few[index % few.len()];
            let random = pcg3d(glam::UVec3::new(index as u32, 0, 0));
            particle.position += Vec3::from(random.to_array().map(|word| unit(word) - 0.5));
            particle.radius = 0.02;
            particle.amount = 0.01;
            particle
        };
        scene.particles = (0..10_000).map(spread).collect();
        let mut steady: Vec<f64> = (0..40).map(|_| prepare(&mut host, &scene)).collect();
        steady.sort_by(f64::total_cmp);
        println!(
            "{}: first {first:.2} ms; 10,000 particles: median {:.3} ms, fastest {:.3} ms",
            path.name(),
            steady[20],
            steady[0]
        );
    }
}
