//! Intersection of sprites with the scene under every technique: agreement of the renderers, and the documented
//! behaviour of each.

use std::sync::LazyLock;

use glam::camera::rh::proj::directx;
use glam::{Mat4, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles, vec3};
use haze::formula::sprite::{flipbook_frames, sample_detail, sample_sprite};
use haze::settings::*;
use haze::sprite::{Sprite, SpriteLayout};
use haze::{Bounds, Error, Particle};
use haze_author::sprite::bake::SpriteRecipe;

use crate::common::{MIN_PSNR, MIN_PSNR_WITH_STEPS, gpu, non_finite_texels, psnr};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, DepthKind, TestScene, six_way_of};

const SIZE: UVec2 = UVec2::new(160, 90);

/// The test cloud with every input that a technique may read.
pub fn scene(technique: Technique) -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.depth = DepthKind::Both;
    // Because a linear target is passed too, the depth buffer can be attached on every backend.
    scene.attach_depth = true;
    scene.settings.technique = technique;
    scene.settings.volumetric.noise_size = 1.5;
    for (index, particle) in (0..).zip(&mut scene.particles) {
        particle.age = index as f32 / 59.0;
    }
    scene
}

/// A single sprite straight ahead at `view_depth` metres.
fn one_sprite(technique: Technique, view_depth: f32) -> TestScene {
    let mut scene = scene(technique);
    scene.particles =
        vec![Particle { position: vec3(0.0, 0.0, -view_depth), amount: 0.8, radius: 0.7, ..Particle::default() }];
    scene.bounds = Some(Bounds { min: vec3(-3.0, -3.0, -12.0), max: vec3(3.0, 3.0, 3.0) });
    scene.settings.soft_fade.near_fade_end = 0.0;
    scene.settings.accumulate.scale = 1;
    scene.debug_view = DebugView::Amount;
    scene
}

fn assert_agreement(name: &str, scene: &TestScene) {
    let psnr = psnr(&scene.on_gpu(gpu()).picture, &scene.on_cpu());
    println!("{name}: {psnr:.1} dB");
    let least = if scene.settings.sprite.debug_sprite { MIN_PSNR_WITH_STEPS } else { MIN_PSNR };
    assert!(psnr >= least, "{name}: {psnr:.1} dB");
}

#[test]
fn gpu_and_cpu_agree_on_every_technique_and_path() {
    for &technique in Technique::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            let mut scene = scene(technique);
            scene.settings.path = path;
            assert_agreement(&format!("{} {}", technique.name(), path.name()), &scene);
            if path == RenderPath::Raster {
                let mut weighted = scene.clone();
                weighted.settings.accumulate.order = Order::Weighted;
                assert_agreement(&format!("{} weighted", technique.name()), &weighted);
            }
            scene.settings.soft_fade.curve = FadeCurve::Always;
            assert_agreement(&format!("{} {} always", technique.name(), path.name()), &scene);
        }
        let mut scene = scene(technique);
        (scene.settings.accumulate.depth_source, scene.settings.accumulate.scale) = (DepthSource::Host, 1);
        assert_agreement(&format!("{} host depth", technique.name()), &scene);
        let mut scene = self::scene(technique);
        scene.view.clip_from_view = directx::orthographic(-4.0, 4.0, -2.25, 2.25, 0.1, 80.0);
        assert_agreement(&format!("{} orthographic", technique.name()), &scene);
        // Off-centre projection, and a rotated and translated camera: noise and sphere bounds depend on them.
        let mut scene = self::scene(technique);
        scene.view.clip_from_view = directx::frustum(-0.06, 0.03, -0.02, 0.03, 0.1, 80.0);
        let turn = Mat4::from_rotation_y(0.4) * Mat4::from_translation(vec3(1.0, -2.0, 3.0));
        scene.view.view_from_world *= turn;
        scene.particles.iter_mut().for_each(|p| p.position = turn.inverse().transform_point3(p.position));
        scene.lights.iter_mut().for_each(|l| l.position = turn.inverse().transform_point3(l.position));
        assert_agreement(&format!("{} off centre", technique.name()), &scene);
    }
}

#[test]
fn border_texels_are_covered_at_every_size() {
    // If the image size is no multiple of the scale, the last texel extends beyond the image.
    for technique in [Technique::Soft, Technique::SphericalBillboard, Technique::VolumetricSoft] {
        for (size, scale) in [(UVec2::new(161, 91), 2), (UVec2::new(161, 91), 4), (UVec2::new(169, 97), 8)] {
            let mut scene = scene(technique);
            let sized = TestScene::new(size);
            (scene.view, scene.settings.accumulate.scale) = (sized.view, scale);
            // Moves sprites across the right and lower borders.
            scene.particles.iter_mut().for_each(|p| p.position += vec3(3.0, -1.5, 0.0));
            assert_agreement(&format!("{} {size} scale {scale}", technique.name()), &scene);
        }
    }
}

#[test]
fn switching_the_depth_input_keeps_the_targets() {
    let mut scene = scene(Technique::Soft);
    let mut host = Host::new(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let before = host.renderer.targets(0).unwrap().accumulation.to_vec();
    scene.settings.technique = Technique::SoftLinear;
    host.draw(gpu(), &scene).unwrap();
    assert_eq!(before, host.renderer.targets(0).unwrap().accumulation);
}

#[test]
fn gpu_and_cpu_agree_on_every_sprite_setting() {
    type Change = fn(&mut TestScene);
    let changes: &[(&str, Change)] = &[
        ("size", |s| s.settings.sprite.size = 1.7),
        ("volume", |s| s.settings.sprite.animation = SpriteAnimation::Volume),
        ("still", |s| s.settings.sprite.animation = SpriteAnimation::Still),
        ("nearest", |s| s.settings.sprite.animation = SpriteAnimation::Nearest),
        ("motion", |s| s.settings.sprite.motion = 1.0),
        ("debug sprite", |s| s.settings.sprite.debug_sprite = true),
        ("debug loop", |s| s.settings.sprite.debug_loop = 3),
        ("age colour", |s| (s.settings.path, s.settings.sprite.age_colour) = (RenderPath::Forward, 0.8)),
    ];
    for (name, change) in changes {
        for technique in [Technique::Soft, Technique::SphericalBillboard] {
            let mut scene = scene(technique);
            (scene.material.sprite, scene.material.detail, scene.material.six_way) = flipbook();
            for (index, particle) in (0..).zip(&mut scene.particles) {
                particle.frame = index as f32 * 0.37;
            }
            let plain = scene.on_cpu();
            change(&mut scene);
            assert_agreement(&format!("{} {name}", technique.name()), &scene);
            // The setting must have an effect on the image.
            assert_ne!(plain, scene.on_cpu(), "{name} has no effect");
        }
    }
}

#[test]
fn only_flipbooks_compile_a_pipeline_per_animation() {
    // Every animation of a flipbook has its own pipeline. A single frame has nothing to blend, so all animations share
    // one.
    for path in [RenderPath::Raster, RenderPath::Forward] {
        for (has_frames, expected) in [(false, 0), (true, SpriteAnimation::ALL.len() - 1)] {
            let mut scene = scene(Technique::Soft);
            scene.settings.path = path;
            if has_frames {
                (scene.material.sprite, _, scene.material.six_way) = flipbook();
                scene.material.detail = None;
            }
            let mut host = Host::new(gpu(), &scene).unwrap();
            let mut counts = SpriteAnimation::ALL.iter().map(|&animation| {
                scene.settings.sprite.animation = animation;
                host.draw(gpu(), &scene).unwrap();
                host.renderer.context().pipeline_count()
            });
            let first = counts.next().unwrap();
            assert_eq!(counts.last().unwrap() - first, expected, "{}, flipbook {has_frames}", path.name());
        }
    }
}

/// A small flipbook, its detail map and six-way maps. Baked once.
pub fn flipbook() -> (Sprite, Option<Sprite>, Option<Sprite>) {
    static FLIPBOOK: LazyLock<[Sprite; 3]> = LazyLock::new(|| {
        let recipe = recipe();
        let baked = recipe.bake(|_| Ok::<_, haze::FieldError>(())).unwrap();
        let decode = |picture| Sprite::from_image("flipbook".as_ref(), picture, recipe.layout()).unwrap();
        let sprite = decode(&baked.picture);
        let six_way = six_way_of(&sprite);
        [sprite, decode(&baked.detail), six_way]
    });
    let [sprite, detail, six_way] = FLIPBOOK.clone();
    (sprite, Some(detail), Some(six_way))
}

/// A puff whose balls travel. Smoke that only boils in place has no motion to estimate.
fn recipe() -> SpriteRecipe {
    let text = include_str!("../../sprites/puff.sprite.json");
    let puff: SpriteRecipe = serde_json::from_str(text).unwrap();
    SpriteRecipe { size: 64, drift: 0.2, ball_radius_max: 0.4, erosion: 0.5, ..puff }
}

/// Squared errors of normals and amount halfway between frames, against a frame baked for that time. In order: blended,
/// with motion, and with reversed motion.
fn errors_between_frames(recipe: &SpriteRecipe) -> [f32; 3] {
    let baked = recipe.bake(|_| Ok::<_, haze::FieldError>(())).unwrap();
    let decode = |picture: &_, layout| Sprite::from_image("flipbook".as_ref(), picture, layout).unwrap();
    let (sprite, detail) = (decode(&baked.picture, recipe.layout()), decode(&baked.detail, recipe.layout()));
    let size = recipe.size;
    // Premultiplied normal and amount, as they are accumulated.
    let counted = |texel: Vec4| (texel.xyz() * texel.w).extend(texel.w);
    let mut errors = [0.0; 3];
    for frame in [0.5, 3.5, 6.5] {
        let truth = recipe.bake_frame(frame).picture;
        let picture = image::RgbaImage::from_fn(size, size, |x, y| truth.texels[(y * size + x) as usize]);
        let truth = decode(&picture, SpriteLayout::default());
        let frames = flipbook_frames(frame, sprite.frame_count() as f32);
        for index in 0..size * size {
            let at = UVec2::new(index % size, index / size);
            let uv = (at.as_vec2() + 0.5) / size as f32;
            let motion = sample_detail(&detail, uv, frames, 0.0).yz();
            let wanted = truth.texel(0, 0, at.x, at.y);
            let wanted = counted((wanted.xyz() * 2.0 - 1.0).extend(wanted.w));
            for (error, motion) in errors.iter_mut().zip([Vec2::ZERO, motion, -motion]) {
                *error += (counted(sample_sprite(&sprite, uv, frames, motion, 0.0)) - wanted).length_squared();
            }
        }
    }
    errors
}

#[test]
fn motion_reduces_the_error_between_flipbook_frames() {
    let print_errors = |name: &str, recipe: &SpriteRecipe| {
        let errors = errors_between_frames(recipe);
        println!(
            "{name}: squared error blended {:.1}, with motion {:.1}, reversed {:.1}",
            errors[0], errors[1], errors[2]
        );
        errors
    };
    // Measured: a quarter less than blending. Motion with the wrong sign is the mutant.
    let [blended, moved, reversed] = print_errors("travelling balls", &recipe());
    assert!(moved < 0.8 * blended && blended < reversed, "blended {blended}, with motion {moved}, reversed {reversed}");
    // All of the puff travels and nothing boils: less than half the error.
    let carried = SpriteRecipe { version: 2, size: 128, columns: 4, rows: 4, drift: 0.0, travel: 0.2, ..recipe() };
    let [blended, moved, reversed] = print_errors("travelling puff", &carried);
    assert!(moved < 0.5 * blended && blended < reversed, "blended {blended}, with motion {moved}, reversed {reversed}");
}

#[test]
fn freezing_the_animation_stops_the_noise() {
    let at = |time: f32, freeze_animation: bool| {
        let mut scene = scene(Technique::VolumetricSoft);
        (scene.time, scene.settings.sprite.freeze_animation) = (time, freeze_animation);
        scene.on_gpu(gpu()).picture
    };
    assert_eq!(at(0.0, true), at(7.3, true));
    assert!(psnr(&at(0.0, false), &at(7.3, false)) < MIN_PSNR);
    // After a scroll by one whole tile the image is the same.
    let mut scene = scene(Technique::VolumetricSoft);
    scene.settings.volumetric.scroll_speed = 0.25;
    let seconds_per_tile = scene.settings.volumetric.noise_size / 0.25;
    let first = scene.on_gpu(gpu()).picture;
    scene.time += seconds_per_tile;
    assert!(psnr(&first, &scene.on_gpu(gpu()).picture) > 60.0);
}

// Documented behaviour of each technique.

/// A single sprite at `view_depth` metres, with a wall at 6.2 m as the scene.
fn wall(technique: Technique, view_depth: f32) -> TestScene {
    let mut scene = one_sprite(technique, view_depth);
    scene.wall_everywhere = true;
    scene
}

/// Amount in the middle of the image, 0..1.
fn amount(scene: &TestScene) -> f32 {
    let mut host = Host::with_shared_context(gpu(), scene).unwrap();
    host.draw(gpu(), scene).unwrap();
    amount_in(&host)
}

fn amount_in(host: &Host) -> f32 {
    let picture = host.picture(gpu()).unwrap();
    let middle = picture.load((SIZE / 2).as_ivec2());
    // The debug view of the amount is grey, and is drawn over the backdrop wherever the amount is above 0.
    if middle == BACKDROP { 0.0 } else { middle.x }
}

#[test]
fn only_the_curve_always_shows_smoke_behind_a_surface() {
    for &technique in Technique::ALL {
        for &curve in FadeCurve::ALL {
            let mut previous = f32::INFINITY;
            let mut host = Host::with_shared_context(gpu(), &wall(technique, 5.0)).unwrap();
            for step in 0..40 {
                // The wall is at 6.2 m.
                let depth = 4.9 + 0.06 * step as f32;
                let mut scene = wall(technique, depth);
                (scene.settings.soft_fade.curve, scene.settings.soft_fade.fade_scale) = (curve, 2.5);
                host.draw(gpu(), &scene).unwrap();
                let amount = amount_in(&host);
                let name = format!("{} {} at {depth:.2} m: {amount}", technique.name(), curve.name());
                let shows_through = curve == FadeCurve::Always && technique.is_soft();
                // Distance by which the sprite extends in front of its centre, metres.
                let reach = if technique.is_sphere() || technique.is_depth_sprite() || technique == Technique::Density {
                    0.7
                } else {
                    0.0
                };
                let through = if shows_through { 1.0 / 2.5 } else { 0.0 };
                if depth > 6.2 + reach + through + 0.01 {
                    assert!(amount <= 0.0, "{name}, expected none");
                }
                if shows_through && depth < 6.2 + through - 0.03 {
                    assert!(amount > 0.0, "{name}, expected some");
                }
                // Volumetric techniques contain noise, so their amount need not fall monotonically.
                if !technique.is_volumetric() {
                    assert!(amount <= previous + 2e-3, "{name} after {previous}");
                }
                previous = amount;
            }
        }
    }
}

/// Largest change of any pixel from frame to frame while a camera moves through a sprite in steps of 19 mm.
fn largest_step(technique: Technique) -> f32 {
    let mut previous = None;
    let mut largest = 0.0_f32;
    let mut host = Host::with_shared_context(gpu(), &one_sprite(technique, 0.9)).unwrap();
    for step in 0..=88 {
        // From 0.9 m in front of the sprite's centre to 0.75 m behind it. Near plane at 0.1 m, radius 0.7 m.
        let scene = one_sprite(technique, 0.9 - 1.2 * step as f32 / 64.0);
        host.draw(gpu(), &scene).unwrap();
        let picture = host.picture(gpu()).unwrap();
        let amounts: Vec<f32> =
            picture.texels.iter().map(|texel| if *texel == BACKDROP { 0.0 } else { texel.x }).collect();
        if let Some(previous) = previous.replace(amounts.clone()) {
            let changes = amounts.iter().zip(&previous).map(|(a, b): (&f32, &f32)| (a - b).abs());
            largest = largest.max(changes.fold(0.0, f32::max));
        }
    }
    largest
}

/// Limit for spheres. The camera moves by 19 mm per step, and density times amount is 2.4 per metre, so the amount
/// along the central ray changes by at most 1 - exp(-2.4 · 0.019) = 4.5 %.
const MAX_SPHERE_STEP: f32 = 0.045;

/// Limit for squares, which also grow on screen: by a fifth per step close to the near plane. A square that vanishes at
/// once changes by 0.8.
const MAX_SLAB_STEP: f32 = 0.2;

#[test]
fn spherical_billboards_do_not_pop_at_the_near_plane() {
    let sphere = largest_step(Technique::SphericalBillboard);
    let square = largest_step(Technique::Soft);
    println!("largest change in a step: sphere {sphere:.3}, square {square:.3}");
    assert!(sphere < MAX_SPHERE_STEP, "largest change in a step: {sphere}");
    // The mutant: a flat square disappears in one step.
    assert!(square > 10.0 * MAX_SPHERE_STEP, "largest change in a step of the mutant: {square}");
}

#[test]
fn slabs_vanish_when_their_far_side_passes_the_near_plane() {
    for technique in [Technique::Density, Technique::DepthSpriteHard, Technique::DepthSpriteSoft] {
        let step = largest_step(technique);
        println!("largest change in a step: {} {step:.3}", technique.name());
        assert!(step < MAX_SLAB_STEP, "largest change in a step: {} {step}", technique.name());
        for depth in [-0.55, -0.3, 0.0, 0.05, 0.1, 0.4, 0.69, 0.75] {
            assert_agreement(&format!("{} at {depth} m", technique.name()), &one_sprite(technique, depth));
        }
        assert!(amount(&one_sprite(technique, -0.3)) > 0.0, "{}: nothing at -0.3 m", technique.name());
        assert!(amount(&one_sprite(technique, -0.65)) <= 0.0, "{}: smoke at -0.65 m", technique.name());
    }
}

#[test]
fn volumes_are_clipped_by_the_scene_and_the_near_plane() {
    for technique in [Technique::VolumetricHard, Technique::VolumetricSoft, Technique::SphericalBillboard] {
        // Optical depth through the middle of a sphere at `depth`. With its centre on the wall, about half is left.
        let through = |depth: f32| {
            let mut scene = wall(technique, depth);
            scene.settings.soft_fade.fade_scale = 1000.0;
            (scene.settings.volumetric.march_steps, scene.settings.volumetric.noise_octaves) = (8, 1);
            -(1.0 - amount(&scene)).ln()
        };
        let (whole, half) = (through(5.4), through(6.2));
        println!("{}: optical depth {whole:.3} whole, {half:.3} half", technique.name());
        // Half, within a quarter either way because the noise is uneven. Without clipping it would be the whole.
        assert!((0.25..0.75).contains(&(half / whole)), "{}: optical depth {half} of {whole}", technique.name());
        // With the camera at the sphere's centre, the part beyond the near plane is left, and both renderers agree.
        let inside = one_sprite(technique, 0.0);
        let ahead = -(1.0 - amount(&inside)).ln();
        println!("{}: optical depth {ahead:.3} from inside", technique.name());
        assert!(
            (0.15..0.75).contains(&(ahead / whole)),
            "{}: optical depth {ahead} of {whole} from inside",
            technique.name()
        );
        for depth in [-0.55, -0.3, 0.0, 0.05, 0.1, 0.4, 0.69, 0.75] {
            assert_agreement(&format!("{} at {depth} m", technique.name()), &one_sprite(technique, depth));
        }
        // Nothing is left once the far side has passed the near plane.
        assert!(amount(&one_sprite(technique, -0.65)) <= 0.0);
    }
}

#[test]
fn depth_sprites_intersect_the_scene_at_the_depth_of_their_texels() {
    // In the middle, the detail map moves texels towards the viewer by 0.8 radii, 0.55 m.
    let seen = |technique, depth: f32| amount(&wall(technique, depth)) > 0.0;
    assert!(seen(Technique::Hard, 6.1) && !seen(Technique::Hard, 6.3));
    assert!(seen(Technique::DepthSpriteHard, 6.3) && seen(Technique::DepthSpriteHard, 6.6));
    assert!(!seen(Technique::DepthSpriteHard, 6.9));
    assert!(seen(Technique::DepthSpriteSoft, 6.6) && !seen(Technique::DepthSpriteSoft, 6.9));
}

#[test]
fn nothing_is_drawn_beyond_the_far_plane() {
    for &technique in Technique::ALL {
        for path in [RenderPath::Raster, RenderPath::Forward] {
            let drawn = |depth: f32| {
                let mut scene = one_sprite(technique, depth);
                scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, 0.1, 6.0);
                (scene.settings.path, scene.debug_view) = (path, DebugView::Final);
                scene.on_gpu(gpu()).picture.texels.iter().any(|&texel| texel != BACKDROP)
            };
            assert!(drawn(4.5) && !drawn(7.0), "{} {}", technique.name(), path.name());
        }
    }
}

// Invalid input.

#[test]
fn degenerate_input_stays_finite_or_is_an_error_that_names_the_field() {
    let refused = |change: fn(&mut TestScene)| {
        let mut scene = scene(Technique::Soft);
        change(&mut scene);
        match scene.try_on_gpu(gpu()) {
            Err(Error::Field(error)) => error.to_string(),
            other => panic!("{:?}", other.map(|_| ())),
        }
    };
    let field = |change| refused(change).split(':').next().unwrap().replace("systems[0].settings.", "");
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = 0.0), "soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = 1e9), "soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.soft_fade.contrast_power = 0.0), "soft_fade.contrast_power");
    assert_eq!(field(|s| s.settings.soft_fade.contrast_power = 100.0), "soft_fade.contrast_power");
    assert_eq!(field(|s| s.settings.sprite.size = 1e9), "sprite.size");
    assert_eq!(field(|s| s.settings.sprite.debug_loop = 0), "sprite.debug_loop");
    assert_eq!(field(|s| s.settings.volumetric.march_steps = 1), "volumetric.march_steps");
    assert_eq!(field(|s| s.settings.volumetric.noise_size = 0.0), "volumetric.noise_size");
    assert_eq!(field(|s| s.settings.spherical_billboard.density = f32::NAN), "spherical_billboard.density");
    assert_eq!(field(|s| s.time = f32::INFINITY), "time");
    let lacking = |change: fn(&mut TestScene)| {
        let mut scene = scene(Technique::DepthSpriteHard);
        scene.material.detail = None;
        change(&mut scene);
        scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string()
    };
    assert!(lacking(|_| {}).starts_with("systems[0].settings.technique: \"depth_sprite_hard\""));
    let motion = lacking(|s| (s.settings.technique, s.settings.sprite.motion) = (Technique::Soft, 0.5));
    assert!(motion.starts_with("systems[0].settings.sprite.motion: 0.5"), "{motion}");

    // At scale 1 the host's depth needs a target as large as the image.
    let error = refused(|s| {
        (s.settings.accumulate.depth_source, s.settings.accumulate.scale) = (DepthSource::Host, 1);
        s.settings.accumulate.max_side = 100;
    });
    assert!(error.starts_with("systems[0].settings.accumulate.max_side: 100"), "{error}");
    let mut two_frames = scene(Technique::Soft);
    let sheet = image::RgbaImage::new(16, 8);
    let layout = SpriteLayout { columns: 2, rows: 1, y_down: false };
    two_frames.material.detail = Some(Sprite::from_image("two".as_ref(), &sheet, layout).unwrap());
    let error = two_frames.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(error, "systems[0].material.detail: 2 frames is not valid; expected as many as the sprite has, 1");

    for &technique in Technique::ALL {
        let mut scene = scene(technique);
        scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, 2.0) });
        scene.settings.soft_fade.near_fade_end = 0.0;
        (scene.settings.spherical_billboard.density, scene.settings.volumetric.opacity) = (1000.0, 1000.0);
        scene.settings.density.density = 1000.0;
        scene.particles = vec![
            Particle { position: Vec3::ZERO, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 0.0, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 1e-20, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -6.0), radius: 1e9, ..Particle::default() },
            Particle { position: vec3(0.0, 0.0, -0.1), radius: 0.01, ..Particle::default() },
            Particle { position: vec3(1.0, 0.0, -5.0), age: 1e30, ..Particle::default() },
        ];
        let shrink: [fn(&mut TestScene); 3] =
            [|_| {}, |s| s.settings.sprite.size = 0.0, |s| s.settings.spherical_billboard.radius = 0.0];
        for change in shrink {
            change(&mut scene);
            let drawn = scene.on_gpu(gpu());
            assert!(
                drawn.picture.texels.iter().all(|texel| texel.is_finite()),
                "{}: GPU image not finite",
                technique.name()
            );
            let targets = drawn.renderer.targets(0).unwrap();
            assert_eq!(
                non_finite_texels(gpu(), &targets.accumulation[0], targets.size),
                0,
                "{}: target not finite",
                technique.name()
            );
            assert!(
                scene.on_cpu().texels.iter().all(|texel| texel.is_finite()),
                "{}: CPU image not finite",
                technique.name()
            );
        }
    }
}

#[test]
fn soft_linear_requires_and_reads_the_linear_target() {
    let mut scene = scene(Technique::SoftLinear);
    scene.depth = DepthKind::Buffer;
    scene.attach_depth = haze::read_only_depth_is_supported(&gpu().device);
    let error = scene.try_on_gpu(gpu()).map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("systems[0].settings.technique: \"soft_linear\"") && error.contains("Both"), "{error}");
    // With an empty linear target, a technique that reads it shows smoke that the depth buffer hides.
    let mut scene = wall(Technique::Soft, 6.4);
    scene.empty_linear = true;
    let buffer_is_read = haze::read_only_depth_is_supported(&gpu().device);
    assert_eq!(amount(&scene) > 0.0, !buffer_is_read);
    scene.settings.technique = Technique::SoftLinear;
    assert!(amount(&scene) > 0.0);
}
