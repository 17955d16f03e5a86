//! Leak tests that run for minutes. `scripts/soak` runs them one at a time, because they measure the memory of the
//! whole process.

use std::time::{Duration, Instant};

use glam::UVec2;
use haze::shader::{self, Sources};
use haze::{Context, wgpu};

use crate::gpu::gpu;
use crate::hosts::retained_resources::SystemsFixture;
use crate::test_host::Host;
use crate::test_scene::TestScene;

const SIZE: UVec2 = UVec2::splat(256);

/// Accepted growth of the process's resident memory, bytes: the allocator and the driver keep some pages.
const ACCEPTED_GROWTH: u64 = 5 << 20;

/// Numbers of live objects on the device, and their memory. Without textures: on Vulkan, wgpu 30 decrements their
/// counter but never increments it.
fn live_objects() -> Vec<isize> {
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

/// Resident memory of the process, bytes; 0 where the system has no `/proc/self/status`.
fn resident_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}

/// Frames after which a renderer has released all memory that it does not need.
const SETTLING_FRAMES: usize = 130;

/// Runs `step` `count / 100` times to warm up, then `count` times. Asserts that the device has as many objects as
/// before, and that resident memory has grown by at most [`ACCEPTED_GROWTH`].
fn soak(count: u32, step: impl FnMut(u32)) {
    soak_within(ACCEPTED_GROWTH, count, step);
}

/// [`soak`] with another limit on the growth of resident memory, bytes.
fn soak_within(leak: u64, count: u32, mut step: impl FnMut(u32)) {
    (0..count / 100).chain([0; SETTLING_FRAMES]).for_each(&mut step);
    let objects_before = live_objects();
    let bytes_before = resident_bytes();
    let mut reported = Instant::now();
    for index in 0..count {
        step(index);
        if reported.elapsed() > Duration::from_secs(10) {
            reported = Instant::now();
            eprintln!("{index} of {count}: {} KiB", resident_bytes() / 1024);
        }
    }
    [0; SETTLING_FRAMES].into_iter().for_each(&mut step);
    gpu().check().unwrap();
    assert_eq!(live_objects(), objects_before);
    let grown = resident_bytes().saturating_sub(bytes_before);
    eprintln!("{count} steps: resident memory grew by {} KiB", grown / 1024);
    assert!(grown <= leak, "resident memory grew by {grown} bytes; the limit is {leak}");
}

#[test]
#[ignore = "takes minutes"]
fn fifty_thousand_frames_leak_nothing() {
    let mut scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    soak(50_000, |frame| {
        for particle in &mut scene.particles {
            particle.rotation += 0.01;
        }
        scene.lights[0].intensity = 20.0 + (frame % 7) as f32;
        host.draw(gpu(), &scene).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn two_thousand_resizes_leak_nothing() {
    let context = Host::new(gpu(), &TestScene::new(SIZE)).unwrap().renderer.context().clone();
    let mut renderer = None;
    soak(2_000, |step| {
        let scene = TestScene::new(UVec2::new(64 + 41 * (step % 5), 64 + 29 * (step % 4)));
        let mut host = Host::with_context(gpu(), &scene, Some(&context)).unwrap();
        if let Some(kept) = renderer.take() {
            host.renderer = kept;
        }
        host.draw(gpu(), &scene).unwrap();
        renderer = Some(host.renderer);
        // wgpu frees dropped objects when the device is polled.
        gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn systems_that_come_and_go_leak_nothing() {
    let mut systems = SystemsFixture::new(gpu(), SIZE);
    let particles = systems.scene.particles.clone();
    let settings = systems.scene.settings;
    soak(20_000, |frame| {
        // One to four systems at a time. Each key lasts for 150 frames and is never used again.
        let births = (0..4).map(|lane| u64::from((frame + 37 * lane) / 150 * 4 + lane));
        let present: Vec<_> = births.map(|key| (key, &particles[..15 + (key % 4) as usize * 15], settings)).collect();
        systems.frame(gpu(), &present[..1 + (frame / 400 % 4) as usize]).unwrap();
    });
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_shader_reloads_leak_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let good = shader::source("transfer.wgsl").unwrap();
    let texts = [
        good.to_owned(),
        good.replace("saturate(", "saturat("),
        good.replace("fn fragment(", "fn fragments("),
        good.replace("#import \"lib/color.wgsl\"", "#import \"lib/colors.wgsl\""),
    ];
    let scene = TestScene::new(SIZE);
    let reload = |step: u32| {
        let text = step as usize % texts.len();
        std::fs::write(folder.path().join("transfer.wgsl"), &texts[text]).unwrap();
        let sources = Sources::from_folder(folder.path()).unwrap();
        let context = Context::new(&gpu().device, &gpu().queue).with_shaders(&sources);
        assert_eq!(context.is_ok(), text == 0);
        if let Ok(context) = context {
            Host::with_context(gpu(), &scene, Some(&context)).unwrap().draw(gpu(), &scene).unwrap();
        }
        // wgpu frees dropped objects when the device is polled.
        gpu().device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    };
    // llvmpipe's compiler grows once by about 6 MiB, at an unpredictable step; 700 reloads grew no further.
    soak_within(4 * ACCEPTED_GROWTH, 200, reload);
}
