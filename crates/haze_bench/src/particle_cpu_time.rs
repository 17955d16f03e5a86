//! Measures the CPU time of particles before anything is drawn: evaluating, sorting and uploading them.

use std::time::Instant;

use haze::{Context, FrameInput, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth, wgpu};
use haze_author::particle_files;
use haze_core::error::Error;
use haze_core::frame::EmitterPaths;
use haze_core::settings::BlendOrder;
use haze_demo::headless::Headless;
use haze_export::interrupt;

use super::report::{Clock, Milliseconds, Row};
use super::suites::{Group, Suite};

const ROUNDS: u32 = 9;

/// Returns rows for the first system of a group: evaluation of the emitter at any time and along the paths of the frame
/// before, and `prepare` with and without the sort.
pub fn rows(gpu: &Headless, group: &Group) -> Result<Vec<Row>, Error> {
    let shot = &group.reference;
    let (Some(system), Some(images)) = (shot.preset.systems.first(), shot.materials.first()) else {
        return Ok(Vec::new());
    };
    let device = &gpu.device;
    let context = Context::new(&gpu.device, &gpu.queue);
    let depth = gpu.target("depth", shot.size, wgpu::TextureFormat::Depth32Float);
    let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let view = shot.preset.camera.view(shot.size);
    let mut renderers = Vec::new();
    for order in [BlendOrder::Sorted, BlendOrder::Weighted] {
        let mut settings = system.settings;
        settings.accumulate.order = order;
        let renderer = Renderer::new(&context, &RendererDescriptor::default())?;
        let material = context.create_material(images)?;
        renderers.push((renderer, material, settings));
    }
    let mut times = [const { Vec::new() }; 4];
    let mut paths = EmitterPaths::default();
    let mut particles = Vec::new();
    for round in 0..=ROUNDS {
        if interrupt::is_requested() {
            break;
        }
        let started = Instant::now();
        particle_files::particles(system, None, shot.preset.time, &mut particles);
        let mut found = vec![started.elapsed()];
        let started = Instant::now();
        let next = shot.preset.time + f64::from(round) / 60.0;
        particle_files::particles_along(system, None, next, &mut paths, &mut particles);
        found.push(started.elapsed());
        for (renderer, material, settings) in &mut renderers {
            let systems = [ParticleSystem::new(0, Particles::Slice(&particles), settings, material)];
            let frame = FrameInput {
                lights: &shot.preset.lights,
                systems: &systems,
                ..FrameInput::new(view, SceneDepth::Buffer(&depth))
            };
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let started = Instant::now();
            renderer.prepare(&mut encoder, &frame)?;
            found.push(started.elapsed());
            gpu.submit(encoder)?;
        }
        if round > 0 {
            times.iter_mut().zip(found).for_each(|(times, taken)| times.push(taken.as_secs_f64() * 1000.0));
        }
    }
    let count = particles.len() as u32;
    let names = ["evaluate", "evaluate the next frame of", "prepare sorted", "prepare weighted"];
    let row = |(name, times): (&str, &mut Vec<f64>)| {
        let gpu_ms = Milliseconds::of(times)?;
        let case = format!("{name} {count} particles");
        Some(Row {
            particles: Some(count),
            samples: times.len() as u32,
            ..Row::of(Suite::Particles, case, shot.size, Clock::Cpu, gpu_ms)
        })
    };
    Ok(names.into_iter().zip(&mut times).filter_map(row).collect())
}
