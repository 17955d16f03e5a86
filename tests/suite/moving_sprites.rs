//! Velocity, tint and heat of single particles: whole frames on the GPU and on the CPU.

use glam::{IVec2, UVec2, Vec3, vec3};
use haze::{Bounds, Particle, SpriteExtent};
use haze_core::frame::particle_bounds;
use haze_core::settings::*;
use haze_preset::builtin;

use crate::gpu::{gpu, is_tiled_available};
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::Host;
use crate::test_scene::{Change, TestScene, assert_agreement_and_effect};

const SIZE: UVec2 = UVec2::new(160, 90);

/// The test cloud, flying apart, in many colors.
fn moving() -> TestScene {
    let mut scene = TestScene::new(SIZE);
    for (index, particle) in (0u8..).zip(&mut scene.particles) {
        particle.velocity = (particle.position - vec3(0.0, 0.0, -6.0)) * 2.0;
        particle.tint = [255, 3 * index, 255 - 4 * index];
        particle.heat = 40 + 3 * index;
    }
    scene.settings.sprite.stretch = 0.3;
    scene.settings.sprite.stretch_limit = 3.0;
    scene
}

const CHANGES: &[(&str, Change)] = &[
    ("raster", |_| {}),
    ("forward", |s| s.settings.path = RenderPath::Forward),
    ("tiled", |s| s.settings.path = RenderPath::Tiled),
    ("six-way, tiled", |s| (s.settings.lighting, s.settings.path) = (Lighting::SixWay, RenderPath::Tiled)),
    ("weighted", |s| s.settings.accumulate.order = BlendOrder::Weighted),
    ("weighted, tiled", |s| {
        s.settings.accumulate.order = BlendOrder::Weighted;
        s.settings.path = RenderPath::Tiled;
    }),
    ("with shadow, tiled", |s| (s.settings.shadow.strength, s.settings.path) = (0.8, RenderPath::Tiled)),
    ("hard", |s| s.settings.technique = Technique::Hard),
    ("density", |s| s.settings.technique = Technique::Density),
    ("depth sprites", |s| s.settings.technique = Technique::DepthSpriteSoft),
    ("depth sprites, tiled", |s| {
        s.settings.technique = Technique::DepthSpriteSoft;
        s.settings.path = RenderPath::Tiled;
    }),
    ("coarse", |s| s.settings.accumulate.downscale = 3),
];

fn for_each_change(turn_off: Change, most: f32, start: Change) {
    for (name, change) in CHANGES {
        let mut scene = moving();
        start(&mut scene);
        change(&mut scene);
        let needs_compute = scene.settings.path == RenderPath::Tiled || scene.settings.shadow.strength > 0.0;
        if is_tiled_available() || !needs_compute {
            assert_agreement_and_effect(name, scene, turn_off, most);
        }
    }
}

#[test]
fn gpu_and_cpu_stretch_the_same_sprites() {
    for_each_change(|s| s.settings.sprite.stretch = 0.0, 40.0, |_| {});
}

#[test]
fn gpu_and_cpu_draw_the_same_particle_colors() {
    for_each_change(|s| s.settings.sprite.tint = 0.0, 40.0, |s| s.settings.sprite.tint = 0.9);
}

#[test]
fn gpu_and_cpu_draw_the_same_particle_heat() {
    let cold: Change = |s| s.particles.iter_mut().for_each(|particle| particle.heat = 255);
    for_each_change(cold, 45.0, |s| s.settings.fire.intensity = 3.0);
}

/// One sprite in the middle, with this velocity.
fn streak(velocity: Vec3, path: RenderPath) -> TestScene {
    let mut scene = moving();
    scene.particles = vec![Particle { position: vec3(0.0, 0.0, -5.0), radius: 0.4, velocity, ..Particle::default() }];
    scene.settings.path = path;
    scene.settings.accumulate.downscale = 1;
    scene.wall_everywhere = true;
    scene
}

/// Numbers of columns and rows that a scene's smoke changes.
fn size_of(scene: &TestScene) -> (usize, usize) {
    let image = scene.on_gpu(gpu()).image;
    let empty = TestScene { particles: Vec::new(), ..scene.clone() }.on_gpu(gpu()).image;
    let differs = |x: i32, y: i32| {
        let at = IVec2::new(x, y);
        (image.load(at) - empty.load(at)).abs().max_element() > 0.004
    };
    let width = SIZE.x as i32;
    let height = SIZE.y as i32;
    let columns = (0..width).filter(|&x| (0..height).any(|y| differs(x, y))).count();
    let rows = (0..height).filter(|&y| (0..width).any(|x| differs(x, y))).count();
    (columns, rows)
}

#[test]
fn sprites_grow_along_their_motion_only() {
    for path in [RenderPath::Raster, RenderPath::Tiled, RenderPath::Forward] {
        if path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        let (columns, rows) = size_of(&streak(Vec3::ZERO, path));
        // 0.8 m further in 0.3 s: twice as long.
        let across = size_of(&streak(vec3(2.667, 0.0, 0.0), path));
        let up = size_of(&streak(vec3(0.0, 2.667, 0.0), path));
        let towards = size_of(&streak(vec3(0.0, 0.0, 2.667), path));
        println!("{columns}x{rows}, across {across:?}, up {up:?}, towards {towards:?}");
        assert!(across.0.abs_diff(2 * columns) <= 4 && across.1.abs_diff(rows) <= 2, "{path:?}: {across:?}");
        assert!(up.1.abs_diff(2 * rows) <= 4 && up.0.abs_diff(columns) <= 2, "{path:?}: {up:?}");
        assert_eq!(towards, (columns, rows), "{path:?}");
        // The limit: three times.
        let fast = size_of(&streak(vec3(-1.0e6, 0.0, 0.0), path));
        assert!(fast.0.abs_diff(3 * columns) <= 6, "{path:?}: {fast:?}");
    }
}

/// Sum of what a scene's smoke changes.
fn change(scene: &TestScene) -> f32 {
    let image = scene.on_gpu(gpu()).image;
    let empty = TestScene { particles: Vec::new(), ..scene.clone() }.on_gpu(gpu()).image;
    image.texels.iter().zip(&empty.texels).map(|(a, b)| (a - b).abs().element_sum()).sum()
}

#[test]
fn streaks_thinner_than_a_texel_do_not_flicker() {
    // A texel is 0.04 m wide at this depth.
    let sum = |radius: f32, step: u8| {
        let mut scene = streak(vec3(2.0, 0.3, 0.0), RenderPath::Raster);
        scene.bounds = Some(Bounds { min: vec3(-1.0, -1.0, -6.0), max: vec3(1.0, 1.0, -4.0) });
        scene.particles[0].radius = radius;
        scene.particles[0].position += vec3(0.013, 0.017, 0.0) * f32::from(step);
        scene.settings.sprite.stretch_limit = 64.0;
        scene.settings.boost = 1.0;
        change(&scene)
    };
    for radius in [0.004, 0.008, 0.015] {
        let sums: Vec<_> = (0..6).map(|step| sum(radius, step)).collect();
        let mean = sums.iter().sum::<f32>() / 6.0;
        println!("{radius}: {sums:?}");
        assert!(sums.iter().all(|sum| (sum / mean - 1.0).abs() < 0.2), "{radius}: {sums:?}");
    }
}

/// Largest difference of the amount along a trail of particles that follow each other at the distance of two radii, relative
/// to its mean. `seconds`: of the stretch.
fn ripple(path: RenderPath, seconds: f32) -> f32 {
    let mut scene = streak(Vec3::ZERO, path);
    scene.debug_view = DebugView::Amount;
    scene.material.sprite = builtin::find(builtin::SPRITES, "ball").unwrap().sprite().unwrap();
    scene.material.detail = None;
    scene.material.six_way = None;
    scene.settings.sprite.stretch = seconds;
    scene.settings.sprite.stretch_limit = 64.0;
    // Ten are born in a second.
    let spacing = vec3(0.25, 0.0, 0.0);
    let first = vec3(-4.0, 0.0, -5.0);
    let particle = |index: u16| Particle {
        position: first + spacing * f32::from(index),
        velocity: spacing * 10.0,
        radius: 0.12,
        amount: 0.15,
        ..Particle::default()
    };
    scene.particles = (0..33).map(particle).collect();
    let image = scene.on_gpu(gpu()).image;
    let middle = |x: i32| image.load(IVec2::new(x, SIZE.y as i32 / 2)).x;
    let amounts: Vec<f32> = (SIZE.x as i32 * 3 / 8..SIZE.x as i32 * 5 / 8).map(middle).collect();
    let (low, high) = amounts.iter().fold((f32::MAX, 0.0_f32), |(low, high), a| (low.min(*a), high.max(*a)));
    (high - low) / (amounts.iter().sum::<f32>() / amounts.len() as f32)
}

#[test]
fn particles_that_are_stretched_over_the_next_ones_leave_a_trail_without_beads() {
    for path in [RenderPath::Raster, RenderPath::Tiled] {
        if path == RenderPath::Tiled && !is_tiled_available() {
            continue;
        }
        let [beads, trail] = [0.0, 1.0].map(|seconds| ripple(path, seconds));
        println!("{}: ripple {beads:.3}, stretched {trail:.3}", path.name());
        assert!(beads > 0.1 && trail <= 0.03, "{path:?}: {beads}, stretched {trail}");
    }
}

#[test]
fn velocities_that_are_no_numbers_hide_their_sprites_alone() {
    let mut scene = moving();
    // Of unsorted sprites, the order does not matter.
    scene.settings.accumulate.order = BlendOrder::Weighted;
    scene.bounds = Some(particle_bounds(&scene.particles, SpriteExtent::from_settings(&scene.settings)));
    let mut host = Host::new(gpu(), &scene).unwrap();
    // From a buffer, and from a slice.
    let mut images = |scene: &TestScene| {
        host.draw_buffer(gpu(), scene, &scene.particles).unwrap();
        [host.image(gpu()).unwrap(), scene.on_gpu(gpu()).image]
    };
    let expected = images(&scene);
    let broken = [f32::NAN, f32::INFINITY, 1.0e30].map(|speed| {
        let velocity = Vec3::new(0.0, speed, 0.0);
        Particle { position: vec3(0.0, 0.0, -5.0), velocity, ..Particle::default() }
    });
    scene.particles.extend(broken);
    for (seen, expected) in images(&scene).iter().zip(&expected) {
        let same = psnr(seen, expected);
        assert!(same >= MIN_PSNR, "{same:.1} dB");
    }
}
