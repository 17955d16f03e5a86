//! GPU time per pass, on a device with timestamp queries.

mod cost_tables;
mod frame_drawing;
mod queries;

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use glam::UVec2;
use haze::{
    Context, FrameInput, FrameTimes, ParticleSystem, Particles, SceneDepth, Settings, Timing, TimingDetail, wgpu,
};
use haze_core::error::PrepareError;
use haze_core::settings::{DiffuseMode, LightingResolution, RenderPath};
use haze_demo::headless::Headless;

use crate::gpu::{can_test, gpu, has_independent_devices, is_tiled_available};
use crate::resource_counter;
use crate::test_host::Host;
use crate::test_scene::TestScene;

const SIZE: UVec2 = UVec2::new(160, 90);

const FEATURES: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);

/// Shared device with timestamp queries; `None` if the adapter lacks them.
fn timed_gpu() -> Option<&'static Headless> {
    static GPU: OnceLock<Headless> = OnceLock::new();
    let gpu = GPU.get_or_init(|| Headless::with(wgpu::Limits::default(), FEATURES).unwrap());
    can_test("timestamps", gpu.device.features().contains(FEATURES)).then_some(gpu)
}

/// Host that measures its renderer and its own pass.
fn timed_host(gpu: &Headless, scene: &TestScene) -> (Host, Timing) {
    let mut host = Host::new(gpu, scene).unwrap();
    let timing = host.renderer.context().create_timing().unwrap();
    assert_eq!(timing.latest(), None);
    host.renderer.set_timing(Some(&timing)).unwrap();
    host.timing = Some(timing.clone());
    (host, timing)
}

/// Waits for the first result of a frame after `seen`. Usually it is there once the submission is done, but the poll of
/// another test's thread may deliver it later.
fn result_after(timing: &Timing, seen: Option<u64>) -> FrameTimes {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(10) {
        if let Some(times) = timing.latest().filter(|times| Some(times.frame) > seen) {
            return times;
        }
        std::thread::yield_now();
    }
    panic!("no timing result within 10 s");
}

fn draw_and_measure(gpu: &Headless, host: &mut Host, timing: &Timing, scene: &TestScene) -> FrameTimes {
    let seen = timing.latest().map(|times| times.frame);
    host.draw(gpu, scene).unwrap();
    result_after(timing, seen)
}

fn pass_names(times: &FrameTimes) -> Vec<&str> {
    times.passes.iter().map(|pass| pass.name).collect()
}

/// Stage with settings that use every pass of the deferred path but those of light per texel.
fn scene() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.settings.diffuse.mode = DiffuseMode::Cubemap;
    scene.settings.accumulate.lighting_resolution = LightingResolution::Full;
    scene
}

const DEFERRED_PASSES: [&str; 6] =
    ["depth_downsample", "diffuse_bake", "accumulate", "host", "transfer", "specular_scatter"];

#[test]
fn every_pass_is_reported_by_name_with_a_positive_time() {
    let Some(gpu) = timed_gpu() else { return };
    let mut scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    let mut frame = None;
    for _ in 0..5 {
        let times = draw_and_measure(gpu, &mut host, &timing, &scene);
        assert_eq!(pass_names(&times), DEFERRED_PASSES);
        assert!(Some(times.frame) > frame && times.discarded == 0, "{times:?}");
        assert!(times.passes.iter().all(|pass| pass.ms > 0.0), "{times:?}");
        frame = Some(times.frame);
        let ms = |name: &str| times.passes.iter().find(|pass| pass.name == name).unwrap().ms;
        // Passes inside the host's pass take no longer than it, and all together no longer than the whole. The sums are
        // f32.
        let within = ms("transfer") + ms("specular_scatter");
        assert!(within <= ms("host") * 1.0001, "{times:?}");
        assert!(times.smoke_ms() - within + ms("host") <= times.whole_ms * 1.0001, "{times:?}");
        let own: f32 = DEFERRED_PASSES.iter().filter(|name| **name != "host").map(|name| ms(name)).sum();
        assert!((times.smoke_ms() - own).abs() < 1.0e-5 * own, "{times:?}");
        assert!(times.passes.iter().all(|pass| pass.is_host == (pass.name == "host")));
    }
    scene.settings.accumulate.lighting_resolution = LightingResolution::Target;
    let mut lit = DEFERRED_PASSES.to_vec();
    lit.splice(3..3, ["light_target", "depth_slopes", "mark_cells"]);
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)), lit);
    scene.settings.path = RenderPath::Forward;
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)), ["host", "forward"]);
    scene.particles.clear();
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)), ["host"]);
}

#[test]
fn compute_passes_that_follow_each_other_are_one_in_a_frame() {
    let Some(gpu) = timed_gpu().filter(|_| is_tiled_available()) else { return };
    let mut scene = scene();
    scene.settings = Settings { path: RenderPath::Tiled, ..Settings::default() };
    scene.settings.accumulate.downscale = 2;
    let (mut host, timing) = timed_host(gpu, &scene);
    let each = draw_and_measure(gpu, &mut host, &timing, &scene);
    let computed = pass_names(&each).into_iter().take_while(|name| *name != "host").count();
    assert!(computed >= 5, "{each:?}");
    let image = host.image(gpu).unwrap();
    timing.set_detail(TimingDetail::Frame);
    let times = draw_and_measure(gpu, &mut host, &timing, &scene);
    let names = pass_names(&times);
    assert_eq!((names[0], &names[1..]), ("compute", &pass_names(&each)[computed..]));
    assert_eq!((times.discarded, host.image(gpu).unwrap()), (0, image));
    // Drawn passes are measured by their names.
    scene.settings.path = RenderPath::Raster;
    scene.settings.accumulate.lighting_resolution = LightingResolution::Full;
    let times = draw_and_measure(gpu, &mut host, &timing, &scene);
    assert!(!pass_names(&times).contains(&"compute"), "{times:?}");
    assert!(pass_names(&times).contains(&"accumulate"), "{times:?}");
    timing.set_detail(TimingDetail::Passes);
    scene.settings.path = RenderPath::Tiled;
    assert!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)).contains(&"tile_project"));
}

#[test]
fn results_report_the_path_that_auto_took() {
    let Some(gpu) = timed_gpu() else { return };
    let mut scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    assert_eq!(draw_and_measure(gpu, &mut host, &timing, &scene).choices, []);
    scene.settings.path = RenderPath::Auto;
    for _ in 0..3 {
        let times = draw_and_measure(gpu, &mut host, &timing, &scene);
        let choice = host.renderer.path_choice(0).unwrap();
        assert_eq!(times.choices, [(0, choice)]);
        let pass = if choice.path == RenderPath::Tiled { "tile_accumulate" } else { "accumulate" };
        assert!(pass_names(&times).contains(&pass), "{times:?}");
    }
}

#[test]
fn a_renderer_without_timing_is_not_measured() {
    let Some(gpu) = timed_gpu() else { return };
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)).len(), 6);
    host.renderer.set_timing(None).unwrap();
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene)), ["host"]);
    // An empty frame gives a result too, with a cost of 0.
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let seen = timing.latest().map(|times| times.frame);
    timing.resolve(&mut encoder);
    gpu.submit(encoder).unwrap();
    let times = result_after(&timing, seen);
    assert_eq!((pass_names(&times), times.smoke_ms(), times.whole_ms), (vec![], 0.0, 0.0));
}

#[test]
fn pass_times_add_up_over_systems() {
    let Some(gpu) = timed_gpu() else { return };
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    let light = scene.settings;
    let mut heavy = light;
    heavy.debug.draw_count = 64;
    heavy.accumulate.downscale = 1;
    let mut measure = |settings: &[&Settings]| {
        let systems: Vec<_> = (0..)
            .zip(settings)
            .map(|(key, settings)| {
                ParticleSystem::new(key, Particles::Slice(&scene.particles), settings, &host.material)
            })
            .collect();
        let frame = FrameInput {
            lights: &scene.lights,
            systems: &systems,
            ..FrameInput::new(scene.view, SceneDepth::Buffer(&host.depth))
        };
        let seen = timing.latest().map(|times| times.frame);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        host.renderer.prepare(&mut encoder, &frame).unwrap();
        timing.resolve(&mut encoder);
        gpu.submit(encoder).unwrap();
        let times = result_after(&timing, seen);
        assert_eq!((pass_names(&times).len(), times.discarded), (3, 0), "{times:?}");
        (times.passes[2].ms, host.renderer.counts())
    };
    measure(&[&light, &heavy]);
    let (alone, counts) = measure(&[&light]);
    assert_eq!((counts.systems, counts.sprites), (1, 60));
    // In either order. 64 times the sprites on 4 times the texels take more than 3 times as long on any machine.
    for both in [[&light, &heavy], [&heavy, &light]] {
        let (ms, of_both) = measure(&both);
        assert!(ms > 3.0 * alone, "{ms} ms, alone {alone} ms");
        assert_eq!((of_both.systems, of_both.sprites), (2, 60 + 64 * 60));
        assert!((4.5..5.5).contains(&(of_both.texels as f32 / counts.texels as f32)), "{of_both:?} {counts:?}");
    }
}

#[test]
fn device_without_timestamps_has_no_timing() {
    let plain = gpu();
    assert!(!plain.device.features().contains(wgpu::Features::TIMESTAMP_QUERY));
    assert!(Context::new(&plain.device, &plain.queue).create_timing().is_none());
}

#[test]
fn timing_of_another_device_is_an_error() {
    let Some(gpu) = timed_gpu() else { return };
    if !has_independent_devices() {
        return;
    }
    let descriptor = wgpu::DeviceDescriptor { required_features: FEATURES, ..Default::default() };
    let (device, queue) = pollster::block_on(gpu.adapter.request_device(&descriptor)).unwrap();
    let (mut host, timing) = timed_host(gpu, &scene());
    // wgpu may give devices of two instances the same ID.
    let other_instance = Headless::with(wgpu::Limits::default(), FEATURES).unwrap();
    for (device, queue) in [(&device, &queue), (&other_instance.device, &other_instance.queue)] {
        let of_another = Context::new(device, queue).create_timing().unwrap();
        let refused = host.renderer.set_timing(Some(&of_another));
        let Err(PrepareError::Field(error)) = refused else { panic!("{refused:?}") };
        assert_eq!(error.field, "timing");
    }
    // The previous timing stays in use.
    assert_eq!(pass_names(&draw_and_measure(gpu, &mut host, &timing, &scene())), DEFERRED_PASSES);
}

#[test]
fn without_timestamps_inside_passes_only_whole_passes_are_measured() {
    let gpu = Headless::with(wgpu::Limits::default(), wgpu::Features::TIMESTAMP_QUERY).unwrap();
    if !can_test("timestamps", gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)) {
        return;
    }
    let (mut host, timing) = timed_host(&gpu, &scene());
    let times = draw_and_measure(&gpu, &mut host, &timing, &scene());
    assert_eq!((pass_names(&times), times.discarded), (DEFERRED_PASSES[..4].to_vec(), 0));
}

#[test]
fn steady_frames_with_timing_create_no_resources() {
    let Some(gpu) = timed_gpu() else { return };
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    draw_and_measure(gpu, &mut host, &timing, &scene);
    for _ in 0..10 {
        let created = resource_counter::count(|| host.draw(gpu, &scene).unwrap());
        assert_eq!(created, 0);
    }
}
