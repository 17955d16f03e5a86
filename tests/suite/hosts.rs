//! Hosts of every kind: several views, either hand, viewports, formats, samples, and what they may not hand over.

use std::sync::OnceLock;

use glam::camera::{lh, rh};
use glam::{Mat4, UVec2, Vec3, Vec4, vec3};
use haze::formula::colour::gamma_target_colour;
use haze::headless::Headless;
use haze::picture::Picture;
use haze::settings::*;
use haze::{
    Bounds, Context, Descriptor, Error, Frame, Particle, Particles, Renderer, SceneDepth, SceneDepthKind, Settings,
    System, View, WarmUp, wgpu,
};

use crate::common::{AGREEMENT, gpu, psnr};
use crate::host::{Host, HostKind};
use crate::stage::{BACKDROP, DepthKind, Stage};

const SIZE: UVec2 = UVec2::new(160, 90);

/// A device with the optional formats of this adapter, which the others are made without.
fn featured() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| {
        let optional = wgpu::Features::DEPTH32FLOAT_STENCIL8
            | wgpu::Features::RG11B10UFLOAT_RENDERABLE
            | wgpu::Features::PIPELINE_CACHE;
        Headless::with(wgpu::Limits::default(), optional).unwrap()
    })
}

fn slice(stage: &Stage) -> Particles<'_> {
    Particles::Slice(&stage.particles)
}

fn encoder(gpu: &Headless) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
}

fn field<T>(result: Result<T, Error>) -> String {
    match result {
        Err(Error::Field(error)) => error.field,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("taken"),
    }
}

// views

#[test]
fn two_views_in_one_submission_are_as_two_frames() {
    let (left, mut right) = (Stage::new(SIZE), Stage::new(SIZE));
    right.view.view_from_world = Mat4::from_translation(vec3(-0.6, 0.2, 0.5));
    right.lights[0].intensity = 5.0;
    let alone = [left.on_gpu(gpu()).picture, right.on_gpu(gpu()).picture];
    assert!(psnr(&alone[0], &alone[1]) < 30.0, "the views are too much alike to tell");

    let mut one = Host::new(gpu(), &left).unwrap();
    let context = one.renderer.context().clone();
    let mut other = Host::on(gpu(), &right, Some(&context)).unwrap();
    // Materials are the device's, not the view's.
    other.material = one.material.clone();
    for _ in 0..2 {
        let mut encoder = encoder(gpu());
        one.prepare(gpu(), &mut encoder, &left, slice(&left)).unwrap();
        other.prepare(gpu(), &mut encoder, &right, slice(&right)).unwrap();
        one.render(&mut encoder, &left);
        other.render(&mut encoder, &right);
        gpu().submit(encoder).unwrap();
        assert!(one.picture(gpu()).unwrap() == alone[0] && other.picture(gpu()).unwrap() == alone[1]);
    }
    // The second view compiled nothing that the first had not.
    let mut third = Host::on(gpu(), &left, Some(&context)).unwrap();
    let compiled = context.pipeline_count();
    third.draw(gpu(), &left).unwrap();
    assert_eq!(context.pipeline_count(), compiled);
}

#[test]
fn a_second_prepare_before_the_first_is_submitted_is_refused() {
    let stage = Stage::new(SIZE);
    let picture = stage.on_gpu(gpu()).picture;
    let mut host = Host::new(gpu(), &stage).unwrap();
    let refused = |host: &mut Host| {
        let mut encoder = encoder(gpu());
        field(host.prepare(gpu(), &mut encoder, &stage, slice(&stage)))
    };
    // Neither in the same encoder nor in another.
    let mut first = encoder(gpu());
    host.prepare(gpu(), &mut first, &stage, slice(&stage)).unwrap();
    assert_eq!(field(host.prepare(gpu(), &mut first, &stage, slice(&stage))), "prepare");
    assert_eq!(refused(&mut host), "prepare");
    // An encoder that is dropped is forgotten.
    drop(first);
    let mut second = encoder(gpu());
    host.prepare(gpu(), &mut second, &stage, slice(&stage)).unwrap();
    // Passes in an encoder of their own count as well, also after the first is gone.
    let mut passes = encoder(gpu());
    host.render(&mut passes, &stage);
    gpu().submit(second).unwrap();
    assert_eq!(refused(&mut host), "prepare");
    // What is submitted is not waited for.
    gpu().queue.submit([passes.finish()]);
    let mut third = encoder(gpu());
    host.prepare(gpu(), &mut third, &stage, slice(&stage)).unwrap();
    host.render(&mut third, &stage);
    gpu().submit(third).unwrap();
    assert!(host.picture(gpu()).unwrap() == picture);
    gpu().check().unwrap();
}

fn warm_up<'a>(stage: &'a Stage, settings: &'a [Settings]) -> WarmUp<'a> {
    let scene_depth = match stage.depth {
        DepthKind::Buffer => SceneDepthKind::Buffer(stage.host.depth_format),
        DepthKind::Linear => SceneDepthKind::Linear,
        DepthKind::Both => SceneDepthKind::Both(stage.host.depth_format),
    };
    WarmUp { view: stage.view, scene_depth, settings, stages: std::slice::from_ref(&stage.shade_tree) }
}

#[test]
fn the_first_frame_after_a_warm_up_compiles_nothing() {
    for &technique in Technique::ALL {
        for path in [Path::Raster, Path::Forward] {
            let mut stage = Stage::new(SIZE);
            (stage.depth, stage.attach_depth) = (DepthKind::Both, true);
            (stage.settings.technique, stage.settings.path) = (technique, path);
            stage.settings.diffuse.mode = DiffuseMode::Cubemap;
            // One frame or several: sprites are not known to a warm-up.
            if path == Path::Raster {
                (stage.material.sprite, stage.material.detail, stage.material.six_way) = crate::techniques::flipbook();
            }
            stage.settings.accumulate.lighting_resolution = LightingResolution::Target;
            let mut host = Host::new(gpu(), &stage).unwrap();
            assert_eq!(host.renderer.context().pipeline_count(), 0);
            host.renderer.warm_up(&warm_up(&stage, &[stage.settings])).unwrap();
            let warm = host.renderer.context().pipeline_count();
            assert!(warm > 0);
            host.draw(gpu(), &stage).unwrap();
            // With the camera inside the box, too.
            stage.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
            host.draw(gpu(), &stage).unwrap();
            assert_eq!(host.renderer.context().pipeline_count(), warm, "{} {}", technique.name(), path.name());
        }
    }
}

#[test]
fn a_warm_up_runs_beside_the_frame() {
    let mut stage = Stage::new(SIZE);
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.draw(gpu(), &stage).unwrap();
    let context = host.renderer.context().clone();
    stage.settings.technique = Technique::SphericalBillboard;
    let (settings, attach_depth) = ([stage.settings], stage.attach_depth);
    let expected = warm_up(&stage, &settings);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let depth_format = attach_depth.then_some(wgpu::TextureFormat::Depth32Float);
            let own =
                Descriptor { context: Some(&context), depth_format, exact_filtering: true, ..Descriptor::default() };
            Renderer::new(&gpu().device, &gpu().queue, &own).unwrap().warm_up(&expected).unwrap();
        });
    });
    let warm = context.pipeline_count();
    host.draw(gpu(), &stage).unwrap();
    assert_eq!(context.pipeline_count(), warm);
    let unusable = WarmUp { settings: &[Settings { boost: -1.0, ..Settings::default() }], ..expected };
    assert_eq!(field(host.renderer.warm_up(&unusable)), "settings[0].boost");
}

#[test]
#[allow(unsafe_code, reason = "wgpu takes cache data from anywhere, and cannot check it; this is its own")]
fn pipelines_go_into_the_hosts_cache_and_come_out_of_it() {
    let gpu = featured();
    if !gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE) {
        return;
    }
    let draw = |data: Option<&[u8]>| {
        let descriptor = wgpu::PipelineCacheDescriptor { label: None, data, fallback: true };
        let cache = unsafe { gpu.device.create_pipeline_cache(&descriptor) };
        let empty = cache.get_data().map_or(0, |data| data.len());
        let context = Context::new(&gpu.device, &gpu.queue, Some(&cache));
        let stage = Stage::new(SIZE);
        let mut host = Host::on(gpu, &stage, Some(&context)).unwrap();
        host.draw(gpu, &stage).unwrap();
        gpu.check().unwrap();
        (empty, cache.get_data().unwrap(), host.picture(gpu).unwrap())
    };
    let (empty, filled, picture) = draw(None);
    let (loaded, _, again) = draw(Some(&filled));
    assert!(loaded == filled.len() && again == picture, "{loaded} bytes of {}", filled.len());
    // Mesa's software driver keeps nothing but a header.
    let keeps = !gpu.adapter.get_info().name.contains("llvmpipe");
    assert!(!keeps || filled.len() > empty, "{} bytes after {empty}", filled.len());
}

/// The stage in another world: every point moved by `turn`, which may mirror.
fn in_world(mut stage: Stage, turn: Mat4) -> Stage {
    stage.view.view_from_world *= turn.inverse();
    stage.particles.iter_mut().for_each(|p| p.position = turn.transform_point3(p.position));
    for light in &mut stage.lights {
        light.position = turn.transform_point3(light.position);
        light.direction = turn.transform_vector3(light.direction);
    }
    stage
}

#[test]
fn every_hand_and_every_up_gives_the_same_picture() {
    let flip = |x, y, z| Mat4::from_scale(vec3(x, y, z));
    let z_view = |mut stage: Stage| {
        stage.view.view_from_world = flip(1.0, 1.0, -1.0) * stage.view.view_from_world;
        stage.view.clip_from_view *= flip(1.0, 1.0, -1.0);
        stage.ahead = 1.0;
        stage
    };
    let z_up = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    type Change<'a> = &'a dyn Fn(Stage) -> Stage;
    let hosts: [(&str, Change); 5] = [
        ("a left-handed world", &|stage| in_world(stage, flip(1.0, 1.0, -1.0))),
        ("a left-handed world that looks along +z", &|stage| z_view(in_world(stage, flip(1.0, 1.0, -1.0)))),
        ("a world with z up", &|stage| in_world(stage, z_up)),
        ("+z view space", &z_view),
        ("a mirror", &|stage| in_world(stage, flip(-1.0, 1.0, 1.0))),
    ];
    for technique in
        [Technique::Soft, Technique::DepthSpriteSoft, Technique::SphericalBillboard, Technique::VolumetricSoft]
    {
        for (path, near_box) in [(Path::Raster, false), (Path::Raster, true), (Path::Forward, false)] {
            let stage = || {
                let mut stage = Stage::new(SIZE);
                (stage.settings.technique, stage.settings.path) = (technique, path);
                if near_box {
                    stage.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
                }
                stage
            };
            let picture = stage().on_gpu(gpu()).picture;
            for (name, change) in hosts {
                let name = format!("{name}, {} {} {near_box}", technique.name(), path.name());
                let stage = change(stage());
                let seen = stage.on_gpu(gpu()).picture;
                let reference = psnr(&seen, &stage.on_cpu());
                assert!(reference >= AGREEMENT, "{name}: {reference:.1} dB from the reference");
                // The noise of volumes fills the world: turned, it is another.
                let same_noise = !technique.is_volumetric() || name.starts_with("+z");
                let same = psnr(&seen, &picture);
                // Another order of f32 operations, seen through f16.
                assert!(!same_noise || same >= 85.0, "{name}: {same:.1} dB");
            }
        }
    }
}

#[test]
fn projections_that_turn_the_picture_over_and_views_that_begin_behind_the_viewer_agree() {
    let orthographic = |near| rh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, near, 80.0);
    let perspective = Stage::new(SIZE).view.clip_from_view;
    let cases = [
        ("upside down", Mat4::from_scale(vec3(1.0, -1.0, 1.0)) * perspective, Mat4::IDENTITY),
        ("left to right", Mat4::from_scale(vec3(-1.0, 1.0, 1.0)) * perspective, Mat4::IDENTITY),
        ("orthographic from behind", orthographic(-30.0), Mat4::IDENTITY),
        ("orthographic from inside", orthographic(-30.0), Mat4::from_translation(vec3(0.0, 0.0, 6.0))),
        (
            "orthographic along +z",
            lh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, -30.0, 80.0),
            Mat4::from_scale(vec3(1.0, 1.0, -1.0)),
        ),
    ];
    for (name, clip_from_view, view_from_world) in cases {
        for (depth, technique) in [(DepthKind::Buffer, Technique::Soft), (DepthKind::Linear, Technique::SoftLinear)] {
            for path in [Path::Raster, Path::Forward] {
                let mut stage = Stage::new(SIZE);
                (stage.view.clip_from_view, stage.view.view_from_world) = (clip_from_view, view_from_world);
                (stage.depth, stage.settings.technique, stage.settings.path) = (depth, technique, path);
                // Fades by the distance from the near plane have no part in this.
                stage.settings.soft_fade.near_fade_end = 0.0;
                stage.ahead = if name.ends_with("+z") { 1.0 } else { -1.0 };
                let picture = stage.on_gpu(gpu()).picture;
                assert!(picture.texels.iter().any(|&texel| texel != BACKDROP), "{name}: no smoke");
                let psnr = psnr(&picture, &stage.on_cpu());
                assert!(psnr >= AGREEMENT, "{name}, {}, {}: {psnr:.1} dB", technique.name(), path.name());
            }
        }
    }
    // Where an orthographic viewer stands changes nothing.
    let seen_from = |near: f32, distance: f32| {
        let mut stage = Stage::new(SIZE);
        stage.settings.soft_fade.near_fade_end = 0.0;
        stage.view.clip_from_view = rh::proj::directx::orthographic(-4.0, 4.0, -2.25, 2.25, near, near + 80.0);
        stage.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, distance));
        // The scene is given by its distance from the viewer: an empty one is the same from everywhere.
        (stage.depth, stage.empty_linear) = (DepthKind::Linear, true);
        stage.attach_depth = false;
        stage.on_gpu(gpu()).picture
    };
    let psnr = psnr(&seen_from(0.5, 0.0), &seen_from(-19.5, 20.0));
    assert!(psnr >= 85.0, "{psnr:.1} dB");
}

#[test]
fn a_view_may_be_a_part_of_larger_targets() {
    let origin = UVec2::new(70, 31);
    type Change = fn(&mut Stage);
    let changes: &[(&str, Change)] = &[
        ("half scale", |_| {}),
        ("scale 3", |s| s.settings.accumulate.scale = 3),
        ("full scale", |s| s.settings.accumulate.scale = 1),
        ("host depth", |s| {
            (s.settings.accumulate.scale, s.settings.accumulate.depth_source) = (1, DepthSource::Host);
        }),
        ("forward", |s| s.settings.path = Path::Forward),
        ("forward sphere", |s| {
            (s.settings.path, s.settings.technique) = (Path::Forward, Technique::SphericalBillboard);
        }),
        ("reduced depth", |s| s.shade_tree = ShadeTree::ReducedDepth),
        ("specular", |s| s.shade_tree = ShadeTree::SpecularScatter),
        ("linear", |s| s.settings.technique = Technique::SoftLinear),
    ];
    for (name, change) in changes {
        let mut stage = Stage::new(SIZE);
        (stage.depth, stage.attach_depth) = (DepthKind::Both, true);
        // Out of the view on every side.
        stage.particles.iter_mut().for_each(|p| p.position *= vec3(1.6, 1.6, 1.0));
        change(&mut stage);
        let alone = stage.on_gpu(gpu()).picture;
        stage.host.target_size = Some(UVec2::new(260, 150));
        stage.view.origin = origin;
        let part = stage.on_gpu(gpu()).picture;
        let mut cropped = Picture::new(SIZE, Vec4::ZERO);
        cropped.for_each(|at, texel| *texel = part.load((at + origin).as_ivec2()));
        // Corners of sprites round to another 1/256 pixel at another place of a target.
        let same = psnr(&cropped, &alone);
        assert!(same >= 95.0, "{name}: {same:.1} dB");
        let outside = (0..260 * 150_u32).map(|i| UVec2::new(i % 260, i / 260));
        let mut outside = outside.filter(|at| at.cmplt(origin).any() || at.cmpge(origin + SIZE).any());
        assert!(outside.all(|at| part.load(at.as_ivec2()) == BACKDROP), "{name}: smoke beside the view");
        // The reference draws the view's own pixels.
        assert!(psnr(&cropped, &stage.on_cpu()) >= AGREEMENT, "{name}");
    }
    let mut stage = Stage::new(SIZE);
    stage.host.target_size = Some(UVec2::new(200, 100));
    stage.view.origin = UVec2::new(41, 0);
    assert_eq!(field(stage.try_on_gpu(gpu())), "view.size");
}

// stages

#[test]
fn one_prepare_shows_every_stage() {
    for path in [Path::Raster, Path::Forward] {
        let mut all = Stage::new(SIZE);
        (all.settings.path, all.stages) = (path, Some(ShadeTree::ALL));
        let mut host = Host::new(gpu(), &all).unwrap();
        let mut encoder = encoder(gpu());
        host.prepare(gpu(), &mut encoder, &all, slice(&all)).unwrap();
        gpu().submit(encoder).unwrap();
        for &stage in ShadeTree::ALL {
            let alone = Stage { shade_tree: stage, stages: None, ..Stage::new(SIZE) };
            let alone = Stage { settings: all.settings, ..alone };
            all.shade_tree = stage;
            let mut encoder = self::encoder(gpu());
            host.render(&mut encoder, &all);
            gpu().submit(encoder).unwrap();
            assert!(host.picture(gpu()).unwrap() == alone.on_gpu(gpu()).picture, "{path:?} {stage:?}");
        }
    }
    // A stage that was not to be shown draws nothing.
    let stage = Stage { stages: Some(&[ShadeTree::Final]), shade_tree: ShadeTree::Overdraw, ..Stage::new(SIZE) };
    assert!(stage.on_gpu(gpu()).picture.texels.iter().all(|texel| *texel == BACKDROP));
}

// passes

#[test]
fn passes_of_every_kind_show_the_same_smoke() {
    use wgpu::TextureFormat as Format;
    let host = HostKind::default;
    // The least agreement with the reference: floats of 11 and 10 bits round more than what is compared.
    let kinds = [
        ("four samples", AGREEMENT, HostKind { samples: 4, ..host() }),
        ("four samples, sRGB", AGREEMENT, HostKind { samples: 4, color_format: Format::Rgba8UnormSrgb, ..host() }),
        ("Depth24Plus", AGREEMENT, HostKind { depth_format: Format::Depth24Plus, ..host() }),
        ("Depth24PlusStencil8", AGREEMENT, HostKind { depth_format: Format::Depth24PlusStencil8, ..host() }),
        ("Depth32FloatStencil8", AGREEMENT, HostKind { depth_format: Format::Depth32FloatStencil8, ..host() }),
        ("Rg11b10Ufloat", 50.0, HostKind { color_format: Format::Rg11b10Ufloat, ..host() }),
        ("Rgba8UnormSrgb", AGREEMENT, HostKind { color_format: Format::Rgba8UnormSrgb, ..host() }),
        ("Bgra8UnormSrgb", AGREEMENT, HostKind { color_format: Format::Bgra8UnormSrgb, ..host() }),
        ("Rgba8Unorm, linear", AGREEMENT, HostKind { color_format: Format::Rgba8Unorm, ..host() }),
        (
            "four samples and stencil",
            AGREEMENT,
            HostKind { samples: 4, depth_format: Format::Depth24PlusStencil8, ..host() },
        ),
        ("velocity", AGREEMENT, HostKind { further: vec![Format::Rg16Float, Format::R8Unorm], ..host() }),
    ];
    for (name, least, kind) in kinds {
        for (path, attach_depth) in [(Path::Raster, true), (Path::Forward, true), (Path::Raster, false)] {
            let mut stage = Stage::new(SIZE);
            (stage.depth, stage.attach_depth) = (DepthKind::Both, attach_depth);
            stage.settings.path = path;
            stage.host = kind.clone();
            let mut host = match Host::new(featured(), &stage) {
                Ok(host) => host,
                // An adapter without the format says so by name.
                Err(Error::Field(error)) => {
                    eprintln!("left out: {name}: {error}");
                    continue;
                }
                Err(error) => panic!("{error}"),
            };
            host.draw(featured(), &stage).unwrap();
            featured().check().unwrap_or_else(|error| panic!("{name}: {error}"));
            let picture = host.picture(featured()).unwrap();
            let mut reference = stage.on_cpu();
            if kind.color_format != Format::Rgba16Float && kind.color_format != Format::Rg11b10Ufloat {
                reference.texels.iter_mut().for_each(|texel| *texel = texel.min(Vec4::ONE));
            }
            if kind.color_format == Format::Rg11b10Ufloat {
                reference.texels.iter_mut().for_each(|texel| texel.w = 1.0);
            }
            let psnr = psnr(&picture, &reference);
            println!("{name}, {}, depth {attach_depth}: {psnr:.1} dB", path.name());
            assert!(psnr >= least, "{name}, {}: {psnr:.1} dB", path.name());
            for (index, format) in kind.further.iter().enumerate() {
                let untouched = host.further(featured(), index).texels.iter().all(|texel| {
                    // The host cleared them to the backdrop.
                    (texel.x - BACKDROP.x).abs() < 1.0 / 255.0
                });
                assert!(untouched, "{format:?} was drawn to");
            }
        }
    }
}

#[test]
fn a_target_of_code_is_written_in_code() {
    use LightingResolution::{Full, Target};
    for (path, lighting_resolution) in [(Path::Raster, Full), (Path::Raster, Target), (Path::Forward, Full)] {
        let mut stage = Stage::new(SIZE);
        (stage.settings.path, stage.settings.accumulate.lighting_resolution) = (path, lighting_resolution);
        stage.settings.specular_scatter.intensity = 0.0;
        // Smoke that hides all there is: what is left is the light's code.
        stage.settings.boost = 16.0;
        stage.particles.iter_mut().for_each(|p| p.amount = 1.0);
        stage.lights.iter_mut().for_each(|light| light.intensity *= 0.1);
        let light = stage.on_cpu();
        stage.host.color_format = wgpu::TextureFormat::Rgba8Unorm;
        stage.host.gamma_target = true;
        let code = stage.on_gpu(gpu()).picture;
        let mut expected = light.clone();
        expected.for_each(|at, texel| {
            let light = light.load(at.as_ivec2());
            *texel = gamma_target_colour(light.truncate()).extend(light.w);
        });
        // At the rim smoke is blended: code there is no code of a blend. The middle is opaque.
        let middle = |picture: &Picture<Vec4>| {
            let mut part = Picture::new(UVec2::new(40, 20), Vec4::ZERO);
            part.for_each(|at, texel| *texel = picture.load((at + UVec2::new(60, 35)).as_ivec2()));
            part
        };
        let right = psnr(&middle(&code), &middle(&expected));
        assert!(right >= AGREEMENT, "{}: {right:.1} dB", path.name());
        // The mutant: light written as it is.
        stage.host.gamma_target = false;
        let dark = psnr(&middle(&stage.on_gpu(gpu()).picture), &middle(&expected));
        assert!(dark < 35.0, "{}: {dark:.1} dB", path.name());
    }
}

#[test]
fn a_pass_that_the_device_cannot_have_is_refused_by_name() {
    use wgpu::TextureFormat as Format;
    let new = |descriptor: &Descriptor<'_>| Renderer::new(&gpu().device, &gpu().queue, descriptor);
    let refused = |descriptor: Descriptor<'_>| field(new(&descriptor));
    let plain = Descriptor::default();
    new(&plain).unwrap();
    for color_format in
        [Format::Rgba8Uint, Format::Rgba8Snorm, Format::Rgb9e5Ufloat, Format::Depth32Float, Format::Bc1RgbaUnorm]
    {
        assert_eq!(refused(Descriptor { color_format, ..plain }), "color_format", "{color_format:?}");
    }
    assert_eq!(refused(Descriptor { depth_format: Some(Format::Rgba8Unorm), ..plain }), "depth_format");
    assert_eq!(refused(Descriptor { depth_format: Some(Format::Stencil8), ..plain }), "depth_format");
    for sample_count in [0, 3, 64] {
        assert_eq!(refused(Descriptor { sample_count, ..plain }), "sample_count", "{sample_count}");
    }
    let further = [None, Some(Format::Rgb9e5Ufloat)];
    assert_eq!(refused(Descriptor { further_color_formats: &further, ..plain }), "further_color_formats[1]");
    assert_eq!(refused(Descriptor { further_color_formats: &[None; 8], ..plain }), "further_color_formats");
    let srgb = Descriptor { color_format: Format::Rgba8UnormSrgb, gamma_target: true, ..plain };
    assert_eq!(refused(srgb), "gamma_target");
    let error = new(&Descriptor { color_format: Format::Rgba8Uint, ..plain }).unwrap_err().to_string();
    assert!(error.contains("Rgba8Uint") && error.contains("Rgba16Float") && !error.contains('\n'), "{error}");
    // The host's error handler has heard nothing of it.
    gpu().check().unwrap();
}

#[test]
fn what_belongs_to_another_device_is_refused() {
    let stage = Stage::new(SIZE);
    let here = gpu();
    // Devices of one adapter share its OpenGL context: what goes with one of them is gone for the other.
    if here.adapter.get_info().backend == wgpu::Backend::Gl {
        return;
    }
    let (device, queue) = pollster::block_on(here.adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap();
    let context = Context::new(&device, &queue, None);
    let of_another = Descriptor { context: Some(&context), ..Descriptor::default() };
    assert_eq!(field(Renderer::new(&here.device, &here.queue, &of_another)), "device");
    let mut host = Host::new(here, &stage).unwrap();
    assert_eq!(field(host.renderer.create_material(&device, &queue, &stage.material)), "device");
    let frame = Frame::new(stage.view, SceneDepth::Linear(&host.linear));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    assert_eq!(field(host.renderer.prepare(&device, &queue, &mut encoder, &frame)), "device");

    let material = context.create_material(&device, &queue, &stage.material).unwrap();
    let own = std::mem::replace(&mut host.material, material);
    assert_eq!(field(host.draw(here, &stage)), "systems[0].material");
    // Nor of another instance, whose devices wgpu itself may take for these.
    host.material = Host::new(featured(), &stage).unwrap().material;
    assert_eq!(field(host.draw(here, &stage)), "systems[0].material");
    host.material = own;
    let depth = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: host.depth.texture().size(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let depth = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let own = std::mem::replace(&mut host.depth, depth);
    assert_eq!(field(host.draw(here, &stage)), "scene_depth");
    host.depth = own;
    host.draw(here, &stage).unwrap();
    here.check().unwrap();
}

#[test]
fn depth_that_cannot_be_read_is_refused() {
    let mut stage = Stage::new(SIZE);
    stage.host.depth_format = wgpu::TextureFormat::Depth24PlusStencil8;
    (stage.depth, stage.attach_depth) = (DepthKind::Buffer, false);
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.draw(gpu(), &stage).unwrap();
    let texture = |layers, samples, usage| {
        gpu().device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage,
            view_formats: &[],
        })
    };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT;
    let whole = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let both_aspects = whole(host.depth.texture());
    let cases = [
        ("both aspects", both_aspects),
        ("two layers", whole(&texture(2, 1, usage))),
        ("four samples", whole(&texture(1, 4, usage))),
        ("not to be sampled", whole(&texture(1, 1, wgpu::TextureUsages::RENDER_ATTACHMENT))),
        ("a colour", whole(&host.colour)),
    ];
    for (name, view) in cases {
        let own = std::mem::replace(&mut host.depth, view);
        assert_eq!(field(host.draw(gpu(), &stage)), "scene_depth", "{name}");
        // Nothing of the last frame is drawn in its place.
        let mut encoder = encoder(gpu());
        host.render(&mut encoder, &stage);
        gpu().submit(encoder).unwrap();
        assert!(host.picture(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP), "{name}");
        host.depth = own;
    }
    // One layer of an array is as good as a texture of its own.
    let array = texture(3, 1, usage);
    host.depth = array.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: 1,
        array_layer_count: Some(1),
        ..Default::default()
    });
    host.draw(gpu(), &stage).unwrap();
    gpu().check().unwrap();
}

// particles, systems, memory

#[test]
fn a_buffer_may_begin_anywhere() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let mut draw = |offset: u64| {
        let mut bytes = vec![0x7f; offset as usize];
        bytes.extend_from_slice(bytemuck::cast_slice(&stage.particles));
        let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu().queue.write_buffer(&buffer, 0, &bytes);
        let particles = Particles::Buffer { buffer: &buffer, offset, count: stage.particles.len() as u32 };
        host.draw_particles(gpu(), &stage, particles).map(|()| host.picture(gpu()).unwrap())
    };
    let first = draw(0).unwrap();
    assert!(first.texels.iter().any(|&texel| texel != BACKDROP));
    for offset in [4, 32, 100] {
        assert!(draw(offset).unwrap() == first, "{offset}");
    }
}

#[test]
fn offsets_that_do_not_fit_are_refused() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 96,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let mut refused =
        |offset, count| field(host.draw_particles(gpu(), &stage, Particles::Buffer { buffer: &buffer, offset, count }));
    assert_eq!(refused(2, 1), "systems[0].particles.offset");
    assert_eq!(refused(36, 2), "systems[0].particles");
    assert_eq!(refused(u64::MAX - 3, 2), "systems[0].particles");
}

/// Frames of several systems, without a picture.
pub struct Systems {
    host: Host,
    pub stage: Stage,
}

impl Systems {
    pub fn new(gpu: &Headless, size: UVec2) -> Self {
        let stage = Stage::new(size);
        Self { host: Host::new(gpu, &stage).unwrap(), stage }
    }

    pub fn frame(&mut self, gpu: &Headless, systems: &[(u64, &[Particle], Settings)]) -> Result<(), Error> {
        let systems: Vec<_> = systems
            .iter()
            .map(|(key, particles, settings)| System {
                key: *key,
                ..System::new(Particles::Slice(particles), settings, &self.host.material)
            })
            .collect();
        let frame = Frame { systems: &systems, ..Frame::new(self.stage.view, SceneDepth::Linear(&self.host.linear)) };
        let mut encoder = encoder(gpu);
        self.host.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, &frame)?;
        gpu.submit(encoder)
    }

    fn accumulation(&self, key: u64) -> wgpu::TextureView {
        self.host.renderer.targets(key).unwrap().accumulation[0].clone()
    }
}

/// Longer than a renderer keeps what it does not need.
const LONG: u32 = 125;

#[test]
fn a_system_is_known_by_its_key() {
    let mut systems = Systems::new(gpu(), SIZE);
    let settings = Settings::default();
    let wide = systems.stage.particles.clone();
    let small = [Particle { position: vec3(0.0, 0.0, -6.0), radius: 0.2, ..Particle::default() }];
    systems.frame(gpu(), &[(7, &wide, settings), (9, &small, settings)]).unwrap();
    let targets = [systems.accumulation(7), systems.accumulation(9)];
    // Another order, and one of them gone for a while: each keeps its own.
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    systems.frame(gpu(), &[(9, &small, settings)]).unwrap();
    assert!(systems.host.renderer.targets(7).is_none());
    systems.frame(gpu(), &[(9, &small, settings), (7, &wide, settings)]).unwrap();
    assert_eq!(targets, [systems.accumulation(7), systems.accumulation(9)]);
    let twice = systems.frame(gpu(), &[(9, &small, settings), (9, &wide, settings)]);
    assert_eq!(field(twice), "systems[1].key");
}

#[test]
fn what_is_no_longer_needed_is_given_back() {
    let mut systems = Systems::new(gpu(), UVec2::new(1280, 720));
    let settings = Settings::default();
    let few = systems.stage.particles[..2].to_vec();
    // One over the whole view, and many that are uploaded but out of it.
    let mut near = vec![Particle { position: vec3(0.0, 0.0, 9.0), radius: 0.1, ..Particle::default() }; 20_000];
    near[0] = Particle { position: vec3(0.0, 0.0, -1.0), radius: 4.0, amount: 0.1, ..Particle::default() };
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    let small = systems.host.renderer.memory_use();
    systems.frame(gpu(), &[(1, &near, settings)]).unwrap();
    let spike = systems.host.renderer.memory_use();
    assert!(spike.targets > 4 * small.targets && spike.buffers > 100_000, "{small:?} {spike:?}");
    // Not at once: the next spike may be near.
    systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    assert_eq!(systems.host.renderer.memory_use(), spike);
    for _ in 0..LONG {
        systems.frame(gpu(), &[(1, &few, settings)]).unwrap();
    }
    assert_eq!(systems.host.renderer.memory_use(), small);
    // A system behind the viewer keeps no targets, one that is gone keeps nothing.
    let behind: Vec<_> = few.iter().map(|p| Particle { position: -p.position, ..*p }).collect();
    for _ in 0..LONG {
        systems.frame(gpu(), &[(1, &behind, settings)]).unwrap();
    }
    assert_eq!(systems.host.renderer.memory_use().targets, 0);
    for _ in 0..LONG {
        systems.frame(gpu(), &[]).unwrap();
    }
    let view_only = systems.host.renderer.memory_use();
    assert!(view_only.targets == 0 && view_only.buffers < 1000, "{view_only:?}");
}

#[test]
fn baked_light_outlives_a_resize() {
    let mut stage = Stage::new(SIZE);
    stage.settings.diffuse.mode = DiffuseMode::Cubemap;
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.draw(gpu(), &stage).unwrap();
    let views = |host: &Host| {
        let targets = host.renderer.targets(0).unwrap();
        (targets.accumulation.to_vec(), targets.baked_diffuse.to_vec())
    };
    let (small, baked) = views(&host);
    assert_eq!(baked.len(), 6);
    stage.view = Stage::new(SIZE * 4).view;
    let mut larger = Host::new(gpu(), &stage).unwrap();
    std::mem::swap(&mut larger.renderer, &mut host.renderer);
    std::mem::swap(&mut larger.material, &mut host.material);
    larger.draw(gpu(), &stage).unwrap();
    let (large, still_baked) = views(&larger);
    assert!(small != large && baked == still_baked);
}

#[test]
fn a_depth_buffer_that_the_host_replaces_is_let_go() {
    // A device of its own, whose memory can be counted.
    let gpu = Headless::new().unwrap();
    let allocated = || {
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        gpu.device.generate_allocator_report().map(|report| report.total_allocated_bytes)
    };
    let read_only = haze::read_only_depth_is_supported(&gpu.device);
    for source in [DepthSource::Reduced, DepthSource::Host] {
        if source == DepthSource::Host && !read_only {
            continue;
        }
        let mut stage = Stage::new(SIZE);
        (stage.settings.accumulate.depth_source, stage.settings.accumulate.scale) = (source, 1);
        let mut host = Host::new(&gpu, &stage).unwrap();
        host.draw(&gpu, &stage).unwrap();
        let before = allocated();
        for _ in 0..3 {
            // The renderer goes to a new host, with new textures; the old ones go.
            let mut next = Host::new(&gpu, &stage).unwrap();
            std::mem::swap(&mut next.renderer, &mut host.renderer);
            std::mem::swap(&mut next.material, &mut host.material);
            host = next;
            host.draw(&gpu, &stage).unwrap();
        }
        assert_eq!(allocated(), before, "{}", source.name());
    }
}

#[test]
fn a_view_of_the_whole_target_needs_no_origin() {
    let view = View::new(Mat4::IDENTITY, Mat4::IDENTITY, SIZE);
    assert_eq!(view.origin, UVec2::ZERO);
}
