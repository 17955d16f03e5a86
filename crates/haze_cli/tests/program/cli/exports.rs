//! Exports for engines, and the pixels of exported images.

use super::{folder, haze, refusal, render, stderr};

const FLIPBOOK: [&str; 12] =
    ["export", "flipbook", "--size", "24x24", "--backend", "cpu", "--frames", "0..2", "--sheet", "2x2", "-o", "book"];

#[test]
fn materials_are_written_for_every_engine() {
    let folder = folder();
    for (engine, source) in [
        ("unreal", "custom_node.hlsl"),
        ("unity", "haze_material.hlsl"),
        ("godot", "haze_material.gdshader"),
        ("wgsl", "haze_material.wgsl"),
        ("three", "haze_material.js"),
    ] {
        let arguments = ["export", "material", "campfire", "--engine", engine, "--set", "boost=1.25", "-o", engine];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{engine}: {}", stderr(&output));
        let lines = String::from_utf8(output.stdout).unwrap();
        for file in [source, "README.md", "diffuse_ramp.png", "fire_ramp.png"] {
            let path = folder.path().join(engine).join(file);
            assert!(path.is_file() && lines.contains(file), "{engine}: {file}, {lines}");
        }
        let text = std::fs::read_to_string(folder.path().join(engine).join(source)).unwrap();
        assert!(text.contains("1.25") && text.contains("haze_emission"), "{engine}: {text}");
        let readme = std::fs::read_to_string(folder.path().join(engine).join("README.md")).unwrap();
        assert!(readme.starts_with("# Campfire: fire\n") && readme.contains("`fire_ramp.png`"), "{readme}");
    }
}

#[test]
fn materials_of_other_systems_have_their_numbers() {
    let folder = folder();
    let text = |system: &str| {
        let arguments = ["export", "material", "campfire", "--engine", "wgsl", "--system", system, "-o", "out"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        std::fs::read_to_string(folder.path().join("out/haze_material.wgsl")).unwrap()
    };
    assert_eq!(text("sparks"), text("1"));
    assert_ne!(text("sparks"), text("fire"));
    let line = refusal(
        folder.path(),
        &["export", "material", "campfire", "--engine", "wgsl", "--system", "smoke", "-o", "out"],
    );
    assert!(line.contains("--system: \"smoke\" is not valid; expected one of \"fire\", \"sparks\""), "{line}");
    let line =
        refusal(folder.path(), &["export", "material", "--engine", "wgsl", "--set", "lighting=six_way", "-o", "out"]);
    assert!(line.contains("systems[0].settings.lighting: \"six_way\" is not valid; expected"), "{line}");
}

#[test]
fn flipbooks_say_where_they_cut_off_smoke() {
    let folder = folder();
    let narrow = ["--engine", "unity", "--set", "camera.fov=15"];
    let said = |more: &[&str]| {
        let output = haze(folder.path(), &[&FLIPBOOK[..], &narrow, more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let cut = said(&[]);
    assert!(cut.starts_with("haze: frame 0 cuts off smoke on its ") && cut.contains("(--fit)"), "{cut}");
    assert!(!said(&["--fit"]).contains("cuts off smoke"));
}

#[test]
fn flipbooks_are_written_with_their_numbers() {
    let folder = folder();
    let output = haze(folder.path(), &[&FLIPBOOK[..], &["--engine", "unity", "--loop", "1", "--six-way"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    for file in ["color.png", "normals.png", "motion.png", "six_way_1.png", "six_way_2.png"] {
        assert_eq!(super::size_of(&folder.path().join("book").join(file)), (48, 48), "{file}");
    }
    let numbers = std::fs::read_to_string(folder.path().join("book/flipbook.json")).unwrap();
    assert!(numbers.contains("\"columns\": 2") && numbers.contains("\"frames\": 3"), "{numbers}");
    assert!(numbers.contains("\"alpha\": \"straight\""), "{numbers}");
    let readme = std::fs::read_to_string(folder.path().join("book/README.md")).unwrap();
    assert!(readme.contains("light from right, top, back"), "{readme}");

    let refused = |more: &[&str]| refusal(folder.path(), &[&FLIPBOOK[..], &["--engine", "unity"], more].concat());
    let line = refused(&["--loop", "3"]);
    assert!(line.contains("--loop: 3 is not valid; expected less than the number of frames, 3"), "{line}");
    let line = refused(&["--alpha", "none"]);
    assert!(line.contains("--alpha") && line.contains("straight, premultiplied"), "{line}");
    let line = refused(&["--view", "normals"]);
    assert!(line.contains("--view"), "{line}");
}

#[test]
fn refused_flipbooks_leave_no_folder() {
    let folder = folder();
    let start = ["export", "flipbook", "--engine", "unity", "--frames", "0..2", "-o", "book"];
    for wrong in [
        &["colunm", "--sheet", "2x2"][..],
        &["--sheet", "2x2", "--loop", "3"],
        &["--sheet", "1x1"],
        &["--sheet", "2x2", "--set", "boost=-1"],
    ] {
        refusal(folder.path(), &[&start[..], wrong].concat());
        assert!(!folder.path().join("book").exists(), "{wrong:?}");
    }
}

#[cfg(unix)]
#[test]
fn interrupted_flipbooks_leave_no_folder() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_haze"));
    command.args(["export", "flipbook", "--engine", "unity", "--backend", "cpu", "--size", "64x64", "--set"]);
    command.args(["camera.fov=60", "--frames", "0..999", "--sheet", "40x40", "-o", "deep/book"]);
    let child = command.current_dir(folder.path()).stderr(Stdio::piped()).spawn().unwrap();
    let start = std::time::Instant::now();
    while !folder.path().join("deep/book").exists() {
        assert!(start.elapsed().as_secs() < 60);
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(1), 1), "{text}");
    assert!(text.contains("deep/book: stopped: not written; "), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn pixels_of_images_are_as_asked_for() {
    let folder = folder();
    let rendered = |arguments: &[&str]| {
        let output = render(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        haze_core::assets::image::read_png(&folder.path().join("out.png")).unwrap()
    };
    let color = |arguments: &[&str]| rendered(arguments).color();
    let empty = "environment.scene=empty";
    assert_eq!(color(&[]), image::ColorType::Rgb8);
    assert_eq!(color(&["--bits", "16"]), image::ColorType::Rgb16);
    assert_eq!(color(&["--transparent", "--bits", "16"]), image::ColorType::Rgba16);
    assert_eq!(color(&["--set", empty]), image::ColorType::Rgba8);
    assert_eq!(color(&["--set", empty, "--background", "scene"]), image::ColorType::Rgb8);
    assert_eq!(color(&["--set", empty, "--view", "normals"]), image::ColorType::Rgb8);
    assert_ne!(rendered(&["--transparent"]), rendered(&["--transparent", "--alpha", "premultiplied"]));
    let small = ["render", "--size", "16x16", "--backend", "cpu"];
    let line = |more: &[&str]| refusal(folder.path(), &[&small[..], more].concat());
    let said = line(&["--bits", "16", "-o", "a.exr"]);
    assert!(said.contains("--bits: a.exr is no PNG; expected a name that ends in .png"), "{said}");
    let said = line(&["--alpha", "premultiplied", "-o", "a.exr"]);
    assert!(said.contains("EXR is premultiplied"), "{said}");
    let said = line(&["--background", "transparent", "--frames", "0..1", "-o", "a.gif"]);
    assert!(said.contains("--background: a GIF has no partial opacity"), "{said}");
}
