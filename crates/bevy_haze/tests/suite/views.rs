//! Smoke in every kind of view.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Hdr, RenderTarget, ScalingMode, Viewport};
use bevy::core_pipeline::oit::OrderIndependentTransparencySettings;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::view::Msaa;
use bevy_haze::{Smoke, SmokeAsset};

use crate::host::{CAMERA, Host, SIZE, TARGET, host};
use crate::picture::{Picture, count};

/// Picture with smoke, and the pixels that the smoke changes.
fn smoke_and_mask(host: &mut Host, smoke: Entity) -> (Picture, Vec<bool>) {
    let picture = host.picture();
    host.app.world_mut().entity_mut(smoke).insert(Visibility::Hidden);
    let empty = host.picture();
    host.app.world_mut().entity_mut(smoke).insert(Visibility::Inherited);
    let mask = picture.mask_of_difference(&empty);
    (picture, mask)
}

#[test]
fn multisampling_changes_edges_only() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let (single, mask) = smoke_and_mask(&mut host, smoke);
    for msaa in [Msaa::Sample2, Msaa::Sample4, Msaa::Sample8] {
        if !host.supports(msaa) {
            println!("{msaa:?}: not supported by this device");
            continue;
        }
        host.app.world_mut().entity_mut(camera).insert(msaa);
        let decibels = host.picture().psnr(&single, &mask);
        println!("{msaa:?}: {decibels:.1} dB");
        // Edges of boxes in front of smoke are smooth with more samples.
        assert!(decibels > 30.0, "{msaa:?}: {decibels}");
    }
}

#[test]
fn without_hdr_smoke_is_tonemapped_as_with_it() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    // Bevy does not tonemap the background without Hdr; black is black in both.
    host.app.insert_resource(ClearColor(Color::BLACK));
    let curves = [
        // Without a curve, and under a linear one, both are exact but for the rounding of half floats.
        (Tonemapping::None, 50.0),
        (Tonemapping::Linear, 50.0),
        // A curve of a sum is not the sum of curves, as with Bevy's own transparent meshes.
        (Tonemapping::Reinhard, 30.0),
        (Tonemapping::AcesFitted, 30.0),
        (Tonemapping::AgX, 30.0),
        (Tonemapping::TonyMcMapface, 30.0),
        (Tonemapping::KhronosPbrNeutral, 30.0),
    ];
    let mask = smoke_and_mask(&mut host, smoke).1;
    for (tonemapping, least) in curves {
        let multisampled = tonemapping == Tonemapping::Reinhard;
        for msaa in [Msaa::Off, Msaa::Sample4].into_iter().take(if multisampled { 2 } else { 1 }) {
            host.app.world_mut().entity_mut(camera).insert((tonemapping, msaa, Hdr));
            let high = host.picture();
            host.app.world_mut().entity_mut(camera).remove::<Hdr>();
            let decibels = host.picture().psnr(&high, &mask);
            println!("{tonemapping:?} {msaa:?}: {decibels:.1} dB");
            assert!(decibels > least, "{tonemapping:?} {msaa:?}: {decibels}");
        }
    }
}

#[test]
fn a_split_screen_shows_smoke_on_both_sides_and_nowhere_else() {
    let mut host = host("assets".as_ref());
    let [left, smoke] = host.scene();
    let half = UVec2::new(SIZE.x / 2, SIZE.y);
    let part = |x| Some(Viewport { physical_position: UVec2::new(x, 0), physical_size: half, ..default() });
    let world = host.app.world_mut();
    let target: RenderTarget = world.get::<RenderTarget>(left).unwrap().clone();
    world.get_mut::<Camera>(left).unwrap().viewport = part(0);
    let camera = Camera { order: 1, viewport: part(half.x), clear_color: ClearColorConfig::None, ..default() };
    let from_the_side = Transform::from_xyz(-7.0, 2.0, 1.0).looking_at(TARGET, Vec3::Y);
    for (hdr, msaa) in [(true, Msaa::Off), (true, Msaa::Sample4), (false, Msaa::Off), (false, Msaa::Sample4)] {
        let world = host.app.world_mut();
        let right = world.spawn((
            Camera3d::default(),
            camera.clone(),
            target.clone(),
            from_the_side,
            msaa,
            crate::host::EXPOSURE,
        ));
        let right = right.id();
        for camera in [left, right] {
            world.entity_mut(camera).insert((Tonemapping::Reinhard, msaa));
            if hdr {
                world.entity_mut(camera).insert(Hdr);
            } else {
                world.entity_mut(camera).remove::<Hdr>();
            }
        }
        let (_, mask) = smoke_and_mask(&mut host, smoke);
        let side = |right: bool| {
            let pixels = mask.iter().enumerate();
            pixels.filter(|(index, changed)| **changed && (*index as u32 % SIZE.x >= half.x) == right).count()
        };
        println!("{hdr} {msaa:?}: {} {}", side(false), side(true));
        assert!(side(false) > 500 && side(true) > 500, "{hdr} {msaa:?}: {} {}", side(false), side(true));
        host.app.world_mut().despawn(right);
    }
}

#[test]
fn a_scaled_camera_sees_the_same() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let (plain, mask) = smoke_and_mask(&mut host, smoke);
    let scaled = Transform::from_translation(CAMERA).looking_at(TARGET, Vec3::Y).with_scale(Vec3::splat(3.0));
    host.app.world_mut().entity_mut(camera).insert(scaled);
    let decibels = host.picture().psnr(&plain, &mask);
    println!("{decibels:.1} dB");
    // The near plane is three times as far away.
    assert!(decibels > 50.0, "{decibels}");
}

#[test]
fn a_mirrored_camera_sees_the_mirror_image() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    // Sprites turn with the world, not with the picture: their grain is another.
    for (_, asset) in host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().iter_mut() {
        asset.systems[0].preset.settings.grain = Default::default();
    }
    let (plain, mask) = smoke_and_mask(&mut host, smoke);
    let mirrored =
        Transform::from_translation(CAMERA).looking_at(TARGET, Vec3::Y).with_scale(Vec3::new(-1.0, 1.0, 1.0));
    let world = host.app.world_mut();
    world.entity_mut(camera).insert(mirrored);
    world.get_mut::<Camera>(camera).unwrap().invert_culling = true;
    let mut seen = host.picture();
    let pixels: Vec<_> = seen.pixels.chunks(SIZE.x as usize).flat_map(|row| row.iter().rev().copied()).collect();
    seen.pixels = pixels;
    let decibels = seen.psnr(&plain, &mask);
    println!("{decibels:.1} dB");
    // So do their outlines.
    assert!(decibels > 25.0, "{decibels}");
}

#[test]
fn orthographic_prepass_and_deferred_cameras_show_smoke_behind_the_box() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let (plain, mask) = smoke_and_mask(&mut host, smoke);

    host.app.world_mut().entity_mut(camera).insert(DepthPrepass);
    let decibels = host.picture().psnr(&plain, &mask);
    assert!(decibels > 50.0, "depth prepass: {decibels}");
    host.app.world_mut().entity_mut(camera).insert(DeferredPrepass);
    let decibels = host.picture().psnr(&plain, &mask);
    assert!(decibels > 50.0, "deferred: {decibels}");
    host.app.world_mut().entity_mut(camera).remove::<(DepthPrepass, DeferredPrepass)>();

    let scaling_mode = ScalingMode::FixedVertical { viewport_height: 5.0 };
    let projection = OrthographicProjection { scaling_mode, ..OrthographicProjection::default_3d() };
    host.app.world_mut().entity_mut(camera).insert(Projection::Orthographic(projection));
    let (_, mask) = smoke_and_mask(&mut host, smoke);
    let pixels = count(&mask);
    assert!((2000..20_000).contains(&pixels), "{pixels}");
}

#[test]
fn a_camera_of_other_layers_shows_no_smoke() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let shown = count(&smoke_and_mask(&mut host, smoke).1);
    host.app.world_mut().entity_mut(smoke).insert(RenderLayers::layer(3));
    let hidden = count(&smoke_and_mask(&mut host, smoke).1);
    host.app.world_mut().entity_mut(camera).insert(RenderLayers::from_layers(&[0, 3]));
    let both = count(&smoke_and_mask(&mut host, smoke).1);
    assert!(shown > 1000 && hidden == 0 && both == shown, "{shown} {hidden} {both}");
}

#[test]
fn two_cameras_draw_into_images_of_their_own() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let (plain, mask) = smoke_and_mask(&mut host, smoke);
    let other = host.new_target();
    let transform = *host.app.world().get::<Transform>(camera).unwrap();
    let second = (Camera3d::default(), Camera { order: -1, ..default() }, RenderTarget::Image(other.into()), transform);
    host.app.world_mut().spawn(second);
    let again = host.picture();
    let decibels = again.psnr(&plain, &mask);
    assert!(decibels > 60.0, "{decibels}");
}

#[test]
fn order_independent_transparency_and_jitter_keep_smoke() {
    let mut host = host("assets".as_ref());
    let [camera, smoke] = host.scene();
    let (plain, mask) = smoke_and_mask(&mut host, smoke);
    host.app.world_mut().entity_mut(camera).insert(OrderIndependentTransparencySettings::default());
    let decibels = host.picture().psnr(&plain, &mask);
    println!("{decibels:.1} dB");
    assert!(decibels > 50.0, "order-independent: {decibels}");
    host.app.world_mut().entity_mut(camera).remove::<OrderIndependentTransparencySettings>();
    // A jitter of a whole pixel shifts smoke and boxes alike.
    host.app.world_mut().entity_mut(camera).insert(TemporalJitter { offset: Vec2::new(1.0, 0.0) });
    let mut jittered = host.picture();
    let pixels = jittered.pixels.clone();
    let decibels = [-1, 1].map(|shift| {
        let from = |index: usize| (index as i64 + shift).clamp(0, pixels.len() as i64 - 1) as usize;
        jittered.pixels = (0..pixels.len()).map(|index| pixels[from(index)]).collect();
        jittered.psnr(&plain, &mask)
    });
    println!("jitter: {decibels:?}");
    assert!(decibels[0].max(decibels[1]) > 40.0);
}

#[test]
fn fire_is_drawn_alike_in_both_ways() {
    let mut host = host("assets".as_ref());
    let camera = host.camera();
    host.boxes();
    let smoke = host.smoke();
    let fire = host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(SmokeAsset::builtin("campfire").unwrap());
    host.app.world_mut().entity_mut(smoke).insert(Smoke::from(fire));
    let (direct, mask) = smoke_and_mask(&mut host, smoke);
    host.app.world_mut().entity_mut(camera).remove::<Hdr>().insert(Tonemapping::Linear);
    let decibels = host.picture().psnr(&direct, &mask);
    println!("{decibels:.1} dB");
    assert!(decibels > 50.0, "{decibels}");
}
