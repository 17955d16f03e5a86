//! What light depends on, and what it must not.

use glam::{UVec2, Vec4, vec3};
use haze::Particle;
use haze::picture::Picture;

use crate::stage::Stage;

const SIZE: UVec2 = UVec2::new(96, 64);

fn largest_difference(a: &Picture<Vec4>, b: &Picture<Vec4>) -> f32 {
    a.texels.iter().zip(&b.texels).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn what_cannot_be_seen_lights_nothing_anew() {
    let alone = Stage::new(SIZE);
    let dead = Particle { position: vec3(-1000.0, -1000.0, -1000.0), ..Particle::default() };
    for unseen in
        [Particle { radius: 0.0, ..dead }, Particle { amount: 0.0, ..dead }, Particle { amount: -1.0, ..dead }]
    {
        let mut beside = alone.clone();
        beside.particles.push(unseen);
        assert_eq!(largest_difference(&alone.on_cpu(), &beside.on_cpu()), 0.0, "{unseen:?}");
    }
}

#[test]
fn an_ember_far_behind_lights_nothing_anew() {
    let alone = Stage::new(SIZE);
    let mut beside = alone.clone();
    let ember = Particle { position: vec3(1.9, 0.5, -12.0), radius: 0.02, amount: 0.01, ..Particle::default() };
    beside.particles.push(ember);
    let difference = largest_difference(&alone.on_cpu(), &beside.on_cpu());
    assert!(difference < 0.004, "{difference}");
}

#[test]
fn a_sprite_that_is_born_comes_slowly() {
    let alone = Stage::new(SIZE);
    let step = |amount| {
        let mut beside = alone.clone();
        // In front of all others, and twice their size.
        beside.particles.push(Particle { position: vec3(0.0, 0.0, -3.0), radius: 1.0, amount, ..Particle::default() });
        largest_difference(&alone.on_cpu(), &beside.on_cpu())
    };
    // A new sprite changes what is seen as its own amount does.
    assert!(step(0.001) < 0.004, "{}", step(0.001));
    assert!(step(0.1) > 0.02, "{}", step(0.1));
}

#[test]
fn a_depth_that_is_no_number_is_refused_by_name() {
    let stage = Stage::new(SIZE);
    let system = haze::reference::System {
        depth: Some(f32::NAN),
        ..haze::reference::System::new(&stage.particles, &stage.settings, &stage.material)
    };
    let frame = haze::reference::Frame {
        view: stage.view,
        scene_depth: &stage.ndc_depth(),
        lights: &stage.lights,
        systems: &[system],
        time: 0.0,
        shade_tree: stage.shade_tree,
    };
    let error = haze::reference::render(&frame, &mut Picture::new(SIZE, Vec4::ZERO)).unwrap_err();
    assert_eq!(error.to_string(), "systems[0].depth: NaN is not valid; expected a finite number of metres, or None");
}
