//! Scenes made by code: the example of the documents, and damaged files.

mod gltf;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::{Quat, UVec2, Vec2, Vec3};
use haze_core::frame::LightKind;
use haze_preset::{AssetFolders, Preset};
use image::{ImageEncoder as _, Rgb};

use super::*;

/// Writer of a binary glTF file.
#[derive(Default)]
struct Glb {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    meshes: Vec<String>,
    nodes: Vec<String>,
    images: Vec<String>,
    materials: Vec<String>,
    textures: Vec<String>,
}

impl Glb {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        let length = bytes.len();
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, more: &str) -> usize {
        let view = self.view(bytes);
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"{more}}}"#
        ));
        self.accessors.len() - 1
    }

    fn mesh(&mut self, material: usize, corners: &[(Vec3, Vec3, Vec2)], indices: &[u16]) -> usize {
        let count = corners.len();
        let (min, max) = corners.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), (position, ..)| {
            (min.min(*position), max.max(*position))
        });
        let bounds = format!(r#","min":{:?},"max":{:?}"#, min.to_array(), max.to_array());
        let positions: Vec<_> = corners.iter().map(|corner| corner.0).collect();
        let normals: Vec<_> = corners.iter().map(|corner| corner.1).collect();
        let uvs: Vec<_> = corners.iter().map(|corner| corner.2).collect();
        let position = self.accessor(bytemuck::cast_slice(&positions), 5126, "VEC3", count, &bounds);
        let normal = self.accessor(bytemuck::cast_slice(&normals), 5126, "VEC3", count, "");
        let uv = self.accessor(bytemuck::cast_slice(&uvs), 5126, "VEC2", count, "");
        let index = self.accessor(bytemuck::cast_slice(indices), 5123, "SCALAR", indices.len(), "");
        self.meshes.push(format!(
            r#"{{"primitives":[{{"attributes":{{"POSITION":{position},"NORMAL":{normal},"TEXCOORD_0":{uv}}},"indices":{index},"material":{material}}}]}}"#
        ));
        self.meshes.len() - 1
    }

    fn node(&mut self, name: &str, more: &str) {
        self.nodes.push(format!(r#"{{"name":"{name}",{more}}}"#));
    }

    /// A mesh at a position, turned about the vertical axis, degrees.
    fn place(&mut self, name: &str, mesh: usize, at: Vec3, turn: f32, scale: Vec3) {
        let rotation = Quat::from_rotation_y(turn.to_radians()).to_array();
        let more = format!(
            r#""mesh":{mesh},"translation":{:?},"rotation":{rotation:?},"scale":{:?}"#,
            at.to_array(),
            scale.to_array()
        );
        self.node(name, &more);
    }

    fn texture(&mut self, size: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> usize {
        let pixels: Vec<u8> = (0..size * size).flat_map(|index| texel(index % size, index / size)).collect();
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        encoder.write_image(&pixels, size, size, image::ExtendedColorType::Rgba8).unwrap();
        let view = self.view(&png);
        self.images.push(format!(r#"{{"bufferView":{view},"mimeType":"image/png"}}"#));
        self.textures.push(format!(r#"{{"source":{}}}"#, self.images.len() - 1));
        self.textures.len() - 1
    }

    fn material(&mut self, color: [f32; 3], texture: Option<usize>, more: &str) -> usize {
        let [red, green, blue] = color;
        let mut pbr = format!(r#""baseColorFactor":[{red},{green},{blue},1.0]"#);
        if let Some(texture) = texture {
            write!(pbr, r#","baseColorTexture":{{"index":{texture}}}"#).unwrap();
        }
        self.materials.push(format!(r#"{{"pbrMetallicRoughness":{{{pbr}}}{more}}}"#));
        self.materials.len() - 1
    }

    /// The file. `more`: cameras and lights.
    fn finish(mut self, more: &str) -> Vec<u8> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let list = |items: &[String]| items.join(",");
        let roots: Vec<_> = (0..self.nodes.len()).map(|node| node.to_string()).collect();
        let mut json = format!(
            r#"{{"asset":{{"version":"2.0","generator":"haze"}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"materials":[{}],"textures":[{}],"images":[{}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]{more}}}"#,
            roots.join(","),
            list(&self.nodes),
            list(&self.meshes),
            list(&self.materials),
            list(&self.textures),
            list(&self.images),
            list(&self.accessors),
            list(&self.views),
            self.bytes.len(),
        );
        while json.len() % 4 != 0 {
            json.push(' ');
        }
        glb(json.as_bytes(), &self.bytes)
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction }
}

fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut file = b"glTF".to_vec();
    let word = |value: usize| (value as u32).to_le_bytes();
    file.extend([2_usize, 12 + 8 + json.len() + 8 + binary.len()].map(word).into_iter().flatten());
    file.extend(word(json.len()).into_iter().chain(*b"JSON"));
    file.extend_from_slice(json);
    file.extend(word(binary.len()).into_iter().chain(*b"BIN\0"));
    file.extend_from_slice(binary);
    file
}

/// Corners of a square of side 1 that faces `normal`, with uv from 0 to `repeats`.
fn square(normal: Vec3, center: Vec3, repeats: f32) -> [(Vec3, Vec3, Vec2); 4] {
    let up = if normal.y.abs() > 0.5 { Vec3::NEG_Z } else { Vec3::Y };
    let right = up.cross(normal);
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
        .map(|(x, y)| (center + right * x + up * y, normal, Vec2::new(x + 0.5, 0.5 - y) * repeats))
}

/// Cube of side 1 that stands on the origin.
fn cube(repeats: f32) -> (Vec<(Vec3, Vec3, Vec2)>, Vec<u16>) {
    let normals = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let corners = normals.iter().flat_map(|&normal| square(normal, 0.5 * normal + 0.5 * Vec3::Y, repeats)).collect();
    (corners, (0..6).flat_map(|face| [0, 1, 2, 0, 2, 3].map(|corner| 4 * face + corner)).collect())
}

/// Sphere of radius 1 around the origin.
fn sphere() -> (Vec<(Vec3, Vec3, Vec2)>, Vec<u16>) {
    const ROWS: u16 = 16;
    let corners = (0..=ROWS).flat_map(|row| {
        (0..=2 * ROWS).map(move |column| {
            let uv = Vec2::new(f32::from(column) / f32::from(2 * ROWS), f32::from(row) / f32::from(ROWS));
            let (down, up) = (uv.y * std::f32::consts::PI).sin_cos();
            let (sin, cos) = (uv.x * std::f32::consts::TAU).sin_cos();
            let normal = Vec3::new(down * cos, up, down * sin);
            (normal, normal, uv)
        })
    });
    let stride = 2 * ROWS + 1;
    let faces = (0..ROWS).flat_map(|row| (0..2 * ROWS).map(move |column| row * stride + column));
    let indices = faces.flat_map(|at| [at, at + 1, at + stride, at + 1, at + stride + 1, at + stride]);
    (corners.collect(), indices.collect())
}

/// Noise of a texture, 0 to 1.
fn noise(x: u32, y: u32, salt: u32) -> f32 {
    haze_core::assets::noise::unit(haze_core::assets::noise::pcg3d(glam::UVec3::new(x, y, salt)).x)
}

/// The example of the documents: a court with an arch, crates, a sphere and a fence that is cut out.
fn court() -> Vec<u8> {
    let mut glb = Glb::default();
    let slabs = glb.texture(64, |x, y| {
        let is_joint = x % 32 < 2 || (y + 16 * (x / 32 % 2)) % 32 < 2;
        let tone = if is_joint { 70.0 } else { 128.0 + 22.0 * noise(x / 32, y / 32, 1) + 22.0 * noise(x, y, 2) };
        [tone as u8, (tone * 0.97) as u8, (tone * 0.92) as u8, 255]
    });
    let planks = glb.texture(64, |x, y| {
        let is_joint = y % 16 == 0;
        let tone = if is_joint { 60.0 } else { 130.0 + 40.0 * noise(x / 16, y, 3) + 20.0 * noise(0, y / 16, 4) };
        [tone as u8, (tone * 0.72) as u8, (tone * 0.45) as u8, 255]
    });
    let pickets = glb.texture(64, |x, y| {
        let is_solid =
            x % 16 < 9 && (y > 6 || x % 16 > 1 && x % 16 < 7) || (18..24).contains(&y) || (46..52).contains(&y);
        [150, 156, 150, if is_solid { 255 } else { 0 }]
    });
    let ground = glb.material([1.0, 1.0, 1.0], Some(slabs), "");
    let stone = glb.material([0.9, 0.82, 0.7], Some(slabs), "");
    let wood = glb.material([1.0, 1.0, 1.0], Some(planks), "");
    let fence = glb.material([1.0, 1.0, 1.0], Some(pickets), r#","alphaMode":"MASK","doubleSided":true"#);
    let clay = glb.material([0.5, 0.16, 0.09], None, "");
    let floor = square(Vec3::Y, Vec3::ZERO, 24.0);
    let floor = glb.mesh(ground, &floor, &[0, 1, 2, 0, 2, 3]);
    let (corners, indices) = cube(2.0);
    let block = glb.mesh(stone, &corners, &indices);
    let (corners, indices) = cube(1.0);
    let crate_ = glb.mesh(wood, &corners, &indices);
    let (corners, indices) = sphere();
    let ball = glb.mesh(clay, &corners, &indices);
    let panel = square(Vec3::Z, 0.5 * Vec3::Y, 1.0);
    let panel = glb.mesh(fence, &panel, &[0, 1, 2, 0, 2, 3]);
    let at = Vec3::new;
    glb.place("floor", floor, Vec3::ZERO, 0.0, at(48.0, 1.0, 48.0));
    glb.place("left pillar", block, at(-2.6, 0.0, -3.0), 0.0, at(0.8, 3.4, 0.8));
    glb.place("right pillar", block, at(2.6, 0.0, -3.0), 0.0, at(0.8, 3.4, 0.8));
    glb.place("beam", block, at(0.0, 3.4, -3.0), 0.0, at(6.4, 0.6, 1.0));
    glb.place("wall", block, at(0.0, 0.0, -7.5), 0.0, at(16.0, 2.2, 0.5));
    glb.place("large crate", crate_, at(-1.7, 0.0, 0.3), 25.0, at(1.0, 1.0, 1.0));
    glb.place("small crate", crate_, at(-1.85, 1.0, 0.25), -15.0, at(0.6, 0.6, 0.6));
    glb.place("ball", ball, at(1.75, 0.6, -0.3), 0.0, at(0.6, 0.6, 0.6));
    glb.place("fence", panel, at(1.7, 0.0, 1.5), -8.0, at(2.6, 1.1, 1.0));
    glb.node("camera", r#""translation":[0.4,1.9,8.2],"rotation":[-0.00872,0.0,0.0,0.99996],"camera":0"#);
    let sun = Quat::from_euler(glam::EulerRot::YXZ, -0.9, -0.75, 0.0).to_array();
    glb.node("sun", &format!(r#""rotation":{sun:?},"extensions":{{"KHR_lights_punctual":{{"light":0}}}}"#));
    glb.node("lamp", r#""translation":[-4.5,3.2,2.0],"extensions":{"KHR_lights_punctual":{"light":1}}"#);
    // 3 W/m², and 800 W.
    glb.finish(
        r#","cameras":[{"type":"perspective","perspective":{"yfov":0.66,"znear":0.1,"zfar":300.0}}],"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional","color":[1.0,0.86,0.68],"intensity":2049.0},{"type":"point","color":[1.0,0.62,0.34],"intensity":43480.0}]}}"#,
    )
}

/// Sky of the example: blue above, warm at the horizon, with a bright part where the sun is.
fn dusk() -> Vec<u8> {
    let size = UVec2::new(128, 64);
    let sun = Quat::from_euler(glam::EulerRot::YXZ, -0.9, -0.75, 0.0) * Vec3::Z;
    let texel = |index: u32| {
        let uv = (UVec2::new(index % size.x, index / size.x).as_vec2() + 0.5) / size.as_vec2();
        let direction = sky_image::direction(uv);
        let up = direction.y.max(0.0);
        let sky = Vec3::new(0.62, 0.5, 0.44).lerp(Vec3::new(0.09, 0.19, 0.46), 1.0 - (1.0 - up).powi(4));
        let glow = Vec3::new(1.0, 0.8, 0.55)
            * (6.0 * direction.dot(sun).max(0.0).powi(60) + 0.4 * direction.dot(sun).max(0.0).powi(6));
        let ground = Vec3::new(0.13, 0.115, 0.1);
        let light = if direction.y > 0.0 { sky + glow } else { ground };
        Rgb(light.to_array())
    };
    let pixels: Vec<_> = (0..size.x * size.y).map(texel).collect();
    let mut hdr = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut hdr).encode(&pixels, size.x as usize, size.y as usize).unwrap();
    hdr
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/own_scene").join(name)
}

/// Sines differ between systems by the last bit.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn the_example_is_what_this_code_makes() {
    for (name, bytes) in [("court.glb", court()), ("dusk.hdr", dusk())] {
        if std::env::var_os("HAZE_BLESS").is_some() {
            std::fs::write(example(name), &bytes).unwrap();
        }
        assert!(bytes.len() < 100_000, "{name}: {} bytes", bytes.len());
        assert!(std::fs::read(example(name)).unwrap() == bytes, "{name} differs; HAZE_BLESS=1 writes it");
    }
}

/// A folder with a file, and what loading it as a scene gives.
fn load(bytes: &[u8]) -> Result<SceneMesh, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.glb");
    std::fs::write(&path, bytes).unwrap();
    load_scene(&path).map_err(|error| error.to_string().replace(folder.path().to_str().unwrap(), ""))
}

/// One triangle with the given corners, under nodes of the given JSON.
fn triangle(corners: [Vec3; 3], nodes: &str, more: &str) -> Vec<u8> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36}}]{more}}}"#
    );
    let padded = format!("{json:<width$}", width = json.len().next_multiple_of(4));
    glb(padded.as_bytes(), bytemuck::cast_slice(&corners))
}

const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

#[test]
fn triangles_camera_and_lights_of_the_example_come_back() {
    let scene = load(&court()).unwrap();
    let said = scene.description();
    assert!(said.ends_with(" triangles, a camera, 2 lights") && scene.triangle_count() > 1000, "{said}");
    // The floor has 48 m, the beam ends at 4 m.
    let (min, max) = scene.bounds().unwrap();
    assert!(min.abs_diff_eq(Vec3::new(-24.0, 0.0, -24.0), 1e-4) && max.abs_diff_eq(Vec3::new(24.0, 4.0, 24.0), 1e-4));
    let camera = scene.camera_at_scale(None, 1.0).unwrap();
    assert!(camera.position.abs_diff_eq(Vec3::new(0.4, 1.9, 8.2), 1e-5));
    assert!((camera.fov - 0.66_f32.to_degrees()).abs() < 1e-3 && camera.target.z.abs() < 0.1, "{camera:?}");
    let doubled = scene.camera_at_scale(None, 2.0).unwrap();
    assert!(doubled.position.abs_diff_eq(camera.position * 2.0, 1e-4));
    let [sun, lamp] = &scene.lights_at_scale(1.0)[..] else { panic!("two lights") };
    // 3 W/m² on white are 3/π, 800 W of a lamp are 800 / 4π / π at one metre, as in Blender.
    let pi = std::f32::consts::PI;
    assert!((sun.intensity - 3.0 / pi).abs() < 1e-3 && sun.kind == LightKind::Directional, "{sun:?}");
    assert!((lamp.intensity - 800.0 / (4.0 * pi * pi)).abs() < 0.01 && lamp.kind == LightKind::Point, "{lamp:?}");
    assert!(sun.direction.y < -0.6 && sun.direction.x > 0.3 && sun.direction.z < -0.3, "{sun:?}");
    assert_eq!(lamp.position, Vec3::new(-4.5, 3.2, 2.0));
    // Down on the large crate, through a gap of the fence, and at a picket.
    let down = |x, z| scene.nearest(ray(Vec3::new(x, 9.0, z), Vec3::NEG_Y), 0.0..=20.0).map(|hit| 9.0 - hit.distance);
    assert!((down(-1.7, 0.7).unwrap() - 1.0).abs() < 1e-4 && down(0.0, 3.0).unwrap().abs() < 1e-4);
    let forward = |x| scene.nearest(ray(Vec3::new(x, 0.5, 4.0), Vec3::NEG_Z), 0.0..=2.9).is_some();
    let solid = (0..40).filter(|step| forward(0.6 + 0.055 * *step as f32)).count();
    assert!((15..32).contains(&solid), "{solid} of 40 rays meet a picket");
    let blocked = |x| scene.is_blocked(ray(Vec3::new(x, 0.5, 4.0), Vec3::NEG_Z), 2.9);
    let masked = (0..40).filter(|step| blocked(0.6 + 0.055 * *step as f32)).count();
    assert!(masked.abs_diff(solid) < 3, "the mask of shadows: {masked}, of the surface: {solid}");
    let hit = scene.nearest(ray(Vec3::new(1.75, 0.6, 4.0), Vec3::NEG_Z), 2.9..=9.0).unwrap();
    let point = scene.surface_point(&hit, Vec3::NEG_Z);
    assert!(point.normal.z > 0.99 && point.color.abs_diff_eq(Vec3::new(0.5, 0.16, 0.09), 1e-5), "{point:?}");
}

#[test]
fn nodes_are_transformed_and_normals_made_up() {
    let nodes = r#"{"children":[1],"translation":[0,0,5]},{"mesh":0,"scale":[-2,2,2]}"#;
    let scene = load(&triangle(CORNERS, nodes, "")).unwrap();
    let positions: Vec<_> = scene.vertices.iter().map(|vertex| vertex.position).collect();
    // Mirrored: the corners are turned round, so that the front stays in front.
    assert_eq!(positions, [Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 2.0, 5.0), Vec3::new(-2.0, 0.0, 5.0)]);
    assert!(scene.vertices.iter().all(|vertex| vertex.normal.abs_diff_eq(Vec3::Z, 1e-6)), "{:?}", scene.vertices);
    assert!(scene.cameras.is_empty() && scene.lights.is_empty());
}

#[test]
fn damaged_and_unknown_files_say_what_would_be_right() {
    let nodes = r#"{"mesh":0}"#;
    let whole = triangle(CORNERS, nodes, "");
    let said = |bytes: &[u8]| load(bytes).unwrap_err();
    for length in [0, 3, 11, 19, 60, whole.len() - 40, whole.len() - 1] {
        let said = said(&whole[..length]);
        assert!(
            said.starts_with("/scene.glb: ") && said.ends_with("; expected a whole glTF 2.0 file"),
            "{length}: {said}"
        );
    }
    let [nan, far] =
        [f32::NAN, 1.0e9].map(|x| said(&triangle([Vec3::ZERO, Vec3::new(x, 0.0, 0.0), Vec3::Y], nodes, "")));
    assert!(nan.contains("corner 1 of node 0 is at [NaN, NaN, NaN]; expected finite numbers up to 100000 m"), "{nan}");
    assert!(far.contains("corner 1 of node 0 is at [1000000000, 0, 0]; expected"), "{far}");
    let cycle = said(&triangle(CORNERS, r#"{"mesh":0,"children":[0]}"#, ""));
    assert!(cycle.contains("node 0 has two parents; expected a tree of nodes"), "{cycle}");
    let more =
        r#","extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]"#;
    let draco = said(&triangle(CORNERS, nodes, more));
    assert!(
        draco.contains("needs the extension KHR_draco_mesh_compression") && draco.contains("without compression"),
        "{draco}"
    );
    let empty = said(&triangle(CORNERS, "{}", ""));
    assert!(empty.contains("has no triangles, cameras or lights; expected a scene with meshes"), "{empty}");
    let counted = String::from_utf8_lossy(&whole).replace(r#""count":3,"#, r#""count":9,"#);
    assert!(said(counted.as_bytes()).contains("expected"), "an accessor beyond its buffer");
    let huge = String::from_utf8_lossy(&whole).replace(r#""count":3,"type""#, r#""count":4000000000,"type""#);
    let json = huge[20..huge.rfind('}').unwrap() + 1].to_owned();
    let json = format!("{json:<width$}", width = json.len().next_multiple_of(4));
    let huge = said(&glb(json.as_bytes(), bytemuck::cast_slice(&CORNERS)));
    assert!(huge.contains("more than 1000000 triangles"), "{huge}");
}

#[test]
fn any_change_of_a_byte_gives_a_scene_or_an_error() {
    let whole = court();
    // Of the JSON and the first buffers: a change of an image is caught by its checksum.
    for at in (12..whole.len().min(9000)).step_by(37) {
        for value in [0x22, 0x39, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] = value;
            if let Ok(scene) = load(&bytes) {
                assert!(scene.vertices.iter().all(|vertex| vertex.position.is_finite() && vertex.normal.is_finite()));
            }
        }
    }
}

#[test]
fn skies_that_cannot_be_read_say_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let load = |bytes: &[u8]| {
        let path = folder.path().join("sky.hdr");
        std::fs::write(&path, bytes).unwrap();
        load_sky(&path).map_err(|error| error.to_string())
    };
    let whole = dusk();
    assert_eq!(load(&whole).unwrap().texels.size, UVec2::new(128, 64));
    for part in [&whole[..0], &whole[..20], &whole[..whole.len() / 2], b"no image"] {
        let said = load(part).unwrap_err();
        assert!(
            said.contains("sky.hdr: ") && said.contains("; expected a Radiance (.hdr) or OpenEXR (.exr) image"),
            "{said}"
        );
    }
    let size = "its header gives no size that is read; expected -Y HEIGHT +X WIDTH";
    for (rest, expected) in [
        ("", "the file ends too early; expected a Radiance (.hdr) or OpenEXR (.exr) image"),
        ("\n-Y 1 +X 2\n", "the file ends too early; expected a Radiance (.hdr) or OpenEXR (.exr) image"),
        (
            "\n-Y 4 +X 8\n\x02\x02\0\x08\x08\x7f",
            "the file ends too early; expected a Radiance (.hdr) or OpenEXR (.exr) image",
        ),
        ("\n-Y 1 +X 2\n\x01\x01\x01\x01", "damaged; expected a Radiance (.hdr) or OpenEXR (.exr) image"),
        ("\n+X 2 -Y 1\n", size),
        ("\n-Y a +X 2\n", size),
        ("\n-Y 1 +X\n", size),
        ("\n-Y 4294967295 +X 4294967295\n", size),
        ("FORMAT=foo\n\n", "its format is foo; expected 32-bit_rle_rgbe"),
        ("EXPOSURE=a\n\n", "EXPOSURE of its header is not a number; expected one above 0"),
        ("COLORCORR=1 2\n\n", "COLORCORR of its header is not three numbers; expected three above 0"),
    ] {
        let said = load(format!("#?RADIANCE\n{rest}").as_bytes()).unwrap_err();
        assert!(said.ends_with(&format!("sky.hdr: {expected}")), "{rest:?}: {said}");
    }
    // Another first line, which Photoshop and others write.
    let renamed = [b"#?RGBE", &whole[10..]].concat();
    assert!(load(&renamed).unwrap().texels == load(&whole).unwrap().texels);
    let xyz = load(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 2\n").unwrap_err();
    assert!(xyz.ends_with("its colors are XYZ; expected RGB: export it as 32-bit_rle_rgbe"), "{xyz}");
    let wide = load(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 40000\n").unwrap_err();
    assert!(wide.contains("40000x20000 texels, more than 8192x4096"), "{wide}");
}

#[test]
fn values_of_radiance_skies_are_divided_by_the_factors_of_their_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.hdr");
    let load = |lines: &str| {
        let header = format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
        // Radiance 1, 0.5, 0.25.
        std::fs::write(&path, [header.as_bytes(), &[128, 64, 32, 129].repeat(2)].concat()).unwrap();
        load_sky(&path).map(|sky| sky.sample(Vec3::X)).map_err(|error| error.to_string())
    };
    let plain = Vec3::new(1.0, 0.5, 0.25);
    assert_eq!(load(""), Ok(plain));
    assert_eq!(load("EXPOSURE= 1.0000000000000\n"), Ok(plain));
    assert_eq!(load("EXPOSURE=4\n"), Ok(plain / 4.0));
    assert_eq!(load("EXPOSURE=4\nVIEW= -vta\nEXPOSURE = 0.25\nEXPOSURE=0.5\n"), Ok(plain * 2.0));
    assert_eq!(load("COLORCORR=1 2 0.5\nEXPOSURE=2\n"), Ok(plain / Vec3::new(2.0, 4.0, 1.0)));
    for (lines, found) in [
        ("EXPOSURE=0\n", "EXPOSURE 0"),
        ("EXPOSURE=-2\n", "EXPOSURE -2"),
        ("EXPOSURE=nan\n", "EXPOSURE NaN"),
        ("EXPOSURE=1e30\nEXPOSURE=1e30\n", "EXPOSURE inf"),
        ("COLORCORR=1 0 1\n", "EXPOSURE times COLORCORR 1 0 1"),
    ] {
        let said = load(lines).unwrap_err();
        let expected = format!("sky.hdr: its header has {found}; expected 0.000000001 to 1000000000");
        assert!(said.ends_with(&expected), "{said}");
    }
}

#[test]
fn a_preset_names_its_backdrop_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("court.glb"), court()).unwrap();
    let load = |scene: &str, sky: &str| {
        let mut preset = Preset::default();
        preset.environment.scene_file = scene.into();
        preset.environment.sky_file = sky.into();
        Backdrop::load(&preset, Path::new("my.json"), &AssetFolders::new(folder.path()))
            .map_err(|error| error.to_string())
    };
    assert!(load("court.glb", "").unwrap().scene.is_some() && load("", "").unwrap() == Backdrop::default());
    let missing = load("cuort.glb", "").unwrap_err();
    assert!(
        missing.starts_with("my.json: environment.scene_file: ") && missing.ends_with("\"court.glb\""),
        "{missing}"
    );
    let outside = load("", "../dusk.hdr").unwrap_err();
    let expected = "my.json: environment.sky_file: \"../dusk.hdr\" is not valid; expected a .hdr or .exr file inside the preset's folder";
    assert_eq!(outside, expected);
}
