//! Drawings of the frame in ARCHITECTURE.md and in the docs of the library, against what frames record.

use glam::{Mat4, Vec3};
use haze::{FrameTimes, Particles, PathModelSource, shader};
use haze_core::assets::image::Image;
use haze_core::emitter::Emitter;
use haze_core::settings::{DiffuseMode, LightingResolution, RenderPath};

use super::{SIZE, draw_and_measure, pass_names, result_after, timed_gpu, timed_host};
use crate::gpu::is_tiled_available;
use crate::test_scene::{DepthKind, TestScene, TestShadowMap};

/// Lines of a drawing, each with the pass at its head and all passes that it names.
fn lines(document: &str) -> Vec<(Option<&'static str>, Vec<&'static str>)> {
    let passes = || shader::sources().iter().filter_map(|(file, _)| file.strip_suffix(".wgsl"));
    let start = document.lines().position(|line| line.contains("measure            ")).unwrap();
    let drawing = document.lines().skip(start).take_while(|line| !line.contains("```"));
    drawing
        .map(|line| {
            let words: Vec<_> = line.split(|letter: char| letter != '_' && !letter.is_alphanumeric()).collect();
            let head = passes().find(|pass| line.contains(&format!(" {pass}  ")));
            (head, passes().filter(|pass| words.contains(pass)).collect())
        })
        .collect()
}

/// Returns the passes of some frames that together record most passes, in order.
fn recorded_frames() -> Vec<Vec<String>> {
    let Some(gpu) = timed_gpu().filter(|_| is_tiled_available()) else { return Vec::new() };
    let mut raster = TestScene::new(SIZE);
    raster.settings.diffuse.mode = DiffuseMode::Cubemap;
    raster.settings.accumulate.lighting_resolution = LightingResolution::Full;
    raster.settings.shadow.strength = 1.0;
    raster.scene_ambient = Some(Vec3::splat(0.2));
    raster.shadow_maps = vec![TestShadowMap {
        light: 0,
        layers: vec![Image::new(SIZE, 1.0)],
        clip_from_world: vec![Mat4::IDENTITY],
        reversed: false,
    }];
    let mut lit = raster.clone();
    lit.settings.accumulate.lighting_resolution = LightingResolution::Target;
    let mut tiled = lit.clone();
    tiled.settings.path = RenderPath::Tiled;
    tiled.settings.accumulate.downscale = 2;
    let mut forward = raster.clone();
    forward.settings.path = RenderPath::Forward;
    let mut multisampled = raster.clone();
    multisampled.depth = DepthKind::Multisampled;
    multisampled.host.samples = 4;
    let scenes = [raster, lit, tiled, forward, multisampled];
    let names = |times: FrameTimes| pass_names(&times).into_iter().map(str::to_owned).collect();
    let mut frames = Vec::new();
    for scene in &scenes {
        let (mut host, timing) = timed_host(gpu, scene);
        let context = host.renderer.context();
        // As on a GPU that draws slowly, which computes pixels.
        context.set_cooperative_traversal(scene.settings.path == RenderPath::Tiled);
        let mut model = context.path_model();
        model.raster.fragment = 100.0 * model.tiled.fragment;
        model.source = PathModelSource::Host;
        context.set_path_model(model).unwrap();
        frames.push(names(draw_and_measure(gpu, &mut host, &timing, scene)));
        let emission = Emitter::default().snapshot(2.0);
        let seen = timing.latest().map(|times| times.frame);
        host.draw_particles(gpu, scene, Particles::Emitter(&emission)).unwrap();
        frames.push(names(result_after(&timing, seen)));
    }
    frames
}

#[test]
fn drawings_of_the_frame_show_every_recorded_pass_in_order() {
    let frames = recorded_frames();
    let recorded: std::collections::BTreeSet<_> = frames.iter().flatten().filter(|name| *name != "host").collect();
    assert!(frames.is_empty() || recorded.len() >= 16, "{recorded:?}");
    for (document, text) in [
        ("ARCHITECTURE.md", include_str!("../../../ARCHITECTURE.md")),
        ("src/lib.rs", include_str!("../../../src/lib.rs")),
    ] {
        let lines = lines(text);
        let heads: Vec<_> = lines.iter().filter_map(|(head, _)| *head).collect();
        for name in &recorded {
            assert!(lines.iter().any(|(_, named)| named.contains(&name.as_str())), "{document} does not show {name}");
        }
        for frame in &frames {
            // `sort` is a step of tiled frames, too.
            let drawn = |name: &&String| heads.contains(&name.as_str()) && *name != "sort";
            let positions = frame.iter().filter(drawn).map(|name| heads.iter().position(|head| head == name));
            assert!(positions.is_sorted(), "{document} shows another order than {frame:?}");
        }
        assert_eq!(heads.len(), 17, "{document}: {heads:?}");
    }
}
