//! Many images of one preset: fields that are set and varied, frames, flipbooks, GIFs.

use std::fs;

use super::{folder, haze, refusal, render, size_of, stderr};

const SMALL: [&str; 7] = ["render", "fence", "--size", "32x18", "--backend", "cpu", "-o"];

#[test]
fn a_field_is_set_by_its_name() {
    let folder = folder();
    let rendered = |arguments: &[&str]| {
        let output = render(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read(folder.path().join("out.png")).unwrap()
    };
    // The same field by its option, by the end of its path, and by its whole path.
    let scale = rendered(&["--scale", "4"]);
    assert_eq!(scale, rendered(&["--set", "accumulate.downscale=4"]));
    assert_eq!(scale, rendered(&["--set", "systems[0].settings.accumulate.downscale=4"]));
    assert_ne!(scale, rendered(&["--set", "accumulate.downscale=4", "--set", "scatter_color=1,0,0"]));
}

#[test]
fn invalid_assignments_are_refused_before_rendering() {
    let folder = folder();
    let line = |set: &str| refusal(folder.path(), &[&SMALL[..], &["out.png", "--set", set]].concat());
    assert!(line("accumulate.downscale").contains("expected FIELD=VALUE"));
    assert!(
        line("accumulate.scales=1").contains("--set field: \"accumulate.scales\" is not valid"),
        "{}",
        line("a.b=1")
    );
    assert!(line("intensity=1").contains("expected one of lights.intensity, "), "{}", line("intensity=1"));
    assert!(
        line("accumulate.downscale=x")
            .contains("--set accumulate.downscale: \"x\" is not valid; expected a whole number")
    );
    assert!(
        line("accumulate.downscale=99")
            .contains("systems[0].settings.accumulate.downscale: 99 is not valid; expected 1 to 16")
    );
    assert!(line("material.diffuse_ramp=gone.png").contains("systems[0].material.diffuse_ramp"));
    assert!(!folder.path().join("out.png").exists());
}

#[test]
fn a_sheet_has_one_image_per_value() {
    let folder = folder();
    let sheet = |vary: &str| {
        let arguments = ["sheet", "fence", "--vary", vary, "--size", "96x54", "--backend", "cpu", "-o", "sheet.png"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        haze_core::assets::image::read_png(&folder.path().join("sheet.png")).unwrap().to_rgb8()
    };
    // Two images per row, the last cell empty.
    let image = sheet("accumulate.downscale=1,4,16");
    let cell = |x: u32, y: u32| image::imageops::crop_imm(&image, 12 + x * 60, 40 + y * 67, 48, 27).to_image();
    let cells = [cell(0, 0), cell(1, 0), cell(0, 1), cell(1, 1)];
    for (i, a) in cells.iter().enumerate() {
        assert!(cells[..i].iter().all(|b| a != b), "{i}");
    }
    assert!(cells[3].pixels().all(|pixel| *pixel == cells[3][(0, 0)]));
    // Values of three numbers.
    sheet("lights[0].color=1,0,0;0,1,0");
    let line = refusal(folder.path(), &["sheet", "--vary", "emitter.seed=1,b", "-o", "a.png"]);
    assert!(line.contains("--vary emitter.seed: \"b\" is not valid"), "{line}");
}

#[test]
fn each_frame_is_written_to_its_own_file() {
    let folder = folder();
    let run = |arguments: &[&str]| {
        let output = haze(folder.path(), &[&SMALL[..], arguments].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    };
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    run(&["f_%03d.png", "--frames", "9..11", "--rate", "2", "--time", "4"]);
    run(&["one.png", "--time", "9"]);
    assert_eq!(read("f_010.png"), read("one.png"));
    assert_ne!(read("f_009.png"), read("f_011.png"));
    assert!(!folder.path().join("f_%03d.png").exists());
    // The same frames on one sheet, row by row.
    run(&["flipbook.png", "--frames", "9..11", "--rate", "2", "--time", "4", "--sheet", "2x2"]);
    assert_eq!(size_of(&folder.path().join("flipbook.png")), (64, 36));
    let rendered = |name: &str| haze_core::assets::image::read_png(&folder.path().join(name)).unwrap().to_rgb8();
    let flipbook = rendered("flipbook.png");
    assert_eq!(image::imageops::crop_imm(&flipbook, 0, 18, 32, 18).to_image(), rendered("f_011.png"));

    let line = |arguments: &[&str]| refusal(folder.path(), &[&SMALL[..], arguments].concat());
    assert!(line(&["f.png", "--frames", "0..3"]).contains("expected a name with one place for the frame number"));
    assert!(line(&["f_%d.png", "--frames", "-1..2"]).contains("--frames"));
    assert!(line(&["f_%d.png", "--frames", "0..2", "--rate", "-1"]).contains("--rate"));
    assert!(line(&["f_%d.png", "--frames", "3..0"]).contains("is not a range of frames; expected A..B"));
    assert!(line(&["f.png", "--frames", "0..9", "--sheet", "3x3"]).contains("expected at least 10 cells"));
    let huge =
        ["render", "--size", "8000x8000", "--frames", "0..1", "--sheet", "64x64", "--backend", "cpu", "-o", "f.png"];
    let huge = refusal(folder.path(), &huge);
    assert!(
        huge.contains("--sheet: 64x64 cells make a sheet of 512000x512000 pixels; expected at most 32768"),
        "{huge}"
    );
    assert!(line(&["missing/%d.png", "--frames", "0..1"]).contains("a folder that exists"));
    assert!(line(&["f.png", "--sheet", "3x3"]).contains("--frames"));
}

#[test]
fn smoke_is_written_alone() {
    let folder = folder();
    let run = |arguments: &[&str]| {
        let output = haze(folder.path(), &[&SMALL[..], arguments, &["--transparent"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    };
    let rendered = |name: &str| haze_core::assets::image::read_png(&folder.path().join(name)).unwrap();
    run(&["one.png", "--time", "9"]);
    let one = rendered("one.png");
    assert!(one.color().has_alpha());
    let one = one.to_rgba8();
    let opacities = || one.pixels().map(|pixel| pixel.0[3]);
    assert!(opacities().min() == Some(0) && opacities().max() > Some(200));
    run(&["flipbook.png", "--time", "9", "--frames", "0..1", "--sheet", "1x2"]);
    let flipbook = rendered("flipbook.png").to_rgba8();
    assert_eq!(image::imageops::crop_imm(&flipbook, 0, 0, 32, 18).to_image(), one);
    run(&["f_%d.exr", "--frames", "0..1"]);
    let bytes = ["f_0.exr", "f_1.exr"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert!(bytes.iter().all(|bytes| bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])) && bytes[0] != bytes[1]);

    let line = |arguments: &[&str]| refusal(folder.path(), &[&SMALL[..], arguments, &["--transparent"]].concat());
    assert!(line(&["a.gif", "--frames", "0..1"]).contains("a GIF has no partial opacity; expected a PNG or EXR"));
    assert!(line(&["a.exr", "--frames", "0..1", "--sheet", "1x2"]).contains("a name that ends in .png"));
    assert!(line(&["a.png", "--view", "amount"]).contains("--view amount shows no scene; expected --view final"));
}

#[test]
fn frames_are_written_to_a_gif() {
    use image::AnimationDecoder as _;
    let folder = folder();
    let output = haze(folder.path(), &[&SMALL[..], &["a.gif", "--frames", "0..6", "--rate", "30"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let bytes = fs::read(folder.path().join("a.gif")).unwrap();
    let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    let milliseconds: u32 = frames.iter().map(|frame| frame.delay().numer_denom_ms().0).sum();
    // Seven frames at 30 frames per second, rounded to hundredths of a second.
    assert_eq!((frames.len(), milliseconds), (7, 230));
    assert!(frames[0].buffer() != frames[6].buffer());
    let refused = |more: &[&str]| refusal(folder.path(), &[&SMALL[..], more].concat());
    let line = refused(&["b.gif", "--frames", "0..6", "--rate", "60"]);
    assert!(line.contains("--rate: 60 is not valid; expected at most 50"), "{line}");
    assert!(refused(&["b.gif"]).contains("a name that ends in .png"));
    assert!(!folder.path().join("b.gif").exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_sequence_leaves_complete_files_and_says_so() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let arguments = [&SMALL[..], &["f_%04d.png", "--frames", "0..9999"]].concat();
    let mut command = Command::new(env!("CARGO_BIN_EXE_haze"));
    let child = command.args(arguments).current_dir(folder.path()).stderr(Stdio::piped()).spawn().unwrap();
    let start = std::time::Instant::now();
    while !folder.path().join("f_0002.png").exists() {
        assert!(start.elapsed().as_secs() < 60);
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(1), 1), "{text}");
    let count = fs::read_dir(folder.path()).unwrap().count();
    let said = format!("f_{count:04}.png: stopped: not written; this sequence is partial, {count} of 10000 frames");
    assert!(text.contains(&said), "{count}: {text}");
    for entry in fs::read_dir(folder.path()).unwrap() {
        assert_eq!(size_of(&entry.unwrap().path()), (32, 18));
    }
}
