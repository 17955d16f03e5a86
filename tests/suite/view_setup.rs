//! Tests of the view setup that both renderers share. Results are compared with laws that are derived here: spherical
//! harmonics, spot cones, light ranges, the order of sprites, and visibility.

use glam::camera::rh::proj::directx;
use glam::{IVec2, Mat4, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, vec3, vec4};
use haze::{Bounds, Light, LightKind, Particle};
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::settings::{DebugView, DiffuseMode};

use crate::gpu::gpu;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

const SIZE: UVec2 = UVec2::new(96, 54);

/// View matrix of a camera that is away from the origin and rotated about two axes.
fn camera() -> Mat4 {
    Mat4::from_rotation_x(0.3) * Mat4::from_rotation_y(-0.8) * Mat4::from_translation(vec3(1.0, -2.0, 3.0))
}

/// Sprite with one normal and alpha 1 everywhere, except for a transparent border of one texel.
fn flat_sprite() -> Sprite {
    let image = image::RgbaImage::from_fn(64, 64, |x, y| {
        let inside = (1..63).contains(&x) && (1..63).contains(&y);
        image::Rgba([128, 128, 255, if inside { 255 } else { 0 }])
    });
    Sprite::from_image("flat".as_ref(), &image, SpriteLayout::default()).unwrap()
}

/// View depth of the sheet, metres. The sheet is in front of everything in the scene.
const SHEET: f32 = 4.0;
/// Half the side of the sheet, metres.
const HALF: f32 = 1.5;

/// Stage with a flat, opaque sheet that faces the camera. The diffuse ramp is white, so a pixel shows only the amount
/// of light that reaches it.
fn sheet(light_uniforms: &[Light]) -> TestScene {
    let mut scene = TestScene::new(SIZE);
    // The view matrix permutes the axes, so that the box is as thin in world space as in view space.
    scene.view.view_from_world = Mat4::from_cols(Vec4::Y, Vec4::Z, Vec4::X, vec4(1.0, -2.0, 3.0, 1.0));
    let world_from_view = scene.view.view_from_world.inverse();
    let [a, b] = [vec3(-HALF, -HALF, -SHEET - 0.05), vec3(HALF, HALF, -SHEET + 0.05)]
        .map(|corner| world_from_view.transform_point3(corner));
    scene.bounds = Some(Bounds { min: a.min(b), max: a.max(b) });
    let position = world_from_view.transform_point3(vec3(0.0, 0.0, -SHEET));
    scene.particles = vec![Particle { position, radius: HALF, ..Particle::default() }];
    scene.lights = light_uniforms.to_vec();
    for light in &mut scene.lights {
        light.position = world_from_view.transform_point3(light.position);
        light.direction = world_from_view.transform_vector3(light.direction);
    }
    scene.material.sprite = flat_sprite();
    scene.material.diffuse_ramp = Ramp::from_linear(UVec2::new(2, 1), [Vec3::ONE; 2]);
    scene.settings.diffuse.intensity = 1.0;
    scene.settings.soft_fade.fade_scale = 1000.0;
    scene.settings.accumulate.downscale = 1;
    scene.debug_view = DebugView::Diffuse;
    scene
}

/// Returns the view-space point at `view_depth` behind the center of pixel `at`, by inverting the projection.
fn point_behind(scene: &TestScene, at: UVec2, view_depth: f32) -> Vec3 {
    let uv = (at.as_vec2() + 0.5) / scene.view.size.as_vec2();
    let ndc = Vec2::new(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0);
    let view_from_clip = scene.view.clip_from_view.inverse();
    let [a, b] = [0.25, 0.75].map(|z| view_from_clip.project_point3(ndc.extend(z)));
    a.lerp(b, (-view_depth - a.z) / (b.z - a.z))
}

/// Calls `check` with the view-space point and the light of every pixel of the sheet, for both renderers. Pixels close
/// to the border of the sheet are left out.
fn check_sheet(scene: &TestScene, mut check: impl FnMut(Vec3, f32)) {
    for image in [scene.on_cpu(), scene.on_gpu(gpu()).image] {
        for (index, texel) in (0..).zip(&image.texels) {
            let point = point_behind(scene, UVec2::new(index % SIZE.x, index / SIZE.x), SHEET);
            if point.xy().abs().max_element() < 0.9 * HALF {
                check(point, texel.x);
            }
        }
    }
}

// Lights

#[test]
fn spot_light_falls_from_full_at_the_inner_angle_to_zero_at_the_outer_angle() {
    let spot = Light {
        kind: LightKind::Spot,
        position: vec3(0.7, 0.4, -1.5),
        direction: vec3(-0.9, -0.5, -2.0),
        intensity: 100.0,
        inner_angle: 12.0,
        outer_angle: 24.0,
        range: 50.0,
        ..Light::default()
    };
    let point = sheet(&[Light { kind: LightKind::Point, ..spot }]);
    let mut whole = Vec::new();
    check_sheet(&point, |_, light| whole.push(light));
    let inner = 12.0_f32.to_radians().cos();
    let outer = 24.0_f32.to_radians().cos();
    let mut index = 0;
    let mut seen = [0; 3];
    check_sheet(&sheet(&[spot]), |point, light| {
        let cos = (point - spot.position).normalize().dot(spot.direction.normalize());
        let fraction = light / whole[index];
        // Quadratic in the cosine: halfway between the angles' cosines, a quarter of the light is left.
        let law = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
        // Both images are f16: two roundings of 2^-11.
        assert!(
            (fraction - law).abs() < 1.5e-3,
            "{fraction} of the light at {point}, {} degrees off the axis",
            cos.acos().to_degrees()
        );
        index += 1;
        seen[usize::from(law > 0.0) + usize::from(law >= 1.0)] += 1;
    });
    assert!(seen.iter().all(|&pixels| pixels > 100), "{seen:?} pixels outside, between and inside");
}

#[test]
fn point_light_is_zero_beyond_its_range() {
    // (edge or corner of the sheet, offset of the light from there): about 1 m from edges, a corner and both faces, and
    // on the sheet.
    let positions = [
        (Vec3::X, Vec3::X),
        (Vec3::NEG_X, Vec3::NEG_X),
        (Vec3::Y, Vec3::Y),
        (Vec3::NEG_Y, Vec3::NEG_Y),
        (vec3(1.0, -1.0, 0.0), vec3(0.6, -0.6, 0.5)),
        (Vec3::ZERO, Vec3::Z),
        (Vec3::ZERO, Vec3::NEG_Z),
        (Vec3::ZERO, Vec3::ZERO),
    ];
    for (edge, off) in positions {
        let position = vec3(0.0, 0.0, -SHEET) + edge * HALF + off;
        for range in [0.95, 1.3] {
            let light = Light { position, range, intensity: 1.0e4, radius: 1.0, ..Light::default() };
            let mut is_lit = false;
            check_sheet(&sheet(&[light]), |point, light| {
                let distance = point.distance(position);
                // In the last 2 % of the range, the light may be too weak to be stored.
                assert!(distance < range || light <= 0.0, "{light} at {distance} m from {position}, beyond {range} m");
                assert!(distance > 0.98 * range || light > 0.0, "dark at {distance} m from {position}");
                is_lit |= light > 0.0;
            });
            assert_eq!(is_lit, range > off.length(), "a light at {position} with a range of {range} m");
        }
    }
}

/// Returns the largest difference of any channel.
fn largest_difference(a: &Image<Vec4>, b: &Image<Vec4>) -> f32 {
    a.texels.iter().zip(&b.texels).map(|(a, b)| (a - b).abs().max_element()).fold(0.0, f32::max)
}

/// Stage with a cloud lit by one light. The ramp is quadratic in the cosine, so L2 spherical harmonics represent it
/// exactly.
fn lit_by_quadratic_ramp(light: Light, mode: DiffuseMode) -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.lights = vec![light];
    let parabola = |cos: f32| vec3(0.5 + 0.5 * cos, 0.2 + 0.5 * cos + 0.4 * cos * cos, 1.0 - cos * cos);
    let ramp = (0..256).map(|i| parabola(i as f32 / 255.0 * 2.0 - 1.0));
    scene.material.diffuse_ramp = Ramp::from_linear(UVec2::new(256, 1), ramp);
    scene.settings.diffuse.mode = mode;
    scene.debug_view = DebugView::Diffuse;
    // Bounds other than the smoke's own: lighting must not use their center.
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    scene
}

#[test]
fn spherical_harmonics_match_a_quadratic_ramp_for_every_light_direction() {
    let directions =
        [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, vec3(1.0, 2.0, -3.0), vec3(-3.0, 1.0, 0.5)];
    for direction in directions {
        let light = |direction| Light { kind: LightKind::Directional, direction, ..Light::default() };
        let ramp = lit_by_quadratic_ramp(light(direction), DiffuseMode::Ramp).on_cpu();
        let harmonics = lit_by_quadratic_ramp(light(direction), DiffuseMode::SphericalHarmonics);
        // Texels of the ramp are f16: an error of half of 2^-10 between 1 and 2. On the GPU, normals and the image are
        // f16 too.
        let cpu = harmonics.on_cpu();
        let gpu = harmonics.on_gpu(gpu()).image;
        let found = [&cpu, &gpu].map(|image| largest_difference(image, &ramp));
        println!("{direction}: {found:?}");
        assert!(found[0] < 5e-4 && found[1] < 4e-3, "{direction}: {found:?}");
        // Mutant: light from the opposite side.
        let turned = lit_by_quadratic_ramp(light(-direction), DiffuseMode::SphericalHarmonics).on_cpu();
        assert!(largest_difference(&turned, &ramp) > 0.1, "{direction}");
    }
}

#[test]
fn spherical_harmonics_treat_a_point_light_as_seen_from_the_centroid_of_the_smoke() {
    let lamp = Light { position: vec3(-3.0, 2.0, -4.5), intensity: 20.0, range: 9.0, ..Light::default() };
    let particles = lit_by_quadratic_ramp(lamp, DiffuseMode::Ramp).particles;
    let weight = |particle: &Particle| particle.amount * particle.radius * particle.radius;
    let sum: Vec3 = particles.iter().map(|particle| particle.position * weight(particle)).sum();
    let way = sum / particles.iter().map(weight).sum::<f32>() - lamp.position;
    let square = way.length_squared();
    let window = 1.0 - (square / 81.0).powi(2);
    let sun = Light {
        kind: LightKind::Directional,
        direction: way,
        intensity: 20.0 * window * window / (square + lamp.radius * lamp.radius),
        ..Light::default()
    };
    let [lamp, sun] = [lamp, sun].map(|light| lit_by_quadratic_ramp(light, DiffuseMode::SphericalHarmonics).on_cpu());
    let found = largest_difference(&lamp, &sun);
    assert!(found < 1e-5, "{found}");
}

// Draw order

#[test]
fn sprites_are_drawn_in_the_order_of_a_plain_depth_sort() {
    let mut scene = TestScene::new(SIZE);
    let world_from_view = camera().inverse();
    scene.view.view_from_world = camera();
    for particle in &mut scene.particles {
        particle.position = world_from_view.transform_point3(particle.position);
        particle.amount = 0.9;
    }
    scene.debug_view = DebugView::Normals;
    // Scale 1 disables upsampling, which uses the sprites' depths only if the CPU has the particles.
    scene.settings.accumulate.downscale = 1;
    let mut bounds = Bounds::EMPTY;
    scene.particles.iter().for_each(|particle| bounds.include(particle.position, 2.0));
    scene.bounds = Some(bounds);
    let mut host = Host::with_shared_context(gpu(), &scene).unwrap();
    host.draw(gpu(), &scene).unwrap();
    let sorted_by_renderer = host.image(gpu()).unwrap();
    // Particles in a buffer are drawn in their given order.
    let depth = |particle: &Particle| -(scene.view.view_from_world * particle.position.extend(1.0)).z;
    let mut sorted = scene.particles.clone();
    sorted.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
    assert_ne!(sorted, scene.particles);
    let mut in_order = |particles: &[Particle]| {
        host.draw_buffer(gpu(), &scene, particles).unwrap();
        host.image(gpu()).unwrap()
    };
    assert!(in_order(&sorted) == sorted_by_renderer, "the renderer did not sort back to front");
    sorted.reverse();
    assert!(in_order(&sorted) != sorted_by_renderer);
    // The CPU renderer does not depend on the order of the list either.
    let on_cpu = scene.on_cpu();
    scene.particles.reverse();
    assert!(scene.on_cpu() == on_cpu);
}

// Visibility

/// Rotation of the sprite that is moved in and out of view, radians.
const TURN: f32 = 0.6;

/// Draws one sprite at `center` (view space) with both renderers. Returns true if some pixel shows it. Asserts that
/// pixels outside the sprite do not show it, and that pixels well inside show it exactly if its depth is between `near`
/// and `far`.
fn draws_sprite(scene: &mut TestScene, host: &mut Host, (near, far): (f32, f32), center: Vec3, radius: f32) -> bool {
    let position = scene.view.view_from_world.inverse().transform_point3(center);
    scene.particles = vec![Particle { position, radius, rotation: TURN, ..Particle::default() }];
    host.draw(gpu(), scene).unwrap();
    let mut any = false;
    for (renderer, image) in [("CPU", scene.on_cpu()), ("GPU", host.image(gpu()).unwrap())] {
        for (index, texel) in (0..).zip(&image.texels) {
            let at = UVec2::new(index % SIZE.x, index / SIZE.x);
            let offset = (point_behind(scene, at, -center.z) - center).xy();
            let local = Vec2::from_angle(-TURN).rotate(offset).abs().max_element() / radius;
            // The margins allow for the border texel and for a pixel of filtering.
            let inside = local < 0.8;
            let outside = local > 1.2;
            let in_depth = (near..far).contains(&-center.z);
            let shown = *texel != BACKDROP;
            assert!(!(shown && (outside || !in_depth)), "{renderer}: {at} shows a sprite at {center}");
            assert!(shown || !(inside && in_depth), "{renderer}: {at} does not show a sprite at {center}");
            any |= shown;
        }
    }
    any
}

/// Stage with sharp-edged smoke that is visible wherever it is present.
fn sharp_smoke_stage() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    scene.material.sprite = flat_sprite();
    scene.settings.soft_fade.near_fade_end = 0.0;
    scene.settings.soft_fade.fade_scale = 1000.0;
    scene.settings.accumulate.downscale = 1;
    scene.debug_view = DebugView::SoftScatter;
    scene
}

#[test]
fn system_is_drawn_exactly_when_it_is_inside_the_view_frustum() {
    let near = 0.5;
    let far = 9.0;
    let projections = [
        directx::perspective(0.8, 16.0 / 9.0, near, far),
        directx::frustum(-0.3, 0.15, -0.1, 0.2, near, far),
        directx::orthographic(-4.0, 3.0, -2.0, 2.5, near, far),
    ];
    for clip_from_view in projections {
        let mut scene = sharp_smoke_stage();
        scene.view.clip_from_view = clip_from_view;
        scene.view.view_from_world = camera();
        let mut host = Host::with_shared_context(gpu(), &scene).unwrap();
        // Side planes: the sprite crosses each at the middle of an image edge, in front of everything in the scene.
        let pixels = SIZE.as_ivec2();
        let edges = [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y];
        for (edge, depth) in edges.into_iter().flat_map(|edge| [0.8, 3.0].map(|depth| (edge, depth))) {
            let at = ((edge + 1) * pixels / 2).clamp(IVec2::ZERO, pixels - 1).as_uvec2();
            let crossing = point_behind(&scene, at, depth);
            // Image y points down, view-space y points up.
            let outwards = edge.as_vec2() * Vec2::new(1.0, -1.0);
            let seen = (-5..=10).map(|step| {
                let center = crossing + (outwards * (0.1 * step as f32)).extend(0.0);
                draws_sprite(&mut scene, &mut host, (near, far), center, 0.5)
            });
            let seen: Vec<bool> = seen.collect();
            assert!(seen[0] && !seen[seen.len() - 1], "{edge}");
        }
        // Near and far planes, to the right of the wall and the post.
        for (plane, depths) in [(near, [0.47, 0.53]), (far, [8.95, 9.05])] {
            let seen = depths.map(|depth| {
                let center = point_behind(&scene, UVec2::new(SIZE.x * 5 / 6, SIZE.y / 2), depth);
                draws_sprite(&mut scene, &mut host, (near, far), center, 0.5)
            });
            assert_eq!(seen, depths.map(|depth| (near..far).contains(&depth)), "the plane at {plane} m");
        }
    }
}

#[test]
fn flat_bounds_that_cross_the_near_plane_show_all_of_their_smoke() {
    // A floor, a ceiling and two walls, which begin behind the camera or close in front of it.
    for side in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
        for begin in [2.0, -0.6] {
            let mut scene = sharp_smoke_stage();
            let planes = (0.5, 20.0);
            scene.view.clip_from_view = directx::perspective(0.8, 16.0 / 9.0, planes.0, planes.1);
            let middle = side * 0.3;
            let half = side.abs() * 0.05 + side.perp().abs() * 3.0;
            scene.bounds = Some(Bounds { min: (middle - half).extend(-8.0), max: (middle + half).extend(begin) });
            let mut host = Host::with_shared_context(gpu(), &scene).unwrap();
            for depth in [0.75, 1.0, 1.5, 2.5] {
                assert!(
                    draws_sprite(&mut scene, &mut host, planes, middle.extend(-depth), 0.035),
                    "{side} at {depth} m"
                );
            }
        }
    }
}
