//! An own scene and sky on the command line.

use std::path::{Path, PathBuf};

use super::{folder, haze, refusal, stderr};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/own_scene").join(name)
}

#[test]
fn a_scene_and_a_sky_are_rendered_from_any_folder() {
    let folder = folder();
    let (court, dusk) = (example("court.glb"), example("dusk.hdr"));
    let [court, dusk] = [&court, &dusk].map(|path| path.to_str().unwrap());
    let picture = |more: &[&str]| {
        let arguments = [&["render", "--size", "48x27", "--backend", "cpu", "-o", "out.png"], more].concat();
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        haze_core::assets::image::read_png(&folder.path().join("out.png")).unwrap()
    };
    let images = [
        picture(&[]),
        picture(&["--scene", court]),
        picture(&["--scene", court, "--sky", dusk]),
        picture(&["--scene", court, "--sky", dusk, "--scene-camera"]),
        picture(&["--scene", court, "--sky", dusk, "--scene-camera", "--scene-lights"]),
        picture(&["--scene", court, "--sky", dusk, "--set", "environment.sky_rotation=90"]),
    ];
    for (index, image) in images.iter().enumerate() {
        assert!(!images[..index].contains(image), "image {index} is one of those before");
    }
    // Smoke alone does not show them.
    assert!(picture(&["--scene", court, "--transparent"]) == picture(&["--transparent"]));
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
