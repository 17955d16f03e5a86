//! Shadows of meshes on smoke, by the shadow maps of every kind of light, and of smoke on meshes.

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::NotShadowCaster;
use bevy::prelude::*;

use crate::host::{Host, SIZE, host};
use crate::picture::{Picture, count};

/// Light from the left over the top of a wall: the lower part of the smoke is in its shadow.
fn light(host: &mut Host, kind: usize) -> Entity {
    let at = Transform::from_xyz(-6.0, 2.2, 0.0).looking_at(Vec3::new(0.0, 1.6, 0.0), Vec3::Y);
    let intensity = 400_000.0;
    let range = 40.0;
    let shadow_maps_enabled = true;
    let world = host.app.world_mut();
    match kind {
        0 => world.spawn((PointLight { intensity, range, shadow_maps_enabled, ..default() }, at)).id(),
        1 => world.spawn((SpotLight { intensity, range, shadow_maps_enabled, ..default() }, at)).id(),
        _ => world.spawn((DirectionalLight { illuminance: 900.0, shadow_maps_enabled, ..default() }, at)).id(),
    }
}

/// Mean light of the smoke in the upper and in the lower half of the picture.
fn halves(picture: &Picture, mask: &[bool]) -> [f32; 2] {
    let row = |index: usize| index as u32 / SIZE.x;
    let upper: Vec<_> = mask.iter().enumerate().map(|(index, seen)| *seen && row(index) < SIZE.y * 2 / 5).collect();
    let lower: Vec<_> = mask.iter().enumerate().map(|(index, seen)| *seen && row(index) > SIZE.y / 2).collect();
    [picture.mean(&upper), picture.mean(&lower)]
}

#[test]
fn a_wall_shades_smoke_under_every_kind_of_light() {
    let mut host = host("assets".as_ref());
    host.camera();
    host.app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..default() });
    let world = host.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(0.2, 4.0, 12.0));
    let black = StandardMaterial { base_color: Color::BLACK, unlit: true, ..default() };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(black);
    let wall = (Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(-4.2, 0.05, 0.0), NotShadowCaster);
    let wall = world.spawn(wall).id();
    let empty = host.picture();
    host.smoke();
    // Faint lights that come first take the first layers.
    for kind in 0..3 {
        let other = light(&mut host, kind);
        let mut other = host.app.world_mut().entity_mut(other);
        other.insert(Transform::from_xyz(2.0, 4.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y));
        if let Some(mut point) = other.get_mut::<PointLight>() {
            point.intensity = 1.0;
        }
        if let Some(mut spot) = other.get_mut::<SpotLight>() {
            spot.intensity = 1.0;
        }
        if let Some(mut sun) = other.get_mut::<DirectionalLight>() {
            sun.illuminance = 0.001;
        }
    }
    for (kind, name) in ["point", "spot", "directional"].into_iter().enumerate() {
        let lamp = light(&mut host, kind);
        host.app.world_mut().entity_mut(wall).insert(NotShadowCaster);
        let lit = host.picture();
        host.app.world_mut().entity_mut(wall).remove::<NotShadowCaster>();
        let shaded = host.picture();
        let mask = lit.mask_of_difference(&empty);
        let [upper_lit, lower_lit] = halves(&lit, &mask);
        let [upper, lower] = halves(&shaded, &mask);
        println!("{name}: above the wall's shadow {upper_lit} {upper}, in it {lower_lit} {lower}");
        assert!(upper > 0.9 * upper_lit && lower < 0.6 * lower_lit, "{name}");
        host.app.world_mut().despawn(lamp);
    }
}

#[test]
fn smoke_shades_meshes() {
    let mut host = host("assets".as_ref());
    let camera = host.camera();
    let world = host.app.world_mut();
    world.insert_resource(GlobalAmbientLight { brightness: 40.0, ..default() });
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Plane3d::new(Vec3::Y, Vec2::splat(8.0)));
    let material = StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(0.0, -0.2, 0.0)));
    let at = Transform::from_xyz(-6.0, 5.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((DirectionalLight { illuminance: 900.0, shadow_maps_enabled: true, ..default() }, at));
    let smoke = host.smoke();
    // Without Hdr, Bevy tonemaps in the shader of each mesh.
    for (msaa, hdr) in [(Msaa::Off, true), (Msaa::Sample4, true), (Msaa::Off, false), (Msaa::Sample4, false)] {
        let mut camera = host.app.world_mut().entity_mut(camera);
        camera.insert((msaa, Tonemapping::Reinhard));
        if !hdr {
            camera.remove::<Hdr>();
        }
        host.app.world_mut().entity_mut(smoke).insert(NotShadowCaster);
        let lit = host.picture();
        host.app.world_mut().entity_mut(smoke).remove::<NotShadowCaster>();
        let shaded = host.picture();
        let mask = lit.mask_of_difference(&shaded);
        // Right of the smoke, on the ground.
        let fraction = shaded.mean(&mask) / lit.mean(&mask);
        let [x, y] = lit.center(&mask);
        println!("{msaa:?}, HDR {hdr}: {fraction} of the light at {} pixels around {x} {y}", count(&mask));
        assert!(count(&mask) > 200 && fraction < 0.85 && fraction > 0.1, "{msaa:?}: {fraction}");
        assert!(x > SIZE.x as f32 * 0.5, "{msaa:?}: {x}");
    }
}
