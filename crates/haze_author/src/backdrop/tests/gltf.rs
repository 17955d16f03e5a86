//! Scene files as Blender, three.js and glTF-Transform write them: each part is shown, or a note tells it.

use std::cell::Cell;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{Backdrop, SceneMesh, load_scene, ray};
use haze_preset::{Preset, Track};

/// A card of side 1 around the origin, in a file whose parts a test changes.
struct File {
    json: Value,
    data: Vec<u8>,
}

const CARD: [[f32; 3]; 6] =
    [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]];

impl File {
    fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0", "generator": "Khronos glTF Blender I/O v5.0.21"},
            "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "card"}],
            "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
            "meshes": [{"primitives": [{"attributes": {}, "material": 0}]}],
            "bufferViews": [], "accessors": [],
        });
        let mut file = Self { json, data: Vec::new() };
        let bounds = json!({"min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0]});
        let positions = file.accessor(bytemuck::cast_slice(&CARD), 5126, "VEC3", 6, &bounds);
        file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = positions.into();
        file
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, more: &Value) -> usize {
        let offset = self.data.len();
        self.data.extend_from_slice(bytes);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let list = |file: &mut Value, name: &str, item: Value| {
            let list = file[name].as_array_mut().unwrap();
            list.push(item);
            list.len() - 1
        };
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        let view = list(&mut self.json, "bufferViews", view);
        let mut accessor = json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        accessor.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        list(&mut self.json, "accessors", accessor)
    }

    fn floats(&mut self, values: &[f32], kind: &str, count: usize) -> usize {
        self.accessor(bytemuck::cast_slice(values), 5126, kind, count, &json!({}))
    }

    fn attribute(&mut self, name: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor.into();
    }

    fn add_node(&mut self, node: Value) {
        let nodes = self.json["nodes"].as_array_mut().unwrap();
        nodes.push(node);
        let index = nodes.len() - 1;
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(index.into());
    }

    fn load(mut self) -> Result<SceneMesh, String> {
        if !self.data.is_empty() {
            let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.data));
            self.json["buffers"] = json!([{"byteLength": self.data.len(), "uri": uri}]);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.gltf");
        std::fs::write(&path, self.json.to_string()).unwrap();
        load_scene(&path).map_err(|error| error.to_string())
    }
}

/// True if a ray along -z meets a surface.
fn is_hit(scene: &SceneMesh, x: f32, y: f32) -> bool {
    scene.nearest(ray(Vec3::new(x, y, 5.0), Vec3::NEG_Z), 0.0..=10.0).is_some()
}

#[test]
fn attributes_and_data_of_an_application_do_not_refuse_a_file() {
    let mut file = File::new();
    let heat = file.floats(&[0.5; 6], "SCALAR", 6);
    for name in ["_HEAT", "_RADIUS", "FEATURE_ID_0"] {
        file.attribute(name, heat);
    }
    // Data of an application may be anything.
    file.json["nodes"][0]["extras"] = json!(7);
    file.json["asset"]["extras"] = json!(["a", {"b": null}]);
    let scene = file.load().unwrap();
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!(scene.notes, ["attributes of other programs are not read: FEATURE_ID_0, _HEAT, _RADIUS"]);
}

#[test]
fn instances_are_shown() {
    let positions: Vec<f32> = (0..5).flat_map(|index| [2.0 * index as f32 - 4.0, 0.0, 0.0]).collect();
    let quarter = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2).to_array();
    for is_required in [false, true] {
        let mut file = File::new();
        let translation = file.floats(&positions, "VEC3", 5);
        // The last is turned away and seen from its edge; rotations are bytes here.
        let rotations: Vec<i8> = (0..5)
            .flat_map(
                |index| if index == 4 { quarter.map(|part| (part * 127.0).round() as i8) } else { [0, 0, 0, 127] },
            )
            .collect();
        let normalized = json!({"normalized": true});
        let rotation = file.accessor(bytemuck::cast_slice(&rotations), 5120, "VEC4", 5, &normalized);
        let scales: Vec<f32> = (0..5).flat_map(|index| [1.0, if index == 1 { 3.0 } else { 1.0 }, 1.0]).collect();
        let scale = file.floats(&scales, "VEC3", 5);
        file.json["nodes"][0]["translation"] = json!([0, 1, 0]);
        file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes":
            {"TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale, "_COLOR_0": translation}}});
        file.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
        if is_required {
            file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
        }
        let scene = file.load().unwrap();
        assert_eq!(scene.triangle_count(), 10);
        let hits = [-4.0, -3.0, -2.0, 0.0, 2.0, 4.0].map(|x| is_hit(&scene, x, 1.0));
        assert_eq!(hits, [true, false, true, true, true, false]);
        assert!(is_hit(&scene, -2.0, 2.2) && !is_hit(&scene, 0.0, 2.2), "the second is three times as high");
        assert_eq!(scene.notes, ["attributes of other programs are not read: _COLOR_0"]);
    }
}

/// Thousands of instances in one position: rays are tested against few triangles.
#[test]
fn copies_in_one_place_are_shown_once() {
    const COPIES: usize = 3000;
    let mut file = File::new();
    let translation = file.floats(&[0.0; 3 * COPIES], "VEC3", COPIES);
    file.json["nodes"][0]["rotation"] = json!([0.2, 0.3, 0.1, 0.9]);
    file.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}}});
    let scene = file.load().unwrap();
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!(scene.notes, ["5998 triangles lie exactly on others and are not shown"]);
    let visited = Cell::new(0);
    let triangle = |index| {
        visited.set(visited.get() + 1);
        scene.ray_triangle(index)
    };
    let hit = scene.bvh.nearest(ray(Vec3::new(0.1, 0.1, 5.0), Vec3::NEG_Z), 0.0..=10.0, triangle, |_| true);
    assert!(hit.is_some() && visited.get() <= 2, "{}", visited.get());
}

#[test]
fn damaged_instances_are_refused() {
    let load = |translation: Value| {
        let mut file = File::new();
        file.floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0], "VEC3", 2);
        file.floats(&[1.0; 9], "VEC3", 3);
        file.json["nodes"][0]["extensions"] =
            json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation, "SCALE": 1}}});
        file.load()
    };
    assert_eq!(load(json!(1)).unwrap().triangle_count(), 4);
    assert!(load(json!(2)).unwrap_err().contains("the instances of \"card\": their attributes differ in number"));
    assert!(load(json!(9)).unwrap_err().contains("the instances of \"card\" have no accessor 9; expected"));
    // One instance more than triangles are allowed, of two triangles each, without data: a sparse accessor.
    let mut file = File::new();
    let at = file.accessor(&[0; 4], 5125, "SCALAR", 1, &json!({}));
    let value = file.floats(&[0.0; 3], "VEC3", 1);
    let views = |accessor: usize| file.json["accessors"][accessor]["bufferView"].clone();
    let sparse = json!({"componentType": 5126, "type": "VEC3", "count": 1_000_000, "sparse": {"count": 1,
        "indices": {"bufferView": views(at), "componentType": 5125}, "values": {"bufferView": views(value)}}});
    let accessors = file.json["accessors"].as_array_mut().unwrap();
    accessors.push(sparse);
    let many = accessors.len() - 1;
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": many}}});
    assert!(file.load().unwrap_err().contains("more than 1000000 triangles"));
}

#[test]
fn animations_of_any_kind_rest() {
    let mut file = File::new();
    let times =
        file.accessor(bytemuck::cast_slice(&[0.0_f32, 1.0]), 5126, "SCALAR", 2, &json!({"min": [0], "max": [1]}));
    file.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    file.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"path": "pointer",
            "extensions": {"KHR_animation_pointer": {"pointer": "/cameras/0/perspective/yfov"}}}}],
        "samplers": [{"input": times, "output": times, "interpolation": "LINEAR"}],
    }]);
    let scene = file.load().unwrap();
    assert_eq!(scene.notes, ["animations are not played: what moves rests"]);
}

#[test]
fn alpha_of_vertices_cuts_out_and_casts_no_shadow() {
    // Opaque at the left edge, clear at the right one.
    let alpha = |cutoff: Value| {
        let mut file = File::new();
        let colors: Vec<f32> = CARD.iter().flat_map(|[x, ..]| [1.0, 1.0, 1.0, 0.5 - x]).collect();
        let colors = file.floats(&colors, "VEC4", 6);
        file.attribute("COLOR_0", colors);
        let material = file.json["materials"][0].as_object_mut().unwrap();
        material.extend(cutoff.as_object().unwrap().clone());
        let scene = file.load().unwrap();
        let seen = [-0.4, -0.1, 0.1, 0.4].map(|x| is_hit(&scene, x, 0.2));
        let blocked = [-0.4, -0.1, 0.1, 0.4].map(|x| scene.is_blocked(ray(Vec3::new(x, 0.2, 5.0), Vec3::NEG_Z), 10.0));
        assert_eq!(seen, blocked);
        seen
    };
    assert_eq!(alpha(json!({})), [true; 4], "an opaque material has no alpha");
    assert_eq!(alpha(json!({"alphaMode": "MASK"})), [true, true, false, false]);
    assert_eq!(alpha(json!({"alphaMode": "BLEND"})), [true, true, false, false]);
    assert_eq!(alpha(json!({"alphaMode": "MASK", "alphaCutoff": 0.2})), [true, true, true, false]);
    let factor = json!({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.7]}});
    assert_eq!(alpha(factor), [true, false, false, false]);
}

/// Cameras "front" and "rolled" with data "Wide", an orthographic "plan", and a sun.
fn file_with_cameras() -> File {
    let mut file = File::new();
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "directional"}]}});
    let lens = json!({"yfov": 0.8, "znear": 0.1, "zfar": 100});
    file.json["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}},
        {"type": "perspective", "perspective": lens},
        {"type": "perspective", "perspective": lens, "name": "Wide"},
    ]);
    let roll = Quat::from_rotation_z(0.2).to_array();
    file.add_node(json!({"camera": 0, "name": "plan"}));
    file.add_node(json!({"camera": 1, "name": "front", "translation": [0, 0, 6]}));
    file.add_node(json!({"camera": 2, "name": "rolled", "translation": [0, 0, 9], "rotation": roll}));
    file.add_node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    file
}

#[test]
fn a_camera_is_chosen_by_its_name() {
    let scene = file_with_cameras().load().unwrap();
    assert_eq!(
        scene.notes,
        [
            "camera \"plan\" is orthographic; haze has perspective cameras only",
            "camera \"rolled\" is rolled by -11.5 degrees; haze shows it upright",
        ]
    );
    assert!(scene.description().starts_with("2 triangles, 2 cameras, a light; camera"), "{}", scene.description());
    let backdrop = Backdrop { scene: Some(scene.into()), sky: None };
    let distance = |name| {
        let mut preset = Preset::load("column").unwrap();
        backdrop.take_camera(name, &mut preset).then_some(preset.camera.position.z)
    };
    let named = [None, Some("front"), Some("rolled"), Some("Wide"), Some("plan"), Some("")];
    assert_eq!(named.map(distance), [Some(6.0), Some(6.0), Some(9.0), Some(9.0), None, None]);
    // Tracks of what a file replaces would replace it again.
    let mut preset = Preset::load("column").unwrap();
    let settings = ["camera.fov", "camera.exposure", "lights[0].intensity", "time"];
    preset.animation = settings.map(|setting| Track { setting: setting.into(), ..Track::default() }).into();
    assert!(backdrop.take_camera(None, &mut preset) && backdrop.take_lights(&mut preset));
    let left: Vec<_> = preset.animation.iter().map(|track| track.setting.as_str()).collect();
    assert_eq!(left, ["camera.exposure", "time"]);
    // Two cameras of one name.
    let mut file = file_with_cameras();
    file.json["nodes"][3]["name"] = "front".into();
    let names = file.load().unwrap().cameras.into_iter().map(|camera| camera.name);
    assert_eq!(names.collect::<Vec<_>>(), ["front", "front 2"]);
}

#[test]
fn a_file_without_triangles_gives_its_cameras_and_lights() {
    let mut file = file_with_cameras();
    file.json["nodes"][0] = json!({"name": "empty"});
    let scene = file.load().unwrap();
    assert!(scene.bounds().is_none() && scene.parts.is_empty());
    let camera = scene.camera_at_scale(Some("front"), 2.0).unwrap();
    assert!(camera.position == Vec3::new(0.0, 0.0, 12.0) && scene.lights_at_scale(2.0).len() == 1);
    let mut file = File::new();
    file.json["meshes"][0]["primitives"][0]["mode"] = 0.into();
    let said = file.load().unwrap_err();
    assert!(said.contains("has no triangles, cameras or lights (points and lines are not shown); expected"), "{said}");
}

#[test]
fn notes_tell_the_rest() {
    let mut file = file_with_cameras();
    file.json["asset"]["generator"] = "THREE.GLTFExporter r179".into();
    file.json["nodes"][0]["weights"] = json!([0, 0.5]);
    file.json["materials"][0]["alphaMode"] = "BLEND".into();
    file.json["materials"][0]["emissiveFactor"] = json!([0, 1, 0]);
    // The card and the sun.
    file.json["scenes"] = json!([{"nodes": [0, 4]}, {"nodes": [1, 2]}]);
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_ior", "KHR_node_visibility"]);
    file.json["extensionsRequired"] = json!(["KHR_materials_ior"]);
    assert_eq!(
        file.load().unwrap().notes,
        [
            "all surfaces are matte, without KHR_materials_ior",
            "not read: KHR_node_visibility",
            "blended materials are cut out at half their alpha",
            "surfaces that glow are shown without their glow",
            "scene 1 of 2 is shown",
            "morph targets are not shown, whatever their weights",
            "lights are read as Blender writes them, watts times 683: in another unit they are too dark or bright",
        ]
    );
    let mut file = File::new();
    file.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    let said = file.load().unwrap_err();
    assert!(said.contains("needs the extension KHR_node_visibility") && said.contains("expected an export without it"));
}

#[test]
fn messages_name_the_place_in_plain_words() {
    let said = |change: &dyn Fn(&mut Value)| {
        let mut file = File::new();
        change(&mut file.json);
        file.load().unwrap_err()
    };
    let whole = "expected a whole glTF 2.0 file";
    let card = |json: &mut Value, field: &str, value: Value| json["nodes"][0][field] = value;
    let image = |json: &mut Value, uri: &str| {
        json["images"] = json!([{"uri": uri}]);
        json["textures"] = json!([{"source": 0}]);
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    };
    for (said, expected) in [
        (
            said(&|json| card(json, "mesh", json!(7))),
            format!("nodes[0].mesh names what the file does not have; {whole}"),
        ),
        (
            said(&|json| card(json, "mesh", json!(-1))),
            "nodes[0].mesh: -1 is not valid; expected an index, 0 or more".into(),
        ),
        (said(&|json| json["nodes"] = json!("x")), "nodes: \"x\" is not valid; expected a list".into()),
        (said(&|json| json["cameras"] = json!([{"type": "perspective"}])), format!("cameras[0] lacks a part; {whole}")),
        (said(&|json| json["asset"] = json!({})), format!("asset: missing field `version`; {whole}")),
        (
            said(&|json| json["materials"][0]["alphaMode"] = json!("GLASS")),
            format!("materials[0].alphaMode is not valid; {whole}"),
        ),
        (
            said(&|json| image(json, "data:image/png;base64,AAAA")),
            "image 0: neither PNG nor JPEG; expected one of the two".into(),
        ),
        (
            said(&|json| image(json, "data:image/png;base64,iVBORw0KGgo=")),
            "image 0: the file ends too early; expected a whole PNG or JPEG image".into(),
        ),
        (
            said(&|json| image(json, "data:image/png;base64,A#AA")),
            "image 0: its data URI is damaged at character 2; expected whole base64".into(),
        ),
    ] {
        assert!(said.ends_with(&format!("scene.gltf: {expected}")), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    for (text, expected) in [
        ("", format!("not a glTF file; {whole}")),
        ("{\n\"asset\": {]}", "line 2, column 11: asset: expected a field's name in double quotes".into()),
        ("{\"asset\": ", format!("line 1, column 10: asset: the file ends where a value should be; {whole}")),
    ] {
        std::fs::write(&path, text).unwrap();
        let said = load_scene(&path).unwrap_err().to_string();
        assert!(said.ends_with(&format!("scene.gltf: {expected}")), "{said}");
    }
}

#[test]
fn quantized_positions_are_read() {
    let mut file = File::new();
    // Items of a vertex buffer start at multiples of four bytes.
    let code = |[x, y, _]: &[f32; 3]| [(x * 65534.0) as i16, (y * 65534.0) as i16, 0, 0];
    let positions: Vec<i16> = CARD.iter().flat_map(code).collect();
    let bounds = json!({"min": [-32767, -32767, 0], "max": [32767, 32767, 0], "normalized": true});
    let accessor = file.accessor(bytemuck::cast_slice(&positions), 5122, "VEC3", 6, &bounds);
    let view = file.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
    file.json["bufferViews"][view]["byteStride"] = 8.into();
    file.attribute("POSITION", accessor);
    file.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = file.load().unwrap();
    assert_eq!(scene.bounds(), Some((Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0))));
    assert!(scene.notes.is_empty());
}
