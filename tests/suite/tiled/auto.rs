//! The path `auto`: its choice by cost, the reason that it reports, its hysteresis, and the measurement of costs.

use glam::vec3;
use haze::{Bounds, ParticleBuffer, Particles, PathCosts, PathModelSource, PathReason};
use haze_core::settings::*;

use super::{scene, storage_buffer};
use crate::gpu::{gpu, is_tiled_available};
use crate::resource_counter;
use crate::test_host::Host;

#[test]
fn auto_takes_the_cheaper_path_and_reports_the_reason() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Auto;
    let mut host = Host::new(gpu(), &scene).unwrap();
    let class = host.renderer.context().path_model();
    let expensive = |mut costs: PathCosts| {
        costs.fragment = 1.0e3;
        costs
    };
    let with_costs = |raster: PathCosts, tiled: PathCosts| {
        let mut model = class;
        model.raster = raster;
        model.tiled = tiled;
        model
    };
    // The first frame takes the cheaper path at once.
    let models = [
        (expensive(class.raster), class.tiled, RenderPath::Tiled),
        (class.raster, expensive(class.tiled), RenderPath::Raster),
    ];
    for (raster, tiled, path) in models {
        let mut host = Host::new(gpu(), &scene).unwrap();
        let mut model = with_costs(raster, tiled);
        model.source = PathModelSource::Host;
        host.renderer.context().set_path_model(model).unwrap();
        assert_eq!(host.renderer.path_choice(0), None);
        host.draw(gpu(), &scene).unwrap();
        let choice = host.renderer.path_choice(0).unwrap();
        assert_eq!(choice.path, path);
        let PathReason::Expected { raster_ms, tiled_ms, layers: Some(layers), source } = choice.reason else {
            panic!("{choice}")
        };
        assert_eq!((raster_ms < tiled_ms, source), (path == RenderPath::Raster, PathModelSource::Host));
        // Equal to the renderer's overdraw, except for the part of the target that the bounding box does not cover.
        let counted = host.renderer.overdraw().mean() as f32;
        assert!((0.5..1.1).contains(&(layers / counted)), "{layers} layers, counted {counted}");
        assert!(choice.to_string().contains("overdraw"), "{choice}");
        assert_eq!(host.renderer.memory_use().tiled.total() > 0, path == RenderPath::Tiled);
    }
    // A buffer that compute shaders cannot read is drawn by raster.
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    host.renderer.context().set_path_model(with_costs(expensive(class.raster), class.tiled)).unwrap();
    host.draw_buffer(gpu(), &scene, &scene.particles).unwrap();
    let choice = host.renderer.path_choice(0).unwrap();
    assert_eq!((choice.path, choice.reason), (RenderPath::Raster, PathReason::BufferNotReadable));
    let bytes: Vec<u8> = bytemuck::cast_slice(&scene.particles).to_vec();
    let buffer = storage_buffer(&bytes);
    let count = scene.particles.len() as u32;
    host.draw_particles(gpu(), &scene, Particles::Buffer(ParticleBuffer::new(&buffer, count))).unwrap();
    let choice = host.renderer.path_choice(0).unwrap();
    assert!(choice.path == RenderPath::Tiled && choice.to_string().contains("unknown, assumed 16"), "{choice}");
    // If the settings name a path, `auto` makes no choice.
    scene.settings.path = RenderPath::Raster;
    host.draw(gpu(), &scene).unwrap();
    assert_eq!(host.renderer.path_choice(0), None);
    let mut model = class;
    model.raster.entry = -1.0;
    let message = host.renderer.context().set_path_model(model).unwrap_err().to_string();
    assert_eq!(message, "raster.entry: -1 is not valid; expected 0 or more");
    let mut model = class;
    model.cores = 0;
    let message = host.renderer.context().set_path_model(model).unwrap_err().to_string();
    assert_eq!(message, "cores: 0 is not valid; expected 1 or more");
    gpu().check().unwrap();
}

#[test]
fn auto_switches_only_after_a_lasting_advantage() {
    if !is_tiled_available() {
        return;
    }
    let mut scene = scene(Technique::Soft);
    scene.settings.path = RenderPath::Auto;
    let mut host = Host::new(gpu(), &scene).unwrap();
    let model = host.renderer.context().path_model();
    let set = |host: &Host, raster: f32, tiled: f32| {
        let costs = |fragment| {
            let mut costs = model.raster;
            costs.frame = 0.0;
            costs.texel = 0.0;
            costs.sprite = 0.0;
            costs.entry = 0.0;
            costs.fragment = fragment;
            costs
        };
        let mut model = model;
        model.raster = costs(raster);
        model.tiled = costs(tiled);
        model.source = PathModelSource::Host;
        host.renderer.context().set_path_model(model).unwrap();
    };
    let path = |host: &Host| host.renderer.path_choice(0).unwrap().path;
    set(&host, 1.0, 100.0);
    host.draw(gpu(), &scene).unwrap();
    assert_eq!(path(&host), RenderPath::Raster);
    // A path that is cheaper only in every other frame is never taken.
    let created = resource_counter::count(|| {
        for frame in 0..80 {
            set(&host, [1.0, 100.0][frame % 2], [100.0, 1.0][frame % 2]);
            host.draw(gpu(), &scene).unwrap();
            assert_eq!(path(&host), RenderPath::Raster);
        }
    });
    assert_eq!(created, 0);
    set(&host, 100.0, 1.0);
    let frames = (0..200).take_while(|_| {
        host.draw(gpu(), &scene).unwrap();
        path(&host) == RenderPath::Raster
    });
    assert!((20..60).contains(&frames.count()));
    let created = resource_counter::count(|| (0..5).for_each(|_| host.draw(gpu(), &scene).unwrap()));
    assert_eq!(created, 0);
}

#[test]
fn measured_costs_of_both_paths_are_plausible() {
    if !is_tiled_available() {
        return;
    }
    let scene = scene(Technique::Soft);
    let host = Host::new(gpu(), &scene).unwrap();
    let context = host.renderer.context();
    let before = context.path_model();
    let model = context.measure_paths(|encoder| gpu().submit(encoder)).unwrap();
    assert_eq!((model, model.source), (context.path_model(), PathModelSource::Probe));
    // On any machine, a fragment takes between 0.1 ps and 1 ms. Costs are in nanoseconds.
    for costs in [model.raster, model.tiled] {
        assert!((1.0e-4..1.0e6).contains(&costs.fragment), "{costs:?}");
    }
    assert!(before.source != PathModelSource::Probe);
    gpu().check().unwrap();
}
