//! Minutes of frames in which nothing may grow. `scripts/soak` runs them, one after the other: they measure the whole process.

use std::time::{Duration, Instant};

use glam::UVec2;
use haze::shader::{self, Sources};
use haze::{Context, wgpu};

use crate::common::gpu;
use crate::host::Host;
use crate::hosts::kept::Systems;
use crate::stage::Stage;

const SIZE: UVec2 = UVec2::splat(256);

/// More of the process' memory than this may not come to stay, bytes: pages that the allocator and the driver keep.
const LEAK: u64 = 5 << 20;

/// Objects that are alive on the device, and their memory. Not textures: wgpu 30 counts them down on Vulkan, but not up.
fn alive() -> Vec<isize> {
    let hal = gpu().device.get_internal_counters().hal;
    let kinds = [
        &hal.buffers,
        &hal.texture_views,
        &hal.bind_groups,
        &hal.samplers,
        &hal.render_pipelines,
        &hal.shader_modules,
        &hal.buffer_memory,
        &hal.texture_memory,
    ];
    kinds.map(|counter| counter.read()).to_vec()
}

/// What the process holds of the machine's memory, bytes; 0 where the system does not say.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}

/// Longer than a renderer keeps what it does not need, frames.
const LONG: usize = 130;

/// Runs `step` a hundredth as often to warm up, and then `count` times: afterwards, at rest, there is no more than before.
fn soak(count: u32, step: impl FnMut(u32)) {
    soak_within(LEAK, count, step);
}

/// The same with so many bytes to come to stay.
fn soak_within(leak: u64, count: u32, mut step: impl FnMut(u32)) {
    (0..count / 100).chain([0; LONG]).for_each(&mut step);
    let (alive_before, resident_before) = (alive(), resident());
    let mut told = Instant::now();
    for index in 0..count {
        step(index);
        if told.elapsed() > Duration::from_secs(10) {
            told = Instant::now();
            eprintln!("{index} of {count}: {} KiB", resident() / 1024);
        }
    }
    [0; LONG].into_iter().for_each(&mut step);
    gpu().check().unwrap();
    assert_eq!(alive(), alive_before);
    let grown = resident().saturating_sub(resident_before);
    eprintln!("{count}: {} KiB more", grown / 1024);
    assert!(grown <= leak, "{grown} bytes more");
}

#[test]
#[ignore = "takes minutes"]
fn fifty_thousand_frames() {
    let mut stage = Stage::new(SIZE);
    let mut host = Host::new(gpu(), &stage).unwrap();
    soak(50_000, |frame| {
        for particle in &mut stage.particles {
            particle.rotation += 0.01;
        }
        stage.lights[0].intensity = 20.0 + (frame % 7) as f32;
        host.draw(gpu(), &stage).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn two_thousand_resizes() {
    let context = Host::new(gpu(), &Stage::new(SIZE)).unwrap().renderer.context().clone();
    let mut renderer = None;
    soak(2_000, |step| {
        let stage = Stage::new(UVec2::new(64 + 41 * (step % 5), 64 + 29 * (step % 4)));
        let mut host = Host::on(gpu(), &stage, Some(&context)).unwrap();
        if let Some(kept) = renderer.take() {
            host.renderer = kept;
        }
        host.draw(gpu(), &stage).unwrap();
        renderer = Some(host.renderer);
        // What was dropped is freed when the device is next looked after.
        gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn systems_that_come_and_go() {
    let mut systems = Systems::new(gpu(), SIZE);
    let (particles, settings) = (systems.stage.particles.clone(), systems.stage.settings);
    soak(20_000, |frame| {
        // One to four at a time, each there for as long as a puff lasts, and never seen again.
        let births = (0..4).map(|lane| u64::from((frame + 37 * lane) / 150 * 4 + lane));
        let present: Vec<_> = births.map(|key| (key, &particles[..15 + (key % 4) as usize * 15], settings)).collect();
        systems.frame(gpu(), &present[..1 + (frame / 400 % 4) as usize]).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_reloads_of_shaders() {
    let folder = tempfile::tempdir().unwrap();
    let good = shader::source("transfer.wgsl").unwrap();
    let texts = [
        good.to_owned(),
        good.replace("saturate(", "saturat("),
        good.replace("fn fragment(", "fn fragments("),
        good.replace("#import \"lib/colour.wgsl\"", "#import \"lib/color.wgsl\""),
    ];
    let stage = Stage::new(SIZE);
    let reload = |step: u32| {
        let text = step as usize % texts.len();
        std::fs::write(folder.path().join("transfer.wgsl"), &texts[text]).unwrap();
        let sources = Sources::from_folder(folder.path()).unwrap();
        let context = Context::with_shaders(&gpu().device, &gpu().queue, None, &sources);
        assert_eq!(context.is_ok(), text == 0);
        if let Ok(context) = context {
            Host::on(gpu(), &stage, Some(&context)).unwrap().draw(gpu(), &stage).unwrap();
        }
        // What was dropped is freed when the device is next looked after.
        gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    };
    // llvmpipe's compiler takes some 6 MiB for good, once, sooner or later: 700 reloads took no more.
    soak_within(4 * LEAK, 200, reload);
}
