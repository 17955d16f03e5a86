//! Components on the entities of smoke and of lights.

use bevy::camera::Hdr;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::render_resource::BufferUsages;
use bevy::render::storage::ShaderBuffer;
use bevy_haze::{Smoke, SmokeAsset, SmokeBuffer, SmokeClock, SmokeFireLight, SmokeParticle, SmokeParticles};

use crate::host::{Host, SECONDS, host};
use crate::picture::{Picture, count};

fn mask(host: &mut Host, smoke: Entity) -> (Picture, Vec<bool>) {
    let picture = host.picture();
    host.app.world_mut().entity_mut(smoke).insert(Visibility::Hidden);
    let mask = picture.mask_of_difference(&host.picture());
    host.app.world_mut().entity_mut(smoke).insert(Visibility::Inherited);
    (picture, mask)
}

#[test]
fn the_transform_moves_and_scales_smoke() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let (picture, seen) = mask(&mut host, smoke);
    let center = picture.center(&seen);
    host.app.world_mut().entity_mut(smoke).insert(Transform::from_xyz(-2.0, 0.0, 0.0));
    let (picture, moved) = mask(&mut host, smoke);
    assert!(picture.center(&moved)[0] < center[0] - 30.0, "{center:?} {:?}", picture.center(&moved));
    // Half of the smoke's size fits into the view.
    let [half, quarter] = [0.5, 0.25].map(|scale| {
        host.app.world_mut().entity_mut(smoke).insert(Transform::from_scale(Vec3::splat(scale)));
        count(&mask(&mut host, smoke).1)
    });
    assert!(half < count(&seen) && quarter * 2 < half, "{quarter} {half} {}", count(&seen));
    // A parent moves its children.
    let parent = host.app.world_mut().spawn((Transform::from_xyz(1.5, 0.0, -1.0), Visibility::default())).id();
    host.app.world_mut().entity_mut(smoke).insert((Transform::default(), ChildOf(parent)));
    let (picture, child) = mask(&mut host, smoke);
    assert!(picture.center(&child)[0] > center[0] + 15.0);
}

#[test]
fn the_clock_seeks_runs_and_holds() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let (first, seen) = mask(&mut host, smoke);
    let set = |host: &mut Host, clock: SmokeClock| {
        host.app.world_mut().entity_mut(smoke).insert(clock);
    };
    set(&mut host, SmokeClock::paused_at(SECONDS + 3.0));
    let later = host.picture();
    set(&mut host, SmokeClock::paused_at(SECONDS));
    let again = host.picture();
    assert!(later.psnr(&first, &seen) < 30.0 && again.psnr(&first, &seen) > 60.0);
    // Bevy's wrapped clock jumps each hour; the smoke's does not.
    let time = bevy::time::TimeUpdateStrategy::ManualDuration(std::time::Duration::from_millis(250));
    host.app.insert_resource(time);
    set(&mut host, SmokeClock { seconds: 3599.9, speed: 2.0, paused: false });
    host.update(4);
    let clock = *host.app.world().get::<SmokeClock>(smoke).unwrap();
    assert!((clock.seconds - 3601.9).abs() < 1e-6, "{clock:?}");
}

#[test]
fn own_particles_replace_the_emitter() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let puff = SmokeParticle { position: Vec3::new(-1.5, 2.0, 0.0), radius: 0.6, amount: 0.9, ..default() };
    host.app.world_mut().entity_mut(smoke).insert(SmokeParticles::new([puff; 4]));
    let (picture, seen) = mask(&mut host, smoke);
    let center = picture.center(&seen);
    assert!((300..8000).contains(&count(&seen)), "{}", count(&seen));
    // 1.5 m to the left at a distance of 7 m, in a picture 180 pixels high with a field of view of 45°.
    assert!((center[0] - 95.0).abs() < 15.0, "{center:?}");
    host.app.world_mut().get_mut::<SmokeParticles>(smoke).unwrap().set([]);
    let empty = mask(&mut host, smoke).1;
    assert_eq!(count(&empty), 0);
}

#[test]
fn particles_in_a_buffer_look_like_those_of_the_cpu() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let puffs: Vec<_> = (0..40_u8)
        .map(|index| {
            let t = f32::from(index) / 40.0;
            let position = Vec3::new(2.0 * t - 1.5, 1.5 + (7.0 * t).sin(), (5.0 * t).cos());
            SmokeParticle { position, rotation: 9.0 * t, frame: 20.0 * t, ..default() }
        })
        .collect();
    host.app.world_mut().entity_mut(smoke).insert(SmokeParticles::new(puffs.iter().copied()));
    let (slice, seen) = mask(&mut host, smoke);
    let words: Vec<u32> = puffs.iter().flat_map(|puff| puff.to_words()).collect();
    let mut buffer = ShaderBuffer::from(words);
    buffer.buffer_usage |= BufferUsages::VERTEX;
    let buffer = host.app.world_mut().resource_mut::<Assets<ShaderBuffer>>().add(buffer);
    let bounds = Aabb::from_min_max(Vec3::new(-2.5, -0.5, -2.0), Vec3::new(2.0, 3.5, 2.0));
    let buffer = SmokeBuffer { buffer, count: 40, bounds };
    host.app.world_mut().entity_mut(smoke).remove::<SmokeParticles>().insert(buffer);
    let decibels = host.picture().psnr(&slice, &seen);
    println!("{decibels:.1} dB");
    assert!(count(&seen) > 1000 && decibels > 35.0, "{decibels}");
}

#[test]
fn a_fire_lights_meshes() {
    let mut host = host("assets".as_ref());
    let camera = host.camera();
    host.app.world_mut().entity_mut(camera).insert(bevy::camera::Exposure::default());
    let smoke = host.smoke();
    let fire = host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(SmokeAsset::builtin("campfire").unwrap());
    let world = host.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(12.0, 0.2, 12.0));
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
    world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(0.0, -0.2, 0.0)));
    world.entity_mut(smoke).insert(Smoke::from(fire));
    let dark = host.picture();
    let light = host.app.world_mut().spawn((SmokeFireLight::default(), ChildOf(smoke))).id();
    let lit = host.picture();
    // Ground at the lower edge, in front of the flames.
    let ground: Vec<_> = (0..dark.pixels.len()).map(|index| index > dark.pixels.len() * 9 / 10).collect();
    println!("{} {}", dark.mean(&ground), lit.mean(&ground));
    assert!(lit.mean(&ground) > 2.0 * dark.mean(&ground));
    // The flames are as bright as before: their light is not counted twice. The upper half shows no ground.
    let flames = |picture: &Picture| picture.pixels[..dark.pixels.len() / 2].to_vec();
    let brightest = |picture: &Picture| flames(picture).iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
    println!("{} {}", brightest(&dark), brightest(&lit));
    assert!((brightest(&lit) / brightest(&dark) - 1.0).abs() < 0.1);
    host.app.world_mut().entity_mut(smoke).remove::<Smoke>();
    host.update(2);
    assert!(host.app.world().get::<PointLight>(light).unwrap().intensity < 1e-3);
}

#[test]
fn lights_and_exposure_light_the_smoke() {
    let mut host = host("assets".as_ref());
    let camera = host.camera();
    let smoke = host.smoke();
    host.lights();
    let (lit, seen) = mask(&mut host, smoke);
    host.app.world_mut().entity_mut(camera).insert(bevy::camera::Exposure { ev100: 8.0 });
    let (darker, _) = mask(&mut host, smoke);
    let ratio = darker.mean(&seen) / lit.mean(&seen);
    // One stop, but for background and soft scatter, which are not exposed.
    assert!((0.48..0.75).contains(&ratio), "{ratio}");
    // Lights of other layers do not shine here.
    let lights: Vec<_> = host
        .app
        .world_mut()
        .query_filtered::<Entity, Or<(With<PointLight>, With<SpotLight>)>>()
        .iter(host.app.world())
        .collect();
    for light in &lights {
        host.app.world_mut().entity_mut(*light).insert(RenderLayers::layer(2));
    }
    let (dark, _) = mask(&mut host, smoke);
    assert!(dark.mean(&seen) < 0.7 * darker.mean(&seen), "{} {}", dark.mean(&seen), darker.mean(&seen));
}

#[test]
fn smoke_is_sorted_among_transparent_meshes() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let pane = |host: &mut Host, z: f32| {
        let world = host.app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Rectangle::new(20.0, 20.0));
        let red = Color::linear_rgba(0.8, 0.0, 0.0, 0.9);
        let material = StandardMaterial { base_color: red, unlit: true, alpha_mode: AlphaMode::Blend, ..default() };
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(0.0, 1.5, z))).id()
    };
    for tonemapping in [Tonemapping::None, Tonemapping::Reinhard] {
        if tonemapping != Tonemapping::None {
            host.app.world_mut().entity_mut(camera).remove::<Hdr>().insert(tonemapping);
        }
        let mut smoke_light = |z: f32| {
            let pane = pane(&mut host, z);
            let (picture, seen) = mask(&mut host, smoke);
            host.app.world_mut().despawn(pane);
            // Green: the pane has none.
            let pixels = picture.pixels.iter().zip(&seen).filter(|(_, seen)| **seen).map(|([_, green, ..], _)| *green);
            let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), green| (sum + green, count + 1.0));
            sum / count
        };
        let behind_pane = smoke_light(3.0);
        let before_pane = smoke_light(-3.0);
        println!("{tonemapping:?}: {behind_pane} {before_pane}");
        // Through the pane comes a tenth of the light of the smoke.
        assert!(before_pane > 0.1 && behind_pane < 0.2 * before_pane, "{behind_pane} {before_pane}");
    }
}

#[test]
fn invalid_settings_hide_their_own_smoke_only() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    let (plain, seen) = mask(&mut host, smoke);
    let mut invalid = SmokeAsset::builtin("column").unwrap();
    invalid.systems[0].preset.settings.boost = -1.0;
    let invalid = host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(invalid);
    for _ in 0..2 {
        host.app.world_mut().spawn((Smoke::from(invalid.clone()), Transform::from_xyz(-1.0, 0.0, 0.0)));
    }
    let decibels = host.picture().psnr(&plain, &seen);
    assert!(decibels > 60.0, "{decibels}");
}

/// Errors of one entity leave the others alone.
#[test]
fn odd_transforms_do_no_harm() {
    let mut host = host("assets".as_ref());
    let [_, smoke] = host.scene();
    // Without shadow of smoke on smoke, whose grid spans all systems.
    for (_, asset) in host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().iter_mut() {
        asset.systems[0].preset.settings.shadow.strength = 0.0;
    }
    let (plain, seen) = mask(&mut host, smoke);
    for scale in [Vec3::ZERO, Vec3::NAN, Vec3::splat(1e-30), Vec3::splat(-1.0)] {
        let other = host.smoke();
        let asset = host.app.world().get::<Smoke>(smoke).cloned().unwrap();
        host.app.world_mut().entity_mut(other).insert(asset);
        let far = Transform::from_xyz(-500.0, 0.0, 0.0).with_scale(scale);
        host.app.world_mut().entity_mut(other).insert(far);
        let decibels = host.picture().psnr(&plain, &seen);
        assert!(decibels > 40.0, "{scale}: {decibels}");
        host.app.world_mut().despawn(other);
    }
}
