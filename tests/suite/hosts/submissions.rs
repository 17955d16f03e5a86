//! Several views in one submission, and a second `prepare` before the first is submitted.

use glam::{Mat4, vec3};
use haze::{FrameInput, ParticleSystem, Particles, SceneDepth};

use super::{SIZE, encoder, rejected_field, slice};
use crate::gpu::gpu;
use crate::psnr::psnr;
use crate::test_host::Host;
use crate::test_scene::TestScene;

#[test]
fn two_views_in_one_submission_match_two_separate_frames() {
    let left = TestScene::new(SIZE);
    let mut right = TestScene::new(SIZE);
    right.view.view_from_world = Mat4::from_translation(vec3(-0.6, 0.2, 0.5));
    right.lights[0].intensity = 5.0;
    let expected = [left.on_gpu(gpu()).image, right.on_gpu(gpu()).image];
    assert!(psnr(&expected[0], &expected[1]) < 30.0, "the two views are too similar for this test");

    let mut one = Host::new(gpu(), &left).unwrap();
    let context = one.renderer.context().clone();
    let mut other = Host::with_context(gpu(), &right, Some(&context)).unwrap();
    // Materials belong to the device, not to a view.
    other.material = one.material.clone();
    for _ in 0..2 {
        let mut encoder = encoder(gpu());
        one.prepare(&mut encoder, &left, slice(&left)).unwrap();
        other.prepare(&mut encoder, &right, slice(&right)).unwrap();
        one.render(&mut encoder, &left);
        other.render(&mut encoder, &right);
        gpu().submit(encoder).unwrap();
        assert!(one.image(gpu()).unwrap() == expected[0] && other.image(gpu()).unwrap() == expected[1]);
    }
    // Another view on the same context compiles no further pipelines.
    let mut third = Host::with_context(gpu(), &left, Some(&context)).unwrap();
    let compiled = context.pipeline_count();
    third.draw(gpu(), &left).unwrap();
    assert_eq!(context.pipeline_count(), compiled);
}

#[test]
fn second_prepare_before_the_first_is_submitted_is_rejected() {
    let scene = TestScene::new(SIZE);
    let image = scene.on_gpu(gpu()).image;
    let mut host = Host::new(gpu(), &scene).unwrap();
    let refused = |host: &mut Host| {
        let mut encoder = encoder(gpu());
        rejected_field(host.prepare(&mut encoder, &scene, slice(&scene)))
    };
    // Rejected both in the same encoder and in another one.
    let mut first = encoder(gpu());
    host.prepare(&mut first, &scene, slice(&scene)).unwrap();
    assert_eq!(rejected_field(host.prepare(&mut first, &scene, slice(&scene))), "prepare");
    assert_eq!(refused(&mut host), "prepare");
    // Accepted after the first encoder is dropped.
    drop(first);
    let mut second = encoder(gpu());
    host.prepare(&mut second, &scene, slice(&scene)).unwrap();
    // A pass in a separate encoder must be submitted too, even if the encoder of `prepare` already was.
    let mut passes = encoder(gpu());
    host.render(&mut passes, &scene);
    gpu().submit(second).unwrap();
    assert_eq!(refused(&mut host), "prepare");
    // Submission is enough; the GPU need not have finished.
    gpu().queue.submit([passes.finish()]);
    let mut third = encoder(gpu());
    host.prepare(&mut third, &scene, slice(&scene)).unwrap();
    host.render(&mut third, &scene);
    gpu().submit(third).unwrap();
    assert!(host.image(gpu()).unwrap() == image);
    gpu().check().unwrap();
}

#[test]
fn systems_can_be_drawn_one_by_one_between_objects_of_the_host() {
    let scene = TestScene::new(SIZE);
    let mut host = Host::new(gpu(), &scene).unwrap();
    let mut behind = scene.particles.clone();
    behind.iter_mut().for_each(|particle| particle.position += vec3(0.4, 0.2, -1.5));
    let material = host.material.clone();
    let linear = host.linear.clone();
    let systems = [(7, &scene.particles), (3, &behind)]
        .map(|(key, particles)| ParticleSystem::new(key, Particles::Slice(particles), &scene.settings, &material));
    let frame = FrameInput {
        lights: &scene.lights,
        systems: &systems,
        ..FrameInput::new(scene.view, SceneDepth::Linear(&linear))
    };
    let mut draw = |is_single: bool| {
        let mut encoder = encoder(gpu());
        host.renderer.prepare(&mut encoder, &frame).unwrap();
        let [near, far] = [7, 3].map(|key| host.renderer.depth_of(key).unwrap());
        assert!(far > near + 1.0 && host.renderer.depth_of(1).is_none());
        let renderer = &host.renderer;
        host.render_with(&mut encoder, &scene, |pass| {
            if is_single {
                [3, 7, 1].into_iter().for_each(|key| renderer.render_system(pass, key));
            } else {
                renderer.render(pass);
            }
        });
        gpu().submit(encoder).unwrap();
        host.image(gpu()).unwrap()
    };
    assert!(draw(true) == draw(false));
}
