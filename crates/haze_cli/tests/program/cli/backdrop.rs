//! An own scene and sky on the command line.

use std::path::{Path, PathBuf};

use super::{folder, haze, refusal, stderr};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/own_scene").join(name)
}

#[test]
fn a_scene_and_a_sky_are_rendered_from_any_folder() {
    let folder = folder();
    let court = example("court.glb");
    let dusk = example("dusk.hdr");
    let [court, dusk] = [&court, &dusk].map(|path| path.to_str().unwrap());
    let rendered = |more: &[&str]| {
        let arguments = [&["render", "--size", "48x27", "--backend", "cpu", "-o", "out.png"], more].concat();
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        haze_core::assets::image::read_png(&folder.path().join("out.png")).unwrap()
    };
    let images = [
        rendered(&[]),
        rendered(&["--scene", court]),
        rendered(&["--scene", court, "--sky", dusk]),
        rendered(&["--scene", court, "--sky", dusk, "--scene-camera"]),
        rendered(&["--scene", court, "--sky", dusk, "--scene-camera", "--scene-lights"]),
        rendered(&["--scene", court, "--sky", dusk, "--set", "environment.sky_rotation=90"]),
    ];
    for (index, image) in images.iter().enumerate() {
        assert!(!images[..index].contains(image), "image {index} is one of those before");
    }
    // Smoke alone does not show them.
    assert!(rendered(&["--scene", court, "--transparent"]) == rendered(&["--transparent"]));
    let refused = |more: &[&str]| {
        refusal(folder.path(), &[&["render", "--size", "16x16", "--backend", "cpu", "-o", "out.png"], more].concat())
    };
    let line = refused(&["--scene", dusk]);
    assert!(line.contains("--scene: ") && line.contains("expected a file that ends in .glb or .gltf"), "{line}");
    let line = refused(&["--sky", "gone.hdr"]);
    assert!(line.contains("--sky: gone.hdr: "), "{line}");
    let line = refused(&["--scene-lights"]);
    assert!(line.contains("--scene-lights: there is no scene file; expected a scene file that has lights"), "{line}");
    let line = refused(&["--set", "environment.scene_file=court.glb"]);
    assert!(line.contains("environment.scene_file: ") && line.contains("No such file"), "{line}");
}

/// A scene file of Blender with two cameras and a lamp, without surfaces.
const VIEW: &str = r#"{"asset":{"version":"2.0","generator":"Khronos glTF Blender I/O v5.0.21"},"scenes":[{"nodes":[0,1,2,3]}],
    "nodes":[{"camera":0,"name":"front","translation":[0,1,6]},{"camera":0,"name":"near","translation":[0,1,4]},
    {"camera":1,"name":"plan"},{"translation":[0,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}},
    {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0.1,"zfar":9}}],
    "extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":9000}]}}}"#;

#[test]
fn parts_of_a_scene_that_are_not_shown_are_told_by_every_command() {
    let folder = folder();
    std::fs::write(folder.path().join("view.gltf"), VIEW).unwrap();
    let preset = r#"{"version":1,"name":"view","environment":{"scene_file":"view.gltf"},"systems":[]}"#;
    std::fs::write(folder.path().join("view.json"), preset).unwrap();
    let note = "view.gltf: camera \"plan\" is orthographic; haze has perspective cameras only";
    let render = ["render", "view.json", "--size", "16x9", "--backend", "cpu", "-o", "out.png"];
    let output = haze(folder.path(), &render);
    assert_eq!(stderr(&output), format!("haze: {note}\n"));
    let check = haze(folder.path(), &["preset", "check", "view.json"]);
    assert!(String::from_utf8_lossy(&check.stdout).contains(note) && check.status.success());
    let flipbook =
        "export flipbook --scene view.gltf --engine godot --frames 0..1 --sheet 1x2 --size 16x16 --backend cpu -o book";
    let output = haze(folder.path(), &flipbook.split(' ').collect::<Vec<_>>());
    assert!(output.status.success() && stderr(&output).contains(note), "{}", stderr(&output));
}

#[test]
fn set_is_the_last_word_on_what_files_replace() {
    let folder = folder();
    std::fs::write(folder.path().join("view.gltf"), VIEW).unwrap();
    let dusk = example("dusk.hdr");
    let dusk = dusk.to_str().unwrap();
    let render = |more: &[&str]| {
        let arguments = [&["render", "--size", "32x18", "--backend", "cpu", "-o", "out.png"], more].concat();
        let output = haze(folder.path(), &arguments);
        let said = stderr(&output);
        assert!(output.status.success(), "{more:?}: {said}");
        (haze_core::assets::image::read_png(&folder.path().join("out.png")).unwrap(), said)
    };
    let rendered = |more: &[&str]| {
        let (image, said) = render(more);
        assert!(!said.contains("has no effect"), "{more:?}: {said}");
        image
    };
    let scene = ["--scene", "view.gltf"];
    let with = |more: &[&str]| rendered(&[&scene, more].concat());
    let first = with(&["--scene-camera"]);
    assert!(with(&["--scene-camera", "front"]) == first);
    let near = with(&["--scene-camera", "near"]);
    assert!(near != first && with(&["--scene-camera", "near", "--set", "camera.position=0,1,6"]) != near);
    let narrow = with(&["--scene-camera", "--set", "fov=20"]);
    assert!(narrow != first && narrow != with(&["--set", "fov=20"]));
    let lit = with(&["--scene-lights"]);
    assert!(with(&["--scene-lights", "--set", "lights[0].intensity=0"]) != lit);
    // The smoke's preset has no light of its own here.
    let dark = r#"{"version":1,"name":"dark","lights":[],"systems":[{"name":"s"}]}"#;
    std::fs::write(folder.path().join("dark.json"), dark).unwrap();
    let of_dark = |more: &[&str]| with(&[&["dark.json", "--scene-lights"], more].concat());
    assert!(of_dark(&["--set", "lights[0].intensity=0"]) != of_dark(&[]));
    let refused = |more: &[&str]| {
        let start = ["render", "--size", "16x16", "--backend", "cpu", "-o", "out.png", "--scene", "view.gltf"];
        refusal(folder.path(), &[&start, more].concat())
    };
    let line = refused(&["--scene-lights", "--set", "lights[7].intensity=0"]);
    assert!(line.contains("--set field: \"lights[7].intensity\" is not valid"), "{line}");
    let line = refused(&["--scene-camera", "plan"]);
    let expected =
        "--scene-camera: the scene file has no perspective camera \"plan\"; expected one of \"front\", \"near\"";
    assert!(line.contains(expected), "{line}");

    // A sky from Blender.
    let turned = rendered(&["--sky", dusk, "--set", "environment.sky_rotation=90"]);
    assert!(turned != rendered(&["--sky", dusk]) && turned == rendered(&["--sky", dusk, "--sky-from-blender"]));
    let (beside, said) = render(&["--scene", "view.gltf", "--sky", dusk]);
    assert!(said.contains("dusk.hdr: turned by 90 degrees, as the world of a scene from Blender"), "{said}");
    let asked = render(&["--scene", "view.gltf", "--sky", dusk, "--set", "sky_rotation=90"]);
    assert!(beside == asked.0 && !asked.1.contains("turned by"), "{}", asked.1);
    assert!(beside != with(&["--sky", dusk, "--set", "sky_rotation=0"]));
    for (more, reason) in [
        (["--set", "sky_file=dusk.hdr"], "--set sky_file has no effect: --sky names the file"),
        (["--sky-from-blender", "--set=sky_rotation=5"], "--sky-from-blender has no effect: --set gives environment"),
        (["--set", "environment.lamp=false"], "--set environment.lamp has no effect: the scene is that of scene_file"),
    ] {
        let (_, said) = render(&[&["--scene", "view.gltf", "--sky", dusk][..], &more].concat());
        assert!(said.contains(reason), "{said}");
    }
}
