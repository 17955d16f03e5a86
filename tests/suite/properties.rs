//! What must hold whatever the picture: order, emptiness, odd sizes, depth conventions, memory, steady frames.

use glam::camera::rh::proj::directx;
use glam::{Mat4, UVec2, Vec3, Vec4, vec3, vec4};
use haze::frame::bounds_of;
use haze::picture::Picture;
use haze::read_only_depth_is_supported;
use haze::reference::blend_unit::{premultiplied_over, quantise};
use haze::settings::{
    AccumulationFormat, DepthSource, DiffuseMode, LightingResolution, Order, Path, ShadeTree, Upsample,
};
use haze::{Bounds, Error, Light, Particle, Particles, wgpu};
use proptest::prelude::*;

use crate::common::{AGREEMENT, gpu, non_finite_texels, psnr};
use crate::creations;
use crate::host::Host;
use crate::stage::{BACKDROP, DepthKind, Stage};

const SIZE: UVec2 = UVec2::new(160, 90);

// order

proptest! {
    #[test]
    fn amount_is_one_minus_the_product_of_what_each_layer_lets_through(
        amounts in proptest::collection::vec(0.0_f32..1.0, 1..40),
        seed in 0_usize..1000,
    ) {
        let blend = |amounts: &[f32]| {
            amounts.iter().fold(Vec4::ZERO, |target, &a| premultiplied_over(Vec4::splat(a), target)).w
        };
        let mut shuffled = amounts.clone();
        for i in (1..shuffled.len()).rev() {
            shuffled.swap(i, (seed * 31 + i * 17) % (i + 1));
        }
        let product = 1.0 - amounts.iter().map(|a| 1.0 - a).product::<f32>();
        // 40 roundings of 6e-8.
        prop_assert!((blend(&amounts) - product).abs() < 3e-6);
        prop_assert!((blend(&shuffled) - product).abs() < 3e-6);
        // The mutant: SRC_ALPHA, ONE_MINUS_SRC_ALPHA, OTEE's first blend, loses amount.
        let classic = amounts.iter().fold(0.0, |target, a| a * a + target * (1.0 - a));
        prop_assert!(amounts.iter().all(|a| !(0.01..0.99).contains(a)) || product - classic > 1e-5);
    }
}

#[test]
fn amount_on_the_gpu_does_not_depend_on_order() {
    let mut stage = Stage::new(SIZE);
    stage.shade_tree = ShadeTree::Amount;
    stage.settings.accumulate.scale = 1;
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &stage).unwrap();
    // From a buffer, where the host is responsible for the order.
    let mut draw = |particles: &[Particle]| {
        host.draw_buffer(gpu(), &stage, particles).unwrap();
        host.picture(gpu()).unwrap()
    };
    let forwards = draw(&stage.particles);
    let reversed: Vec<_> = stage.particles.iter().rev().copied().collect();
    let backwards = draw(&reversed);
    let difference = forwards.texels.iter().zip(&backwards.texels).map(|(a, b)| (a.x - b.x).abs());
    // 60 layers, each rounded to f16: 60 halves of 2^-11 at worst, a third of that seen.
    assert!(difference.fold(0.0, f32::max) < 60.0 * 0.5 / 2048.0);
    assert!(forwards.texels.iter().any(|texel| texel.x > 0.9));
}

#[test]
fn weighted_normals_need_no_order() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let reversed: Vec<_> = stage.particles.iter().rev().copied().collect();
    let mut apart = |order| {
        stage.settings.accumulate.order = order;
        let mut host = Host::new(gpu(), &stage).unwrap();
        let mut draw = |particles: &[Particle]| {
            host.draw_buffer(gpu(), &stage, particles).unwrap();
            host.picture(gpu()).unwrap()
        };
        psnr(&draw(&stage.particles), &draw(&reversed))
    };
    let (weighted, sorted) = (apart(Order::Weighted), apart(Order::Sorted));
    println!("turned round: weighted {weighted:.1} dB, sorted {sorted:.1} dB");
    // Sums of f16 round in another order.
    assert!(weighted > AGREEMENT && sorted < AGREEMENT, "{weighted} {sorted}");
}

#[test]
fn more_than_all_counts_as_all() {
    let mut stage = Stage::new(SIZE);
    let mut host = Host::new(gpu(), &stage).unwrap();
    let mut draw = |amount: f32| {
        stage.particles = vec![Particle { position: vec3(0.0, 0.0, -5.0), amount, ..Particle::default() }];
        stage.bounds = Some(bounds_of(&stage.particles, stage.settings.reach()));
        host.draw(gpu(), &stage).unwrap();
        let slice = host.picture(gpu()).unwrap();
        host.draw_buffer(gpu(), &stage, &stage.particles).unwrap();
        [slice, host.picture(gpu()).unwrap(), stage.on_cpu()]
    };
    let whole = draw(1.0);
    assert!(whole[0].texels.iter().any(|texel| *texel != BACKDROP));
    for amount in [1.000_000_1, 3.0, 1.0e6] {
        for (more, whole) in draw(amount).iter().zip(&whole) {
            assert!(more.texels == whole.texels, "{amount}");
        }
    }
}

#[test]
fn eight_bits_lose_thin_smoke_and_sixteen_do_not() {
    // DESIGN's trap, seen on the GPU: 400 layers of amount 0.02 should reach 1 - 0.98^400 = 0.9997.
    let stack = |format, encoding| {
        let mut stage = Stage::new(UVec2::splat(32));
        let sprite = Particle { position: vec3(0.0, 0.0, -4.0), radius: 3.0, amount: 0.02, ..Particle::default() };
        stage.particles = vec![sprite; 400];
        (stage.settings.accumulate.format, stage.settings.accumulate.encoding) = (format, encoding);
        stage.shade_tree = ShadeTree::Amount;
        stage.on_gpu(gpu()).picture.load(glam::IVec2::new(8, 16)).x
    };
    use haze::settings::NormalEncoding;
    assert!(stack(AccumulationFormat::Rgba16Float, NormalEncoding::Signed) > 0.97);
    let eight = stack(AccumulationFormat::Rgba8Unorm, NormalEncoding::Biased);
    assert!((0.8..0.95).contains(&eight), "{eight}");
    // And the reference rounds as the GPU does.
    let layer = |target, _| quantise(AccumulationFormat::Rgba8Unorm, premultiplied_over(Vec4::splat(0.02), target));
    assert!((0.8..0.95).contains(&(0..400).fold(Vec4::ZERO, layer).w));
}

// emptiness

#[test]
fn no_smoke_leaves_the_scene_untouched() {
    let untouched = |stage: &Stage| {
        let drawn = stage.on_gpu(gpu());
        drawn.picture.texels.iter().all(|&texel| texel == BACKDROP)
            && stage.on_cpu().texels.iter().all(|&t| t == BACKDROP)
    };
    let mut stage = Stage::new(SIZE);
    assert!(!untouched(&stage));
    let particles = std::mem::take(&mut stage.particles);
    assert!(untouched(&stage));
    // Sprites that cannot be drawn count as none.
    stage.particles = vec![
        Particle { position: Vec3::NAN, ..Particle::default() },
        Particle { radius: 0.0, position: vec3(0.0, 0.0, -6.0), ..Particle::default() },
        Particle { amount: 0.0, position: vec3(0.0, 0.0, -6.0), ..Particle::default() },
        Particle { radius: f32::INFINITY, ..Particle::default() },
        // Behind the camera.
        Particle { position: vec3(0.0, 0.0, 6.0), ..Particle::default() },
    ];
    assert!(untouched(&stage));
    // A real one behind the camera and out of sight.
    stage.particles =
        particles.iter().map(|p| Particle { position: p.position + vec3(0.0, 0.0, 20.0), ..*p }).collect();
    assert!(untouched(&stage));
    for path in [Path::Raster, Path::Forward] {
        stage.settings.path = path;
        stage.settings.accumulate.opacity = 0.0;
        stage.particles.clone_from(&particles);
        assert!(untouched(&stage));
    }
}

// sizes

#[test]
fn odd_sizes_and_every_scale_work() {
    for size in [UVec2::ONE, UVec2::new(1, 97), UVec2::new(641, 359), UVec2::new(3, 2)] {
        for scale in 1..=16 {
            let mut stage = Stage::new(size);
            stage.settings.accumulate.scale = scale;
            let drawn = stage.on_gpu(gpu());
            gpu().check().unwrap();
            assert!(drawn.picture.texels.iter().all(|texel| texel.is_finite()), "{size} scale {scale}");
            // Hardware places corners on a grid of 1/256 pixel. Where a whole sprite is less than a pixel, that moves it
            // by a part of its own size, and the pictures of the two renderers are no longer of the same sprite.
            if size.min_element() > 64 {
                let psnr = psnr(&drawn.picture, &stage.on_cpu());
                assert!(psnr >= AGREEMENT, "{size} scale {scale}: {psnr:.1} dB");
            }
        }
    }
}

#[test]
fn a_host_may_resize_and_change_everything_from_frame_to_frame() {
    let mut stage = Stage::new(SIZE);
    let mut host = Host::new(gpu(), &stage).unwrap();
    for step in 0..24_u32 {
        let size = UVec2::new(64 + 37 * (step % 5), 48 + 29 * (step % 7));
        let next = Stage::new(size);
        (stage.view, stage.particles) = (next.view, next.particles);
        let accumulate = &mut stage.settings.accumulate;
        accumulate.scale = 1 + step % 6;
        accumulate.upsample = Upsample::ALL[step as usize % Upsample::ALL.len()];
        let tested = accumulate.scale == 1 && read_only_depth_is_supported(&gpu().device);
        accumulate.depth_source = if tested { DepthSource::Host } else { DepthSource::Reduced };
        stage.settings.diffuse.mode = DiffuseMode::ALL[step as usize % DiffuseMode::ALL.len()];
        stage.settings.path = if step % 11 == 10 { Path::Forward } else { Path::Auto };
        // The renderer stays, the host's textures are new.
        let mut resized = Host::on(gpu(), &stage, Some(host.renderer.context())).unwrap();
        std::mem::swap(&mut resized.renderer, &mut host.renderer);
        std::mem::swap(&mut resized, &mut host);
        host.draw(gpu(), &stage).unwrap();
        gpu().check().unwrap();
        let psnr = psnr(&host.picture(gpu()).unwrap(), &stage.on_cpu());
        // The edge of a sprite takes or leaves a whole texel, which may be 36 of few pixels: 53 dB.
        assert!(psnr >= 50.0, "step {step}: {psnr:.1} dB");
    }
}

#[test]
fn the_clamp_limits_the_target() {
    let mut stage = Stage::new(UVec2::new(641, 359));
    stage.settings.accumulate.scale = 1;
    stage.settings.accumulate.max_side = 100;
    let drawn = stage.on_gpu(gpu());
    let targets = drawn.renderer.targets(0).unwrap();
    assert_eq!(targets.scale, 7);
    assert!(targets.size.max_element() <= 100);
    assert!(psnr(&drawn.picture, &stage.on_cpu()) >= AGREEMENT);
}

#[test]
fn the_plane_that_is_lit_is_told_as_the_host_measures_depth() {
    let aspect = SIZE.x as f32 / SIZE.y as f32;
    // This one's near plane is behind the viewer: inside, it steps back.
    let orthographic = directx::orthographic(-4.0, 4.0, -2.25, 2.25, -5.0, 80.0);
    for projection in [directx::perspective(0.8, aspect, 0.1, 80.0), orthographic] {
        let mut stage = Stage::new(SIZE);
        stage.view.clip_from_view = projection;
        stage.particles = vec![Particle { position: vec3(0.0, 0.0, -6.0), ..Particle::default() }];
        let lit = stage.on_gpu(gpu()).renderer.targets(0).unwrap().lit_depth;
        assert!((lit - 6.0).abs() < 1e-3, "{lit}");
    }
}

// depth conventions

fn reversed(projection: Mat4) -> Mat4 {
    let flip = Mat4::from_cols(Vec4::X, Vec4::Y, vec4(0.0, 0.0, -1.0, 0.0), vec4(0.0, 0.0, 1.0, 1.0));
    flip * projection
}

#[test]
fn every_depth_convention_gives_the_same_picture() {
    let (fov, aspect) = (0.8, SIZE.x as f32 / SIZE.y as f32);
    let perspective = directx::perspective(fov, aspect, 0.1, 80.0);
    let orthographic = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
    let families = [
        vec![
            perspective,
            reversed(perspective),
            directx::perspective_infinite(fov, aspect, 0.1),
            directx::perspective_infinite_reverse(fov, aspect, 0.1),
        ],
        vec![orthographic, reversed(orthographic)],
    ];
    for family in families {
        let mut standard = None;
        for clip_from_view in family {
            for depth in [DepthKind::Buffer, DepthKind::Linear] {
                let mut stage = Stage::new(SIZE);
                stage.view.clip_from_view = clip_from_view;
                stage.depth = depth;
                let picture = stage.on_gpu(gpu()).picture;
                let reference = psnr(&picture, &stage.on_cpu());
                assert!(reference >= AGREEMENT, "{clip_from_view}: {reference:.1} dB from the reference");
                let standard = standard.get_or_insert_with(|| picture.clone());
                // Depth buffers of different conventions round differently: 90 dB were found.
                let psnr = psnr(&picture, standard);
                assert!(psnr >= 85.0, "{clip_from_view}, {depth:?}: {psnr:.1} dB from standard");
            }
        }
    }
}

#[test]
fn a_pass_without_depth_gives_the_same_picture() {
    let mut stage = Stage::new(SIZE);
    let tested = stage.on_gpu(gpu()).picture;
    stage.attach_depth = false;
    for path in [Path::Raster, Path::Forward] {
        stage.settings.path = path;
        let picture = stage.on_gpu(gpu()).picture;
        let reference = psnr(&picture, &stage.on_cpu());
        assert!(reference >= AGREEMENT, "{path:?}: {reference:.1} dB");
        // The box is not tested then, and the fade alone hides what is behind the scene.
        assert!(path == Path::Forward || psnr(&picture, &tested) >= 85.0);
    }
}

#[test]
fn the_limits_of_webgl2_are_enough() {
    let webgl2 =
        haze::headless::Headless::with(wgpu::Limits::downlevel_webgl2_defaults(), wgpu::Features::empty()).unwrap();
    let mut stage = Stage::new(SIZE);
    for mode in DiffuseMode::ALL {
        stage.settings.diffuse.mode = *mode;
        let psnr = psnr(&stage.on_gpu(&webgl2).picture, &stage.on_cpu());
        assert!(psnr >= AGREEMENT, "{mode:?}: {psnr:.1} dB");
    }
    stage.settings.path = Path::Forward;
    assert!(psnr(&stage.on_gpu(&webgl2).picture, &stage.on_cpu()) >= AGREEMENT);
    webgl2.check().unwrap();
}

// the camera and the box

#[test]
fn the_near_plane_cuts_no_hole() {
    // From in front of the box, through its front face, to the middle of it.
    for step in 0..=20 {
        let mut stage = Stage::new(SIZE);
        let forward = 3.0 + 0.2 * step as f32;
        stage.view.view_from_world = Mat4::from_translation(vec3(0.0, 0.0, forward));
        stage.bounds = Some(Bounds { min: vec3(-5.0, -4.0, -8.0), max: vec3(5.0, 4.0, -4.0) });
        stage.shade_tree = ShadeTree::ReducedDepth;
        stage.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 80.0);
        let picture = stage.on_gpu(gpu()).picture;
        // From here on the box fills the view, and this stage paints every pixel of it.
        if forward >= 3.5 {
            assert!(picture.texels.iter().all(|&texel| texel != BACKDROP), "{forward}: a hole");
        }
        stage.shade_tree = ShadeTree::Final;
        // Until the camera has passed the smoke.
        if forward < 6.3 {
            let psnr = psnr(&stage.on_gpu(gpu()).picture, &stage.on_cpu());
            assert!(psnr >= AGREEMENT, "{forward}: {psnr:.1} dB");
        }
    }
}

#[test]
fn a_box_beyond_the_far_plane_shows_no_hole() {
    let mut stage = Stage::new(SIZE);
    stage.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.5, 20.0);
    stage.bounds = Some(Bounds { min: Vec3::splat(-50.0), max: Vec3::splat(50.0) });
    assert!(psnr(&stage.on_gpu(gpu()).picture, &stage.on_cpu()) >= AGREEMENT);
}

// mutants of the whole frame: what a mistake in a pass would do, done to the reference

#[test]
fn mistakes_in_a_pass_are_seen() {
    type Mistake = fn(&mut Stage);
    let stage = || {
        let mut stage = Stage::new(SIZE);
        stage.settings.specular_scatter.size = 60.0;
        stage
    };
    let picture = stage().on_gpu(gpu()).picture;
    let agreement = |change: Mistake| {
        let mut mutant = stage();
        change(&mut mutant);
        psnr(&picture, &mutant.on_cpu())
    };
    assert!(agreement(|_| {}) >= 60.0);
    let mutants: &[(&str, Mistake)] = &[
        ("flipped normal y", |s| s.material.sprite = crate::stage::ball_sprite(true)),
        ("swapped ramp axes", |s| {
            let ramp = s.material.specular_ramp.clone();
            let texels = (0..128).map(|i| ramp.texel(UVec2::new(i / 8, i % 8)));
            s.material.specular_ramp = haze::ramp::Ramp::from_linear(UVec2::new(8, 16), texels);
        }),
        ("reversed diffuse ramp", |s| {
            let ramp = s.material.diffuse_ramp.clone();
            let texels = (0..16).map(|i| ramp.texel(UVec2::new(15 - i, 0)));
            s.material.diffuse_ramp = haze::ramp::Ramp::from_linear(UVec2::new(16, 1), texels);
        }),
        ("sprites turned the other way", |s| s.particles.iter_mut().for_each(|p| p.rotation = -p.rotation)),
        ("no soft fade", |s| s.settings.soft_fade.fade_scale = 1000.0),
        ("no boost", |s| s.settings.boost = 1.0),
        ("literal decode", |s| s.settings.accumulate.decode = haze::settings::NormalDecode::Literal),
        ("a light forgotten", |s| s.lights.truncate(1)),
        ("half a texel off", |s| s.view.view_from_world = Mat4::from_translation(vec3(0.03, 0.0, 0.0))),
    ];
    for (name, change) in mutants {
        let psnr = agreement(*change);
        println!("{name}: {psnr:.1} dB");
        assert!(psnr < AGREEMENT - 10.0, "{name} passes: {psnr:.1} dB");
    }
}

#[test]
fn a_twentieth_in_a_few_pixels_is_seen() {
    let mut smoke = Picture::new(SIZE, BACKDROP);
    smoke.texels[..SIZE.element_product() as usize / 100].fill(Vec4::splat(0.7));
    for channel in Vec4::AXES {
        let mut off = smoke.clone();
        let few = off.texels.iter_mut().filter(|texel| **texel != BACKDROP);
        few.for_each(|texel| *texel -= channel * 0.05);
        let psnr = psnr(&off, &smoke);
        assert!(psnr < AGREEMENT, "{channel}: {psnr:.1} dB");
    }
}

#[test]
fn order_matters_to_normals() {
    // Sorting is the GPU renderer's own; a frame drawn front to back must not pass for one drawn back to front.
    let mut stage = Stage::new(SIZE);
    stage.shade_tree = ShadeTree::Normals;
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    stage.particles.iter_mut().for_each(|particle| particle.amount = 0.9);
    let sorted = stage.on_cpu();
    let mut front_to_back = stage.particles.clone();
    front_to_back.sort_by(|a, b| b.position.z.total_cmp(&a.position.z));
    let mut host = Host::new(gpu(), &stage).unwrap();
    host.draw_buffer(gpu(), &stage, &front_to_back).unwrap();
    assert!(psnr(&host.picture(gpu()).unwrap(), &sorted) < AGREEMENT - 10.0);
}

// several systems, many lights

#[test]
fn many_lights_agree_and_too_many_are_refused() {
    let mut stage = Stage::new(SIZE);
    let light = |i: usize| Light {
        position: vec3((i % 16) as f32 - 8.0, (i / 16) as f32 - 4.0, -4.0),
        colour: vec3((i % 3) as f32, (i % 5) as f32, (i % 7) as f32) * 0.1,
        range: 4.0,
        specular_scatter: 0.0,
        ..Light::default()
    };
    stage.lights = (0..haze::frame::MAX_LIGHTS).map(light).collect();
    assert!(psnr(&stage.on_gpu(gpu()).picture, &stage.on_cpu()) >= AGREEMENT);
    stage.lights.push(light(0));
    let Err(error) = stage.try_on_gpu(gpu()) else { panic!("129 lights passed") };
    assert_eq!(error.to_string(), "lights: 129 lights is not valid; expected at most 128");
}

// what callers get wrong

#[test]
fn bad_frames_are_refused_by_name_and_draw_nothing() {
    // After a good frame, so that there is something that could be drawn.
    let refusal = |host: &mut Host, stage: &Stage, particles: Particles<'_>| {
        host.draw(gpu(), &Stage::new(SIZE)).unwrap();
        assert!(host.picture(gpu()).unwrap().texels.iter().any(|&texel| texel != BACKDROP));
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let error = host.prepare(gpu(), &mut encoder, stage, particles).unwrap_err();
        host.render(&mut encoder, stage);
        gpu().submit(encoder).unwrap();
        assert!(
            host.picture(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP),
            "{error}: something is drawn"
        );
        error
    };
    let mut host = Host::new(gpu(), &Stage::new(SIZE)).unwrap();
    let mut field = |change: fn(&mut Stage)| {
        let mut stage = Stage::new(SIZE);
        change(&mut stage);
        match refusal(&mut host, &stage, Particles::Slice(&stage.particles)) {
            Error::Field(error) => error.field,
            other => panic!("{other}"),
        }
    };
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = f32::NAN), "systems[0].settings.soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.accumulate.scale = 17), "systems[0].settings.accumulate.scale");
    assert_eq!(field(|s| s.lights[1].range = -1.0), "lights[1].range");
    assert_eq!(field(|s| s.bounds = Some(Bounds { min: Vec3::ZERO, max: Vec3::INFINITY })), "systems[0].bounds");
    assert_eq!(field(|s| s.view.view_from_world = Mat4::ZERO), "view.view_from_world");

    let mut stage = Stage::new(SIZE);
    stage.view.size += 1;
    let error = refusal(&mut host, &stage, Particles::Slice(&stage.particles)).to_string();
    assert_eq!(
        error,
        "view.size: 161x91 from (0, 0) is not valid; expected the size of the scene depth, 160x90, or a part of it"
    );
    // Particles on the GPU need a box.
    stage.view.size = SIZE;
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let mut refused = |count, bounds| {
        stage.bounds = bounds;
        let particles = Particles::Buffer { buffer: &buffer, offset: 0, count };
        refusal(&mut host, &stage, particles).to_string()
    };
    assert!(refused(2, None).starts_with("systems[0].bounds: None"));
    let somewhere = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    assert!(refused(3, somewhere).starts_with("systems[0].particles: 64 bytes"));
}

// memory and steady frames

#[test]
fn a_system_at_1080p_half_scale_takes_at_most_8_mb() {
    let mut stage = Stage::new(UVec2::new(1920, 1080));
    // The whole screen: the worst case.
    stage.bounds = Some(Bounds { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) });
    let drawn = stage.on_gpu(gpu());
    let whole = drawn.renderer.memory_use().targets;
    println!("{:.2} MB", whole as f64 / 1e6);
    assert!(whole <= 8_000_000, "{whole} bytes");
    assert_eq!(drawn.renderer.targets(0).unwrap().size, UVec2::new(960, 540));
    // Light takes four half floats a texel, where that is its resolution.
    stage.settings.accumulate.lighting_resolution = LightingResolution::Target;
    assert_eq!(stage.on_gpu(gpu()).renderer.memory_use().targets, whole + 960 * 540 * 8);
    stage.settings.accumulate.lighting_resolution = LightingResolution::Full;
    // And no more than the box's rectangle needs.
    stage.bounds = Some(Bounds { min: vec3(-0.5, -0.5, -6.5), max: vec3(0.5, 0.5, -5.5) });
    let drawn = stage.on_gpu(gpu());
    let size = drawn.renderer.targets(0).unwrap().size;
    assert!(size.x < 200 && size.y < 200, "{size}");
    assert!(drawn.renderer.memory_use().targets < whole / 8);
}

#[test]
fn steady_frames_create_nothing() {
    let mut stage = Stage::new(SIZE);
    let mut host = Host::new(gpu(), &stage).unwrap();
    for (mode, lighting_resolution) in [
        (DiffuseMode::Ramp, LightingResolution::Full),
        (DiffuseMode::Cubemap, LightingResolution::Full),
        (DiffuseMode::Cubemap, LightingResolution::Target),
    ] {
        stage.settings.diffuse.mode = mode;
        stage.settings.accumulate.lighting_resolution = lighting_resolution;
        // The first frame does, and the count sees it.
        assert!(creations::count(|| host.draw(gpu(), &stage).unwrap()) > 0);
        let renderer_of = |host: &Host| {
            let targets = host.renderer.targets(0).unwrap();
            (targets.accumulation.to_vec(), targets.reduced_depth.cloned(), host.renderer.memory_use())
        };
        let before = renderer_of(&host);
        for frame in 0..10 {
            // The smoke moves and the lights flicker.
            for particle in &mut stage.particles {
                particle.rotation += 0.01;
            }
            stage.lights[0].intensity = 20.0 + frame as f32;
            let created = creations::count(|| host.draw(gpu(), &stage).unwrap());
            assert_eq!(created, 0, "{mode:?}, frame {frame}: something is created every frame");
        }
        assert_eq!(before, renderer_of(&host));
    }
    // The mutant: what is dropped at once counts too.
    let view = host.depth.texture();
    assert_eq!(creations::count(|| drop(view.create_view(&wgpu::TextureViewDescriptor::default()))), 1);
}

#[test]
fn the_library_never_submits() {
    // headless.rs and the demo are hosts; the rest is the library.
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let host = ["headless.rs", "demo", "app", "main.rs"].iter().any(|name| path.ends_with(name));
            if path.is_dir() && !host {
                folders.push(path);
            } else if !path.is_dir() && !host {
                let text = std::fs::read_to_string(&path).unwrap();
                assert!(!text.contains(".submit(") && !text.contains("PollType"), "{}", path.display());
            }
        }
    }
}

// nothing non-finite

#[test]
fn no_preset_leaves_a_nan_in_any_target() {
    for preset in haze::builtin::PRESETS {
        let preset = haze::preset::Preset::load(preset.name).unwrap();
        for system in &preset.systems {
            let size = UVec2::new(320, 180);
            let mut stage = Stage::new(size);
            stage.view = preset.camera.view(size);
            stage.lights.clone_from(&preset.lights);
            stage.settings = system.settings_for(size.y);
            stage.settings.path = Path::Raster;
            stage.material = system.material.load(std::path::Path::new("")).unwrap();
            system.emitter.evaluate(preset.time, &mut stage.particles);
            assert_all_finite(&stage, &stage.on_gpu(gpu()), &preset.name);
        }
    }
}

fn assert_all_finite(stage: &Stage, drawn: &crate::host::Drawn, name: &str) {
    assert!(drawn.picture.texels.iter().all(|texel| texel.is_finite()), "{name}");
    let targets = drawn.renderer.targets(0).unwrap();
    assert!(targets.size.cmple(stage.view.size).all());
    for view in targets.accumulation.iter().chain(targets.reduced_depth) {
        assert_eq!(non_finite_texels(gpu(), view, targets.size), 0, "{name}");
    }
}

#[test]
fn garbage_in_a_hosts_buffer_is_not_drawn() {
    let mut stage = Stage::new(SIZE);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &stage).unwrap();
    let good = Particle { position: vec3(0.0, 0.0, -6.0), amount: 0.5, ..Particle::default() };
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30];
    let mut particles = Vec::new();
    for x in bad {
        particles.extend([
            Particle { position: good.position.with_x(x), ..good },
            Particle { position: good.position.with_z(x), ..good },
            Particle { radius: x, ..good },
            Particle { rotation: x, ..good },
            Particle { frame: x, ..good },
        ]);
    }
    particles.push(Particle { amount: f32::NAN, ..good });
    host.draw_buffer(gpu(), &stage, &particles).unwrap();
    assert!(host.picture(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP));
    let targets = host.renderer.targets(0).unwrap();
    assert_eq!(non_finite_texels(gpu(), &targets.accumulation[0], targets.size), 0);
}

#[test]
fn degenerate_sprites_leave_no_nan_in_any_target() {
    let mut stage = Stage::new(SIZE);
    let somewhere = vec3(0.0, 0.0, -6.0);
    stage.particles.extend([
        Particle { position: Vec3::ZERO, radius: 1.0, ..Particle::default() },
        Particle { position: vec3(0.0, 0.0, -0.1), radius: 1e-20, ..Particle::default() },
        Particle { position: somewhere, radius: 1e9, ..Particle::default() },
        Particle { position: somewhere, rotation: 1e30, frame: -1e30, ..Particle::default() },
        Particle { position: somewhere, frame: f32::MAX, ..Particle::default() },
    ]);
    stage.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    for contrast_power in [0.1, 16.0] {
        stage.settings.soft_fade.curve = haze::settings::FadeCurve::Contrast;
        stage.settings.soft_fade.contrast_power = contrast_power;
        stage.settings.soft_fade.fade_scale = 1000.0;
        assert_all_finite(&stage, &stage.on_gpu(gpu()), "degenerate sprites");
    }
}
