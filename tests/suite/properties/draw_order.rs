//! Results that depend on the draw order of sprites, and results that do not.

use glam::{UVec2, Vec4, vec3};
use haze::{Bounds, Particle};
use haze_core::frame::{SpriteExtent, particle_bounds};
use haze_core::settings::{AccumulationFormat, BlendOrder, DebugView};
use haze_reference::blend_unit::{premultiplied_over, quantise};
use proptest::prelude::*;

use super::SIZE;
use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, psnr};
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

proptest! {
    #[test]
    fn amount_is_one_minus_the_product_of_layer_transmittances(
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
        // Mutant: OTEE's first blend state (SRC_ALPHA, ONE_MINUS_SRC_ALPHA) loses amount, unless an opaque layer hides it.
        let classic = amounts.iter().fold(0.0, |target, a| a * a + target * (1.0 - a));
        let is_hidden = amounts.iter().any(|a| *a >= 0.99);
        prop_assert!(is_hidden || amounts.iter().all(|a| *a < 0.01) || product - classic > 1e-5);
    }
}

#[test]
fn amount_on_the_gpu_does_not_depend_on_draw_order() {
    let mut scene = TestScene::new(SIZE);
    scene.debug_view = DebugView::Amount;
    scene.settings.accumulate.downscale = 1;
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let mut host = Host::new(gpu(), &scene).unwrap();
    // Particles in a buffer are drawn in the host's order.
    let mut draw = |particles: &[Particle]| {
        host.draw_buffer(gpu(), &scene, particles).unwrap();
        host.image(gpu()).unwrap()
    };
    let forwards = draw(&scene.particles);
    let reversed: Vec<_> = scene.particles.iter().rev().copied().collect();
    let backwards = draw(&reversed);
    let difference = forwards.texels.iter().zip(&backwards.texels).map(|(a, b)| (a.x - b.x).abs());
    // 60 layers, each rounded to f16: at worst 60 times half of 2^-11; a third of that was measured.
    assert!(difference.fold(0.0, f32::max) < 60.0 * 0.5 / 2048.0);
    assert!(forwards.texels.iter().any(|texel| texel.x > 0.9));
}

#[test]
fn weighted_order_draws_the_same_image_from_reversed_particles() {
    let mut scene = TestScene::new(SIZE);
    scene.bounds = Some(Bounds { min: vec3(-4.0, -3.0, -9.0), max: vec3(4.0, 3.0, -3.0) });
    let reversed: Vec<_> = scene.particles.iter().rev().copied().collect();
    let mut psnr_after_reversal = |order| {
        scene.settings.accumulate.order = order;
        let mut host = Host::new(gpu(), &scene).unwrap();
        let mut draw = |particles: &[Particle]| {
            host.draw_buffer(gpu(), &scene, particles).unwrap();
            host.image(gpu()).unwrap()
        };
        psnr(&draw(&scene.particles), &draw(&reversed))
    };
    let weighted = psnr_after_reversal(BlendOrder::Weighted);
    let sorted = psnr_after_reversal(BlendOrder::Sorted);
    println!("reversed order: weighted {weighted:.1} dB, sorted {sorted:.1} dB");
    // f16 sums in another order round differently.
    assert!(weighted > MIN_PSNR && sorted < MIN_PSNR, "{weighted} {sorted}");
}

#[test]
fn particle_amounts_above_1_are_drawn_as_1() {
    let mut scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    let mut draw = |amount: f32| {
        scene.particles = vec![Particle { position: vec3(0.0, 0.0, -5.0), amount, ..Particle::default() }];
        scene.bounds = Some(particle_bounds(&scene.particles, SpriteExtent::from_settings(&scene.settings)));
        host.draw(gpu(), &scene).unwrap();
        let slice = host.image(gpu()).unwrap();
        host.draw_buffer(gpu(), &scene, &scene.particles).unwrap();
        [slice, host.image(gpu()).unwrap(), scene.on_cpu()]
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
fn rgba8_target_loses_thin_smoke_and_rgba16float_does_not() {
    // 8-bit rounding stops thin layers from adding up: 400 layers of amount 0.02 should give 1 - 0.98^400 = 0.9997.
    let stack = |format, encoding| {
        let mut scene = TestScene::new(UVec2::splat(32));
        let sprite = Particle { position: vec3(0.0, 0.0, -4.0), radius: 3.0, amount: 0.02, ..Particle::default() };
        scene.particles = vec![sprite; 400];
        scene.settings.accumulate.format = format;
        scene.settings.accumulate.encoding = encoding;
        scene.debug_view = DebugView::Amount;
        scene.on_gpu(gpu()).image.load(glam::IVec2::new(8, 16)).x
    };
    use haze_core::settings::NormalEncoding;
    assert!(stack(AccumulationFormat::Rgba16Float, NormalEncoding::Signed) > 0.97);
    let eight = stack(AccumulationFormat::Rgba8Unorm, NormalEncoding::Biased);
    assert!((0.8..0.95).contains(&eight), "{eight}");
    // The reference rounds as the GPU does.
    let layer = |target, _| quantise(AccumulationFormat::Rgba8Unorm, premultiplied_over(Vec4::splat(0.02), target));
    assert!((0.8..0.95).contains(&(0..400).fold(Vec4::ZERO, layer).w));
}
