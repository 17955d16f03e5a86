//! `haze ramp sheet`.

use std::fs;

use super::ramps::stdout_of;
use super::{folder, haze, refusal, stderr};

#[test]
fn ramp_sheet_renders_a_shot_with_every_ramp_of_a_folder() {
    let folder = folder();
    let new = |template: &str, name: &str| {
        stdout_of(folder.path(), &["ramp", "new", "--template", template, "-o", &format!("ramps/{name}.ramp.json")]);
    };
    fs::create_dir(folder.path().join("ramps")).unwrap();
    new("soot", "diffuse_soot");
    new("sunset_backlight", "mine");
    new("wide_glow", "specular_wide");
    // This recipe has a PNG already, which is what is loaded.
    stdout_of(folder.path(), &["ramp", "bake", "ramps/mine.ramp.json"]);
    fs::write(folder.path().join("ramps/mine.ramp.json"), "{").unwrap();
    fs::write(folder.path().join("ramps/notes.txt"), "").unwrap();
    let sheet = |arguments: &[&str]| {
        let fixed = ["ramp", "sheet", "fence", "--backend", "cpu", "-o", "sheet.png"];
        stdout_of(folder.path(), &[&fixed[..], arguments].concat());
        haze_core::assets::image::read_png(&folder.path().join("sheet.png")).unwrap().to_rgb8()
    };
    // The image above the strip of the ramp.
    let above = |image: &image::RgbImage, x, y| image::imageops::crop_imm(image, x, y, 48, 25).to_image();
    let render = |sets: &[&str]| {
        let fixed = ["render", "fence", "--backend", "cpu", "--size", "48x27", "--assets", "ramps", "-o", "one.png"];
        let sets: Vec<_> = sets.iter().flat_map(|set| ["--set", set]).collect();
        stdout_of(folder.path(), &[&fixed[..], &sets].concat());
        above(&haze_core::assets::image::read_png(&folder.path().join("one.png")).unwrap().to_rgb8(), 0, 0)
    };
    let cell = |sheet: &image::RgbImage, x: u32| above(sheet, 12 + x * 60, 40);
    // Two images per row, sorted by name.
    let diffuse = sheet(&["--ramps", "ramps", "--role", "diffuse", "--size", "96x54"]);
    stdout_of(folder.path(), &["ramp", "bake", "ramps/diffuse_soot.ramp.json"]);
    assert!(cell(&diffuse, 0) == render(&["diffuse_ramp=diffuse_soot.png"]));
    assert!(cell(&diffuse, 1) == render(&["diffuse_ramp=mine.png"]));
    // The strip of the ramp below: 2 of 27 lines.
    let below = |x: u32| diffuse[(12 + x * 60 + 47, 40 + 26)].0;
    assert_eq!([below(0), below(1)], [[0x6a, 0x61, 0x5a], [0xff, 0xe3, 0xb0]]);
    // Without a role: ramps whose names tell their role.
    let named = sheet(&["--ramps", "ramps", "--size", "96x54"]);
    assert!(cell(&named, 0) == cell(&diffuse, 0) && cell(&named, 1) != cell(&diffuse, 1));
    let arguments =
        ["ramp", "sheet", "fence", "--backend", "cpu", "--ramps", "ramps", "--size", "96x54", "-o", "sheet.png"];
    let note = stderr(&haze(folder.path(), &arguments));
    assert!(note.contains("mine.png: left out, because its name tells no role of a ramp; expected"), "{note}");
    // A ramp is used whatever mode the preset has.
    let coverage = sheet(&["--role", "coverage", "--size", "96x54"]);
    assert!(cell(&coverage, 1) == render(&["systems.settings.coverage=ramp", "coverage_ramp=coverage_toon"]));
    assert!(cell(&coverage, 0) != cell(&coverage, 1));

    // A broken ramp does not stop the others.
    fs::write(folder.path().join("ramps/diffuse_broken.png"), "no image").unwrap();
    let arguments = ["ramp", "sheet", "fence", "--backend", "cpu", "--ramps", "ramps", "--role", "diffuse"];
    let output = haze(folder.path(), &[&arguments[..], &["--size", "96x54", "-o", "sheet.png"]].concat());
    assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(1), 1), "{}", stderr(&output));
    assert!(stderr(&output).contains("diffuse_broken.png: not a PNG"), "{}", stderr(&output));
    let left = haze_core::assets::image::read_png(&folder.path().join("sheet.png")).unwrap().to_rgb8();
    assert!(cell(&left, 0) == cell(&diffuse, 0) && cell(&left, 1) == cell(&diffuse, 1));

    let line = |arguments: &[&str]| refusal(folder.path(), &[&["ramp", "sheet", "fence"], arguments].concat());
    fs::create_dir(folder.path().join("broken")).unwrap();
    fs::rename(folder.path().join("ramps/diffuse_broken.png"), folder.path().join("broken/diffuse_broken.png"))
        .unwrap();
    assert!(line(&["--ramps", "broken", "-o", "a.png"]).contains("diffuse_broken.png: not a PNG"));
    assert!(line(&["--ramps", "gone", "-o", "a.png"]).starts_with("haze: gone: "));
    assert!(line(&["--ramps", "sheet.png", "-o", "a.png"]).contains("sheet.png is not valid; expected a folder"));
    let over = line(&["--ramps", "ramps", "--role", "diffuse", "-o", "ramps/mine.png"]);
    assert!(over.contains("is also an input; expected another file"), "{over}");
    fs::create_dir(folder.path().join("empty")).unwrap();
    let none = line(&["--ramps", "empty", "--role", "age", "-o", "a.png"]);
    assert!(none.contains("--ramps: empty has 0 ramps for age; expected 1 to 64"), "{none}");
}
