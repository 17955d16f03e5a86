//! Frames that are rejected.

use glam::{Mat4, Vec3};
use haze::{Bounds, ParticleBuffer, Particles, wgpu};
use haze_core::error::Error;

use super::SIZE;
use crate::gpu::gpu;
use crate::test_host::Host;
use crate::test_scene::{BACKDROP, TestScene};

#[test]
fn invalid_frames_are_rejected_with_the_name_of_the_field_and_draw_nothing() {
    // Draws a valid frame first, so that leftovers of it show if a rejected frame draws anything.
    let refusal = |host: &mut Host, scene: &TestScene, particles: Particles<'_>| {
        host.draw(gpu(), &TestScene::new(SIZE)).unwrap();
        assert!(host.image(gpu()).unwrap().texels.iter().any(|&texel| texel != BACKDROP));
        let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let error = host.prepare(&mut encoder, scene, particles).unwrap_err();
        host.render(&mut encoder, scene);
        gpu().submit(encoder).unwrap();
        assert!(
            host.image(gpu()).unwrap().texels.iter().all(|&texel| texel == BACKDROP),
            "{error}: the rejected frame draws something"
        );
        error
    };
    let mut host = Host::new(gpu(), &TestScene::new(SIZE)).unwrap();
    let mut field = |change: fn(&mut TestScene)| {
        let mut scene = TestScene::new(SIZE);
        change(&mut scene);
        match refusal(&mut host, &scene, Particles::Slice(&scene.particles)) {
            Error::Field(error) => error.field,
            other => panic!("{other}"),
        }
    };
    assert_eq!(field(|s| s.settings.soft_fade.fade_scale = f32::NAN), "systems[0].settings.soft_fade.fade_scale");
    assert_eq!(field(|s| s.settings.accumulate.downscale = 17), "systems[0].settings.accumulate.downscale");
    assert_eq!(field(|s| s.lights[1].range = -1.0), "lights[1].range");
    assert_eq!(field(|s| s.bounds = Some(Bounds { min: Vec3::ZERO, max: Vec3::INFINITY })), "systems[0].bounds");
    assert_eq!(field(|s| s.view.view_from_world = Mat4::ZERO), "view.view_from_world");

    let mut scene = TestScene::new(SIZE);
    scene.view.size += 1;
    let error = refusal(&mut host, &scene, Particles::Slice(&scene.particles)).to_string();
    assert_eq!(
        error,
        "view.size: 161x91 from (0, 0) is not inside the scene depth; expected the size of the scene depth, 160x90, \
         or a part of it"
    );
    // Particles in a GPU buffer need explicit bounds.
    scene.view.size = SIZE;
    let buffer = gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64,
        usage: wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    });
    let mut refused = |count, bounds| {
        scene.bounds = bounds;
        let particles = Particles::Buffer(ParticleBuffer { is_sorted: true, ..ParticleBuffer::new(&buffer, count) });
        refusal(&mut host, &scene, particles).to_string()
    };
    assert!(refused(2, None).starts_with("systems[0].bounds: None"));
    let somewhere = Some(Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE });
    assert!(refused(3, somewhere).starts_with("systems[0].particles: the buffer has 64 bytes"));
}
