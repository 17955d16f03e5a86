//! Tests of the cost model.

use super::*;

fn workload(layers: f64) -> PathWorkload {
    let size = UVec2::new(1280, 720);
    PathWorkload {
        technique: Technique::Soft,
        sprites: 1000.0,
        fragments: layers * size.as_dvec2().element_product(),
        size,
        optical_depth: 0.05,
        scale: 1,
        attachments: 1,
        grain_octaves: 0,
        lookups: 0.0,
        is_assumed: false,
    }
}

#[test]
fn pixels_are_computed_on_devices_that_were_found_to_draw_slowly() {
    // The device of the defaults, before and after its probe.
    assert!(!PathModel::GPU.computes_pixels());
    let probed = PathModel::GPU.scaled_by_probe(PathModel::GPU.probe_bias());
    assert!(probed.computes_pixels());
    assert!(!PathModel::for_device_type(wgpu::DeviceType::Cpu).computes_pixels());
    // One that draws four times as fast.
    let [raster, tiled] = PathModel::GPU.probe_bias();
    assert!(!PathModel::GPU.scaled_by_probe([0.25 * raster, tiled]).computes_pixels());
}

#[test]
fn early_stop_limits_the_cost_of_tiled_but_not_of_raster() {
    let model = PathModel::for_device_type(wgpu::DeviceType::Cpu);
    let [raster, tiled] = model.milliseconds(&workload(4.0));
    assert!(raster < tiled, "{raster} {tiled}");
    let [deep_raster, deep_tiled] = model.milliseconds(&workload(4000.0));
    assert!(deep_raster > 500.0 * raster && deep_tiled < 500.0 * tiled, "{deep_raster} {deep_tiled}");
    // A traversal that does not stop visits all layers.
    let [_, all] = model.milliseconds(&PathWorkload { optical_depth: 0.0, ..workload(4000.0) });
    assert!(all > 1.7 * deep_tiled);
}

#[test]
fn further_textures_and_grain_cost_raster_more_than_tiled_on_a_gpu() {
    let model = PathModel::GPU;
    let plain = PathWorkload { fragments: 0.7e6, size: UVec2::new(320, 180), ..workload(1.0) };
    let ratio = |of: PathWorkload| {
        let [raster, tiled] = model.milliseconds(&of);
        raster / tiled
    };
    let textures = ratio(PathWorkload { attachments: 4, ..plain });
    let grain = ratio(PathWorkload { attachments: 4, grain_octaves: 1, ..plain });
    assert!(textures > 2.0 * ratio(plain) && grain > 1.05 * textures, "{} {textures} {grain}", ratio(plain));
}

#[test]
fn small_deviations_of_a_cpu_probe_are_ignored() {
    let apart = |class: PathModel, for_each_field: f32| {
        let [raster, tiled] = class.probe_bias();
        let probed = class.scaled_by_probe([3.0 * raster, 3.0 * for_each_field * tiled]);
        let [raster, tiled] = [probed.raster.march / class.raster.march, probed.tiled.march / class.tiled.march];
        assert!((raster * tiled / (9.0 * for_each_field) - 1.0).abs() < 1.0e-4, "{raster} {tiled}");
        tiled / raster
    };
    let alike = |a: f32, b: f32| (a / b - 1.0).abs() < 1.0e-4;
    assert!(alike(apart(PathModel::CPU, 1.5), 1.0) && alike(apart(PathModel::CPU, 0.7), 1.0));
    assert!(
        alike(apart(PathModel::CPU, 2.0 * CPU_PROBE_TOLERANCE), 2.0)
            && alike(apart(PathModel::CPU, 0.5 / CPU_PROBE_TOLERANCE), 0.5)
    );
    assert!(alike(apart(PathModel::GPU, 1.5), 1.5), "a GPU's probe counts as measured");
}

#[test]
fn idle_cores_on_a_small_target_raise_the_cost_per_texel() {
    let model = PathModel { cores: 2, ..PathModel::CPU };
    let raster = |width, height| {
        let size = UVec2::new(width, height);
        let fragments = 100.0 * size.as_dvec2().element_product();
        let [raster, _] = model.milliseconds(&PathWorkload { size, fragments, sprites: 0.0, ..workload(1.0) });
        f64::from(raster - 1.0e-6 * model.raster.frame) / size.as_dvec2().element_product()
    };
    let alike = |a: f64, b: f64| (a / b - 1.0).abs() < 0.05;
    assert!(alike(raster(64, 64), 2.0 * raster(128, 64)) && alike(raster(128, 64), raster(640, 640)));
    assert!(alike(raster(96, 64), raster(128, 64) * 4.0 / 3.0), "one core of two does two thirds of the work");
}

#[test]
fn gpu_model_prefers_tiled_unless_the_load_is_small() {
    let model = PathModel::for_device_type(wgpu::DeviceType::DiscreteGpu);
    let small = UVec2::splat(128);
    let size = workload(1.0).size;
    for (size, layers, prefers_tiled) in
        [(small, 0.2, false), (size, 16.0, true), (size, 64.0, true), (size, 1024.0, true)]
    {
        let fragments = layers * size.as_dvec2().element_product();
        let [raster, tiled] = model.milliseconds(&PathWorkload { size, fragments, ..workload(layers) });
        assert_eq!(tiled < raster, prefers_tiled, "{layers}: {tiled} {raster}");
    }
}
