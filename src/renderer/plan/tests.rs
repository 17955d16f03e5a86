//! Tests of planning.

use haze_core::settings::{DiffuseMode, FadeCurve, RenderPath};

use super::*;
use crate::renderer::pass::upsample_lit::PIXELS;
use wgpu::TextureFormat::{Depth24Plus, Depth32Float, Rgba16Float};

fn inputs() -> PipelineInputs<'static> {
    PipelineInputs {
        host: HostPass { depth_format: Some(Depth32Float), ..HostPass::color_only(Rgba16Float) },
        exact_filtering: false,
        read_only_depth: true,
        tiles: Some(true),
        computes_pixels: false,
        scene_depth: SceneDepthKind::BufferAndLinear(Depth24Plus),
        reversed: false,
        mirrored: false,
        debug_views: &[DebugView::Final],
    }
}

fn resolved(settings: &Settings) -> ResolvedSettings {
    ResolvedSettings::new(settings, 1.0, UVec2::new(1280, 720), 2.0, &RampSteps::default(), Support::ALL)
}

fn deferred<'a>(inputs: &PipelineInputs<'a>, settings: &Settings) -> DeferredPlan<'a> {
    match plan(inputs, &resolved(settings), false) {
        Plan::Deferred(plan) => plan,
        other => panic!("{other:?}"),
    }
}

#[test]
fn planned_depth_reads_and_tests_match_the_table_in_the_docs() {
    let table = include_str!("../../../docs/depth.md");
    let rows = table
        .lines()
        .filter(|line| ["| Buffer ", "| Linear ", "| BufferAndLinear "].iter().any(|k| line.starts_with(k)));
    let mut seen = 0;
    for row in rows {
        let cells: Vec<_> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [depth, technique, source, backend, read, compared, tested] = cells[..] else { panic!("{row}") };
        let inputs = PipelineInputs {
            scene_depth: match depth {
                "Buffer" => SceneDepthKind::Buffer(Depth24Plus),
                "Linear" => SceneDepthKind::Linear,
                _ => SceneDepthKind::BufferAndLinear(Depth24Plus),
            },
            read_only_depth: backend != "OpenGL",
            ..inputs()
        };
        // "soft" in the table stands for all other techniques.
        let techniques =
            Technique::ALL.iter().filter(|t| (**t == Technique::SoftLinear) == (technique == "soft_linear"));
        for &technique in techniques {
            let mut settings = Settings { technique, ..Settings::default() };
            settings.accumulate.depth_source = source.parse().unwrap();
            let plan = deferred(&inputs, &settings);
            assert_eq!(plan.reads_linear, read == "linear", "{row}");
            assert_eq!(plan.accumulate.host_depth, compared == "host's", "{row}");
            assert_eq!(plan.texels.depth_downsample.is_some(), compared == "reduced", "{row}");
            let test = match tested {
                "reduced" => DepthTest::Reduced,
                "copy" => DepthTest::Copy,
                _ => DepthTest::Host(Depth24Plus, false),
            };
            assert_eq!(plan.accumulate.depth_test, test, "{row}");
            assert_eq!(plan.texels.depth_copy.is_some(), tested == "copy", "{row}");
            settings.soft_fade.curve = FadeCurve::Always;
            let always = deferred(&inputs, &settings).accumulate.depth_test;
            assert_eq!(always, if technique.is_soft() { DepthTest::InShader } else { test }, "{row}");
            seen += 1;
        }
    }
    assert!(seen > 60, "{seen}");
}

#[test]
fn compute_shaders_read_the_hosts_depth_in_place_at_scale_1() {
    let all = PipelineInputs { debug_views: DebugView::ALL, ..inputs() };
    for (path, scale, inputs, in_place) in [
        (RenderPath::Tiled, 1, inputs(), true),
        (RenderPath::Tiled, 2, inputs(), false),
        (RenderPath::Raster, 1, inputs(), false),
        // The hardware counts layers, and tests the reduced depth.
        (RenderPath::Tiled, 1, all, false),
    ] {
        let mut settings = Settings { path, ..Settings::default() };
        settings.accumulate.downscale = scale;
        let plan = deferred(&inputs, &settings);
        assert_eq!(plan.texels.depth_downsample.is_none(), in_place, "{path:?} {scale}");
        assert_eq!(plan.tiled.is_some_and(|keys| keys.accumulate.host_depth), in_place, "{path:?} {scale}");
    }
}

#[test]
fn each_stage_plans_only_the_passes_that_it_shows() {
    for &debug_view in DebugView::ALL {
        let mut settings = Settings::default();
        let inputs = PipelineInputs { debug_views: &[debug_view], ..inputs() };
        let shown = deferred(&inputs, &settings);
        let glows = matches!(debug_view, DebugView::Final | DebugView::SpecularScatter);
        assert_eq!(shown.specular_scatter.is_some(), glows, "{debug_view:?}");
        let debug_views: Vec<_> = shown.transfers().map(|key| key.debug_view).collect();
        let is_drawn = debug_view != DebugView::SpecularScatter && !shown.draws_lit(debug_view);
        assert_eq!(debug_views, if is_drawn { vec![debug_view] } else { vec![] });
        assert_eq!(shown.overdraw.is_some(), debug_view == DebugView::Overdraw);
        assert!(!shown.accumulate.overdraw);
        settings.specular_scatter.intensity = 0.0;
        assert_eq!(deferred(&inputs, &settings).specular_scatter, None);
        // Forward sprites are lit as they are drawn: there are no intermediate stages to show.
        settings.path = RenderPath::Forward;
        let shows_lit_smoke = matches!(debug_view, DebugView::Final | DebugView::Combined);
        assert_eq!(plan(&inputs, &resolved(&settings), false) != Plan::Skip, shows_lit_smoke, "{debug_view:?}");
    }
}

#[test]
fn only_the_modes_cubemap_and_motif_bake_light() {
    for &mode in DiffuseMode::ALL {
        let mut settings = Settings::default();
        settings.diffuse.mode = mode;
        let bakes = matches!(mode, DiffuseMode::Cubemap | DiffuseMode::Motif);
        assert_eq!(deferred(&inputs(), &settings).diffuse_bake.is_some(), bakes, "{mode:?}");
    }
}

#[test]
fn light_target_is_planned_only_for_final_images_at_reduced_resolution_or_if_computed() {
    let mut settings = Settings::default();
    settings.accumulate.lighting_resolution = LightingResolution::Full;
    assert_eq!(deferred(&inputs(), &settings).texels.light_target, None);
    settings.accumulate.lighting_resolution = LightingResolution::Target;
    for &debug_view in DebugView::ALL {
        let inputs = PipelineInputs { debug_views: &[debug_view], ..inputs() };
        let shown = deferred(&inputs, &settings);
        let shows_lit_smoke = matches!(debug_view, DebugView::Final | DebugView::Combined);
        let needs_lit = shows_lit_smoke || debug_view == DebugView::SpecularScatter;
        assert_eq!(shown.texels.light_target.is_some(), needs_lit, "{debug_view:?}");
        assert_eq!(shown.draws_lit(debug_view), shows_lit_smoke, "{debug_view:?}");
        assert_eq!(shown.texels.depth_slopes.is_some(), needs_lit, "{debug_view:?}");
    }
    let all = PipelineInputs { debug_views: DebugView::ALL, ..inputs() };
    let by_transfer: Vec<_> = deferred(&all, &settings).transfers().map(|key| key.debug_view).collect();
    let lit = [DebugView::Final, DebugView::Combined, DebugView::SpecularScatter];
    assert!(DebugView::ALL.iter().all(|view| by_transfer.contains(view) != lit.contains(view)), "{by_transfer:?}");
    settings.accumulate.upsample = Upsample::Bilinear;
    assert_eq!(deferred(&inputs(), &settings).texels.depth_slopes, None);
    settings.accumulate.downscale = 1;
    let computed = deferred(&inputs(), &settings);
    assert!(computed.texels.light_target.is_some() && computed.texels.depth_slopes.is_none());
    assert!(computed.texels.mark_cells.is_none());
    let drawn = PipelineInputs { tiles: None, ..inputs() };
    assert_eq!(deferred(&drawn, &settings).texels.light_target, None);
    settings.accumulate.max_side = 1279;
    let drawn = deferred(&drawn, &settings);
    assert!(
        drawn.texels.light_target.is_some()
            && drawn.texels.mark_cells.is_some()
            && drawn.transfer_lit.is_some_and(|key| !key.pixel.glows)
    );
}

#[test]
fn pixels_are_computed_where_that_saves_time_and_all_debug_views_show_the_same() {
    let mut settings = Settings { path: RenderPath::Tiled, ..Settings::default() };
    settings.accumulate.fix_scale(2);
    let is_computed = |inputs: &PipelineInputs<'_>, settings: &Settings| {
        let plan = deferred(inputs, settings);
        assert_eq!(plan.texels.upsample_lit.is_some(), plan.transfer_lit.is_some_and(|key| key.computed));
        plan.texels.upsample_lit.is_some()
    };
    assert!(!is_computed(&inputs(), &settings), "a device that draws fast");
    let slow = PipelineInputs { computes_pixels: true, ..inputs() };
    assert!(is_computed(&slow, &settings));
    assert!(!is_computed(&PipelineInputs { tiles: None, ..slow }, &settings), "no compute shaders");
    let both = PipelineInputs { debug_views: &[DebugView::Final, DebugView::Combined], ..slow };
    assert!(!is_computed(&both, &settings), "with and without glow");
    let one = PipelineInputs { debug_views: &[DebugView::Final, DebugView::Normals], ..slow };
    assert!(is_computed(&one, &settings));
    settings.accumulate.fix_scale(1);
    assert!(!is_computed(&slow, &settings), "scale 1");
    settings.accumulate.fix_scale(2);
    settings.specular_scatter.intensity = 0.0;
    assert!(is_computed(&both, &settings), "no glow");
    settings.accumulate.lighting_resolution = LightingResolution::Full;
    assert!(!is_computed(&slow, &settings), "light per pixel");
}

#[test]
fn one_of_each_covers_every_pass() {
    for read_only_depth in [true, false] {
        let [Plan::Deferred(deferred), Plan::Deferred(lit), Plan::Forward(_), Plan::Deferred(tiled)] =
            plans_covering_every_pass(read_only_depth, Some(true))
        else {
            panic!()
        };
        assert!(deferred.texels.light_target.is_none() && lit.texels.light_target.is_some());
        assert!(deferred.texels.depth_downsample.is_some() && deferred.diffuse_bake.is_some());
        assert!(deferred.transfers().count() == 1 && deferred.specular_scatter.is_some());
        assert!(tiled.tiled.is_some() && deferred.tiled.is_none());
        assert!(tiled.texels.upsample_lit.is_some() && lit.texels.upsample_lit.is_none());
        // The last target of the last pass: all before it have found a slot.
        let targets = tiled.texels.targets();
        assert!(targets.iter().flatten().any(|planned| planned.target == PIXELS), "{targets:?}");
    }
}

#[test]
fn transfer_key_follows_mirroring_reversed_depth_and_missing_depth_attachment() {
    let transfer = |inputs: &PipelineInputs, back_faces| match plan(inputs, &resolved(&Settings::default()), back_faces)
    {
        Plan::Deferred(plan) => plan.transfer,
        other => panic!("{other:?}"),
    };
    let plain = transfer(&inputs(), false);
    assert!(!plain.drawn.back_faces && !plain.drawn.mirrored && !plain.drawn.reversed);
    assert!(transfer(&inputs(), true).drawn.back_faces);
    assert!(transfer(&PipelineInputs { mirrored: true, ..inputs() }, false).drawn.mirrored);
    assert!(transfer(&PipelineInputs { reversed: true, ..inputs() }, false).drawn.reversed);
    // Without a depth attachment, back faces are drawn.
    let untested = PipelineInputs { host: HostPass::color_only(Rgba16Float), ..inputs() };
    assert!(transfer(&untested, false).drawn.back_faces);
}
