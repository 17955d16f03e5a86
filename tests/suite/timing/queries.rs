//! Timestamp queries that are dropped, unused, or too many.

use haze::{Particles, wgpu};
use haze_core::settings::RenderPath;
use haze_demo::headless::Headless;

use super::{DEFERRED_PASSES, FEATURES, draw_and_measure, pass_names, result_after, scene, timed_gpu, timed_host};

#[test]
fn dropped_encoders_do_not_disturb_later_results() {
    let Some(gpu) = timed_gpu() else { return };
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    let first = draw_and_measure(gpu, &mut host, &timing, &scene);
    // More rounds than there are read-back buffers and queries.
    for round in 0..200 {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        host.prepare(&mut encoder, &scene, Particles::Slice(&scene.particles)).unwrap();
        if round % 3 > 0 {
            host.render(&mut encoder, &scene);
        }
        if round % 3 > 1 {
            timing.resolve(&mut encoder);
        }
    }
    assert_eq!(timing.latest(), Some(first));
    for _ in 0..2 {
        let times = draw_and_measure(gpu, &mut host, &timing, &scene);
        assert_eq!((pass_names(&times), times.discarded), (DEFERRED_PASSES.to_vec(), 0));
    }
}

#[test]
fn host_pass_queries_from_before_a_second_prepare_are_harmless() {
    let Some(gpu) = timed_gpu() else { return };
    let mut scene = scene();
    scene.attach_depth = false;
    let (mut host, timing) = timed_host(gpu, &scene);
    let encoder = || gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    host.prepare(&mut encoder(), &scene, Particles::Slice(&scene.particles)).unwrap();
    let timestamp_writes = timing.host_pass("host");
    let mut encoder = encoder();
    host.prepare(&mut encoder, &scene, Particles::Slice(&scene.particles)).unwrap();
    let view = host.color.create_view(&wgpu::TextureViewDescriptor::default());
    let attachment = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations::default(),
    };
    host.renderer.render(&mut encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(attachment)],
        timestamp_writes,
        ..Default::default()
    }));
    timing.resolve(&mut encoder);
    // wgpu rejects a pass that writes one query twice.
    gpu.submit(encoder).unwrap();
    let times = result_after(&timing, None);
    assert_eq!((pass_names(&times).len(), times.discarded), (5, 0), "{times:?}");
}

#[test]
fn only_resolved_frames_are_measured() {
    let Some(gpu) = timed_gpu() else { return };
    let mut scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    host.timing = None;
    scene.settings.path = RenderPath::Forward;
    host.draw(gpu, &scene).unwrap();
    scene.settings.path = RenderPath::Auto;
    host.timing = Some(timing.clone());
    let times = draw_and_measure(gpu, &mut host, &timing, &scene);
    assert_eq!((pass_names(&times), times.discarded), (DEFERRED_PASSES.to_vec(), 0));
}

#[test]
fn unused_and_excess_host_labels_count_as_discarded() {
    let Some(gpu) = timed_gpu() else { return };
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    let mut discarded = |asked| {
        let given = (0..asked).filter(|_| timing.host_pass("unused").is_some()).count();
        let times = draw_and_measure(gpu, &mut host, &timing, &scene);
        assert_eq!(pass_names(&times).contains(&"host"), given < 32);
        assert!(!pass_names(&times).contains(&"unused"));
        times.discarded
    };
    assert_eq!(discarded(0), 0);
    // The query of the unused label still holds what the host's pass wrote in the previous frame.
    assert_eq!(discarded(1), 1);
    // 32 labels are never written; 8 more and the host's own pass do not fit.
    assert_eq!(discarded(40), 32 + 8 + 1);
    assert_eq!(discarded(0), 0);
}

#[test]
fn frames_beyond_the_read_back_buffers_are_not_measured() {
    if timed_gpu().is_none() {
        return;
    }
    // A separate device, so that no other thread's poll delivers results later.
    let gpu = &Headless::with(wgpu::Limits::default(), FEATURES).unwrap();
    let scene = scene();
    let (mut host, timing) = timed_host(gpu, &scene);
    let recorded = |_| {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        timing.resolve(&mut encoder);
        encoder
    };
    let held = [(); 4].map(recorded);
    host.draw(gpu, &scene).unwrap();
    assert_eq!(timing.latest(), None);
    for encoder in held {
        gpu.submit(encoder).unwrap();
    }
    let times = draw_and_measure(gpu, &mut host, &timing, &scene);
    assert_eq!((pass_names(&times), times.frame, times.discarded), (DEFERRED_PASSES.to_vec(), 5, 0));
}
