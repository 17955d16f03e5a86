//! Light from environment maps: of the camera, of reflection probes, and of maps that Bevy generates on the GPU.

use bevy::asset::RenderAssetUsages;
use bevy::camera::ScalingMode;
use bevy::light::{EnvironmentMapLight, GeneratedEnvironmentMapLight, LightProbe, NotShadowCaster};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension, WgpuFeatures,
};
use bevy::render::renderer::RenderDevice;
use bevy_haze::haze::glam;
use bevy_haze::haze::ramp::Ramp;
use bevy_haze::haze::sprite::Sprite;
use bevy_haze::{Smoke, SmokeAsset, SmokeClock, SmokeParticle, SmokeParticles};

use crate::host::{Host, SIZE, host};
use crate::picture::Picture;

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const BLUE: [f32; 3] = [0.0, 0.0, 1.0];
/// Light of a value of 1 in a map, cd/m²: half of white at the exposure of the tests.
const INTENSITY: f32 = 75.0;
/// Height of the camera's center: of both balls.
const HEIGHT: f32 = 1.6;
const PLACES: [f32; 2] = [-1.0, 1.6];
const RADIUS: f32 = 0.9;
/// Height of the camera's view, metres.
const VIEW_HEIGHT: f32 = 4.0;

/// A ball of smoke on the left and a white matte sphere on the right, without lamps and ambient light.
fn balls() -> (Host, [Entity; 2]) {
    let mut host = host("assets".as_ref());
    let camera = host.camera();
    host.app.insert_resource(GlobalAmbientLight { brightness: 0.0, ..default() });
    host.app.insert_resource(ClearColor(Color::BLACK));
    let world = host.app.world_mut();
    // Without perspective, both balls are seen from the same side.
    let scaling_mode = ScalingMode::FixedVertical { viewport_height: VIEW_HEIGHT };
    let projection = OrthographicProjection { scaling_mode, ..OrthographicProjection::default_3d() };
    world.entity_mut(camera).insert((Transform::from_xyz(0.0, HEIGHT, 7.0), Projection::Orthographic(projection)));
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(RADIUS).mesh().uv(64, 32));
    let matte = StandardMaterial { perceptual_roughness: 1.0, reflectance: 0.0, ..default() };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(matte);
    world.spawn((Mesh3d(mesh), MeshMaterial3d(material), Transform::from_xyz(PLACES[1], HEIGHT, 0.0)));
    let smoke = world.resource_mut::<Assets<SmokeAsset>>().add(matte_smoke());
    let puff = SmokeParticle { radius: RADIUS, amount: 1.0, ..default() };
    let at = Transform::from_xyz(PLACES[0], HEIGHT, 0.0);
    let parts = (Smoke::from(smoke), SmokeParticles::new([puff; 3]), SmokeClock::paused_at(0.0), NotShadowCaster, at);
    let smoke = world.spawn(parts).id();
    (host, [camera, smoke])
}

/// Smoke as white and matte as the sphere: a sprite with the normals of a ball, opaque, under Lambert's cosine.
fn matte_smoke() -> SmokeAsset {
    let mut asset = SmokeAsset::builtin("column").unwrap();
    let system = &mut asset.systems[0];
    let size = 64_u32;
    let texel = |index: u32| {
        let at = glam::Vec2::new((index % size) as f32 + 0.5, (index / size) as f32 + 0.5) * (2.0 / size as f32) - 1.0;
        let normal = glam::Vec3::new(at.x, -at.y, (1.0 - at.length_squared()).max(0.0).sqrt()).normalize();
        let [x, y, z] = (0.5 * normal + 0.5).to_array().map(|value| (value * 255.0).round() as u8);
        [x, y, z, if at.length() < 0.95 { 255 } else { 0 }]
    };
    system.images.sprite = Sprite::with_levels(size, 1, (0..size * size).map(texel).collect());
    let lambert = |index: u32| glam::Vec3::splat((2.0 * (index as f32 + 0.5) / 256.0 - 1.0).max(0.0));
    system.images.detail = None;
    system.images.six_way = None;
    system.images.diffuse_ramp = Ramp::from_linear(glam::UVec2::new(256, 1), (0..256).map(lambert));
    let settings = &mut system.preset.settings;
    *settings = Default::default();
    settings.accumulate.downscale = 1;
    settings.soft_scatter.intensity = 0.0;
    asset
}

/// Mean color of a disc on a ball, at this fraction of its radius above its center.
fn color(picture: &Picture, ball: usize, above: f32) -> [f32; 3] {
    let pixels_per_metre = SIZE.y as f32 / VIEW_HEIGHT;
    let right = 0.5 * SIZE.x as f32 + PLACES[ball] * pixels_per_metre;
    let center = Vec2::new(right, 0.5 * SIZE.y as f32 - above * RADIUS * pixels_per_metre);
    let position = |index: usize| Vec2::new((index as u32 % SIZE.x) as f32 + 0.5, (index as u32 / SIZE.x) as f32 + 0.5);
    let is_inside = |index: &usize| position(*index).distance(center) < 0.15 * RADIUS * pixels_per_metre;
    let pixels: Vec<_> = (0..picture.pixels.len()).filter(is_inside).map(|index| picture.pixels[index]).collect();
    assert!(pixels.len() > 20, "{}", pixels.len());
    [0, 1, 2].map(|channel| pixels.iter().map(|pixel| pixel[channel]).sum::<f32>() / pixels.len() as f32)
}

/// Asserts that smoke and sphere are alike from top to bottom. `tolerance`: of each color, as a fraction of the brightest.
fn assert_alike(picture: &Picture, tolerance: f32) {
    let heights = [0.7, 0.35, 0.0, -0.35, -0.7];
    let pairs = heights.map(|above| [color(picture, 0, above), color(picture, 1, above)]);
    let brightest = pairs.iter().flat_map(|[_, sphere]| *sphere).fold(0.0, f32::max);
    println!("{pairs:.3?}");
    assert!(brightest > 0.1, "the sphere is dark: {brightest}");
    for [smoke, sphere] in pairs {
        for channel in 0..3 {
            let difference = (smoke[channel] - sphere[channel]).abs();
            assert!(difference <= tolerance * brightest, "{smoke:?} {sphere:?}");
        }
    }
}

/// Diffuse map of a red sky and a blue ground: the light of each normal, 16 texels a side.
fn red_above_blue_below() -> Image {
    let size = 16_u32;
    let texel = |index: u32| {
        let face = index / (size * size);
        let u = index % size;
        let v = index / size % size;
        let at = |position: u32| 2.0 * (position as f32 + 0.5) / size as f32 - 1.0;
        let u = at(u);
        let v = at(v);
        let up = match face {
            2 => 1.0,
            3 => -1.0,
            _ => -v,
        };
        let fraction = 0.5 + 0.5 * up / (1.0 + u * u + v * v).sqrt();
        [0, 1, 2].map(|channel| RED[channel] * fraction + BLUE[channel] * (1.0 - fraction))
    };
    cube_map(size, TextureFormat::Rgba16Float, (0..6 * size * size).map(texel))
}

fn cube_map(size: u32, format: TextureFormat, texels: impl Iterator<Item = [f32; 3]>) -> Image {
    let halves = texels.flat_map(|[r, g, b]| [r, g, b, 1.0]).map(half::f16::from_f32);
    let data = halves.flat_map(half::f16::to_le_bytes).collect();
    let extent = Extent3d { width: size, height: size, depth_or_array_layers: 6 };
    // Bevy drops the texels once they are on the GPU.
    let mut image = Image::new(extent, TextureDimension::D2, data, format, RenderAssetUsages::RENDER_WORLD);
    let dimension = Some(TextureViewDimension::Cube);
    image.texture_view_descriptor = Some(TextureViewDescriptor { dimension, ..default() });
    image
}

fn environment(host: &mut Host, map: Image) -> EnvironmentMapLight {
    let map = host.app.world_mut().resource_mut::<Assets<Image>>().add(map);
    EnvironmentMapLight { diffuse_map: map.clone(), specular_map: map, intensity: INTENSITY, ..default() }
}

#[test]
fn smoke_under_an_environment_map_is_as_bright_as_a_white_sphere() {
    let (mut host, [camera, _]) = balls();
    let dark = host.picture();
    assert!(color(&dark, 0, 0.0).iter().sum::<f32>() < 0.01);
    let light = environment(&mut host, red_above_blue_below());
    host.app.world_mut().entity_mut(camera).insert(light.clone());
    let picture = host.picture();
    let [red, _, blue] = color(&picture, 0, 0.7);
    let [low_red, _, low_blue] = color(&picture, 0, -0.7);
    assert!(red > 4.0 * blue && low_blue > 4.0 * low_red, "{red} {blue}, {low_red} {low_blue}");
    // Normals are in bytes, and interpolated. Measured: 0.7 %.
    assert_alike(&picture, 0.02);
    // Upside down, and twice as bright.
    let turned = EnvironmentMapLight { rotation: Quat::from_rotation_z(3.0), intensity: 2.0 * INTENSITY, ..light };
    host.app.world_mut().entity_mut(camera).insert(turned);
    let picture = host.picture();
    let [red, _, blue] = color(&picture, 0, 0.7);
    assert!(blue > 4.0 * red, "{red} {blue}");
    // The map is 8° from upside down: haze's ambient light lacks the sideways part, sin(8°) ÷ 2 of the light.
    assert_alike(&picture, 0.09);
}

#[test]
fn a_bright_horizon_is_shared_by_both_hemispheres() {
    let (mut host, [camera, _]) = balls();
    let [top, middle, bottom] = [[0.1, 0.2, 0.6], [0.9, 0.6, 0.4], [0.1, 0.08, 0.06]];
    let [top, middle, bottom] = [top, middle, bottom].map(|[r, g, b]| Color::linear_rgb(r, g, b));
    let mut images = host.app.world_mut().resource_mut::<Assets<Image>>();
    let light = EnvironmentMapLight::hemispherical_gradient(&mut images, top, middle, bottom).with_intensity(INTENSITY);
    host.app.world_mut().entity_mut(camera).insert(light);
    // Not linear in the normal: the closest light of two hemispheres is too dark at the horizon and too bright at the poles.
    assert_alike(&host.picture(), 0.3);
}

#[test]
fn changed_maps_are_measured_again() {
    let (mut host, [camera, _]) = balls();
    let light = environment(&mut host, red_above_blue_below());
    host.app.world_mut().entity_mut(camera).insert(light.clone());
    assert_alike(&host.picture(), 0.02);
    let green = cube_map(16, TextureFormat::Rgba16Float, (0..6 * 256).map(|_| [0.0, 0.6, 0.0]));
    host.app.world_mut().resource_mut::<Assets<Image>>().insert(&light.diffuse_map, green).unwrap();
    let picture = host.picture();
    assert!(color(&picture, 0, 0.7)[0] < 0.01);
    assert_alike(&picture, 0.02);
}

#[test]
fn a_reflection_probe_lights_the_smoke_inside_it() {
    let (mut host, [camera, _]) = balls();
    let light = environment(&mut host, red_above_blue_below());
    // Turned, so that the probe's rotation matters.
    let at = Transform::from_xyz(0.0, HEIGHT, 0.0)
        .with_rotation(Quat::from_rotation_x(std::f32::consts::PI))
        .with_scale(Vec3::splat(8.0));
    let probe = host.app.world_mut().spawn((LightProbe::new(), light, at)).id();
    let picture = host.picture();
    let [red, _, blue] = color(&picture, 0, 0.7);
    assert!(blue > 4.0 * red, "{red} {blue}");
    // Without arrays of textures, Bevy's meshes see no probe.
    let device = host.app.sub_app(RenderApp).world().resource::<RenderDevice>();
    if device.features().contains(WgpuFeatures::TEXTURE_BINDING_ARRAY) {
        assert_alike(&picture, 0.02);
    }
    // Smoke outside takes the camera's map.
    let green = environment(&mut host, cube_map(1, TextureFormat::Rgba16Float, [[0.0, 0.5, 0.0]; 6].into_iter()));
    host.app.world_mut().entity_mut(camera).insert(green);
    let inside = color(&host.picture(), 0, 0.0);
    let away = Transform::from_xyz(20.0, 0.0, 0.0);
    host.app.world_mut().entity_mut(probe).insert(away);
    let picture = host.picture();
    let outside = color(&picture, 0, 0.0);
    assert!(inside[1] < 0.01 && outside[1] > 0.1 && outside[0] < 0.01, "{inside:?} {outside:?}");
    assert_alike(&picture, 0.02);
}

#[test]
fn a_map_that_bevy_generates_lights_smoke() {
    let (mut host, [camera, _]) = balls();
    // Light of a sky and a ground, not yet that of normals. Bevy filters it on the GPU.
    let sky = |index: u32| {
        if index / (64 * 64) == 2 || (index / (64 * 64) != 3 && index / 64 % 64 < 32) { RED } else { BLUE }
    };
    let source = cube_map(64, TextureFormat::Rgba16Float, (0..6 * 64 * 64).map(sky));
    let environment_map = host.app.world_mut().resource_mut::<Assets<Image>>().add(source);
    let light = GeneratedEnvironmentMapLight { environment_map, intensity: INTENSITY, ..default() };
    host.app.world_mut().entity_mut(camera).insert(light);
    // In Bevy's first frames, the map is empty; it is measured again every few frames.
    host.update(30);
    // Bevy's filter has noise.
    assert_alike(&host.picture(), 0.03);
}
