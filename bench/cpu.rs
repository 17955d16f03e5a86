//! Benchmarks of CPU work (`cargo bench`): emitter, sort and upload in `prepare`, reference renderer, bakes.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{UVec2, Vec3};
use haze::{
    Context, FrameInput, Light, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth, Settings, wgpu,
};
use haze_author::ramp::RampRecipe;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::emitter::Emitter;
use haze_core::settings::BlendOrder;
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;

const COUNTS: [u32; 3] = [1_000, 10_000, 100_000];

/// Returns an emitter and a time, in seconds, at which `count` particles are alive.
fn emitter(count: u32) -> (Emitter, f64) {
    let emitter = Emitter { rate: count as f32, duration: 1.0, lifetime: 100.0, ..Emitter::default() };
    // They stay where the camera of `column` sees them.
    let source = Vec3::new(-3.0, 1.5, 0.5);
    let still = Emitter { position: source, velocity: Vec3::ZERO, buoyancy: 0.0, extent: Vec3::ONE, ..emitter };
    (still, 10.0)
}

fn evaluate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("emitter");
    for count in COUNTS {
        let (emitter, time) = emitter(count);
        let mut particles = Vec::new();
        group.throughput(Throughput::Elements(count.into()));
        group.bench_function(BenchmarkId::from_parameter(count), |bench| {
            bench.iter(|| emitter.evaluate(time, &mut particles));
        });
    }
}

/// CPU time of `prepare` in a steady frame. The difference between `sorted` and `weighted` is the sort.
fn prepare(criterion: &mut Criterion) {
    let gpu = Headless::new().unwrap();
    let device = &gpu.device;
    let context = Context::new(&gpu.device, &gpu.queue);
    let size = UVec2::new(640, 360);
    let depth = gpu.target("depth", size, wgpu::TextureFormat::Depth32Float).create_view(&Default::default());
    let view = Shot::load("column", size).unwrap().preset.camera.view(size);
    let mut group = criterion.benchmark_group("prepare");
    for order in [BlendOrder::Sorted, BlendOrder::Weighted] {
        for count in COUNTS {
            let mut settings = Settings::default();
            settings.accumulate.order = order;
            // Small sprites keep the GPU work short, so that it does not delay the next `prepare`.
            settings.sprite.size = 0.02;
            let mut renderer = Renderer::new(&context, &RendererDescriptor::default()).unwrap();
            let images = haze_preset::MaterialSources::default().load(haze_preset::ImageSource::BuiltIn).unwrap();
            let material = context.create_material(&images).unwrap();
            let (emitter, time) = emitter(count);
            let mut particles = Vec::new();
            emitter.evaluate(time, &mut particles);
            let systems = [ParticleSystem::new(0, Particles::Slice(&particles), &settings, &material)];
            let lights = [Light::default()];
            let frame =
                FrameInput { lights: &lights, systems: &systems, ..FrameInput::new(view, SceneDepth::Buffer(&depth)) };
            let mut encoder = device.create_command_encoder(&Default::default());
            renderer.prepare(&mut encoder, &frame).unwrap();
            gpu.submit(encoder).unwrap();
            assert!(renderer.depth_of(0).is_some(), "the smoke is out of sight");
            group.throughput(Throughput::Elements(count.into()));
            group.bench_function(BenchmarkId::new(order.name(), count), |bench| {
                bench.iter_custom(|rounds| {
                    let mut taken = std::time::Duration::ZERO;
                    for _ in 0..rounds {
                        let mut encoder = device.create_command_encoder(&Default::default());
                        let started = std::time::Instant::now();
                        renderer.prepare(&mut encoder, &frame).unwrap();
                        taken += started.elapsed();
                        gpu.submit(encoder).unwrap();
                    }
                    taken
                });
            });
        }
    }
}

fn reference(criterion: &mut Criterion) {
    let shot = Shot::load("column", UVec2::new(160, 90)).unwrap();
    criterion.bench_function("reference/column 160x90", |bench| bench.iter(|| shot.render_on_cpu().unwrap()));
}

fn bakes(criterion: &mut Criterion) {
    let recipe: RampRecipe = serde_json::from_str(include_str!("../ramps/diffuse_soft.ramp.json")).unwrap();
    criterion.bench_function("ramp bake", |bench| bench.iter(|| recipe.bake().unwrap()));
    let recipe: SpriteRecipe = serde_json::from_str(include_str!("../sprites/ball.sprite.json")).unwrap();
    criterion.bench_function("sprite bake/one frame of ball, 128x128", |bench| bench.iter(|| recipe.bake_frame(0.0)));
}

criterion_group!(benches, evaluate, prepare, reference, bakes);
criterion_main!(benches);
