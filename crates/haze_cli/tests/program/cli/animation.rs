//! Presets whose settings change over time, on the command line.

use std::path::Path;

use super::{folder, haze, refusal, stderr};

/// A light that fades in two seconds, and a lamp of another scene.
const ANIMATED: &str = r#"{
  "version": 1, "name": "x", "environment": {"scene": "studio"},
  "lights": [{"kind": "directional", "direction": [0, -1, -1], "intensity": 3}],
  "animation": [
    {"setting": "lights[0].intensity", "keys": [{"time": 0, "value": 3, "ease": "linear"}, {"time": 2, "value": 0}]},
    {"setting": "environment.lamp", "keys": [{"time": 0, "value": true}]}
  ]
}"#;

fn render(folder: &Path, output: &str, options: &[&str]) -> image::RgbImage {
    let fixed = ["render", "my.json", "--size", "32x18", "--backend", "cpu", "-o", output];
    let done = haze(folder, &[&fixed, options].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    image::open(folder.join(output.replace("%02d", "02"))).unwrap().to_rgb8()
}

fn brightness(image: &image::RgbImage) -> u32 {
    image.pixels().map(|pixel| u32::from(pixel.0[1])).sum()
}

#[test]
fn images_sequences_and_sheets_show_the_values_of_their_times() {
    let folder = folder();
    let folder = folder.path();
    std::fs::write(folder.join("my.json"), ANIMATED).unwrap();
    let first = render(folder, "a.png", &[]);
    let at_one = render(folder, "b.png", &["--time", "1"]);
    let dark = render(folder, "c.png", &["--set", "time=5"]);
    assert!(brightness(&first) > brightness(&at_one) && brightness(&at_one) > brightness(&dark));
    // The third frame of a sequence is one second after the first.
    assert_eq!(render(folder, "f_%02d.png", &["--frames", "0..2", "--rate", "2"]), at_one);
    // A value that is set replaces the keyframes.
    assert_eq!(render(folder, "d.png", &["--time", "5", "--set", "lights[0].intensity=3"]), first);
    let sheet = ["sheet", "my.json", "--size", "64x36", "--backend", "cpu", "-o", "s.png", "--vary", "time=0,5"];
    let done = haze(folder, &sheet);
    assert!(done.status.success(), "{}", stderr(&done));
    let sheet = image::open(folder.join("s.png")).unwrap().to_rgb8();
    let half = |x| brightness(&image::imageops::crop_imm(&sheet, x, 0, sheet.width() / 2, sheet.height()).to_image());
    assert!(half(0) > half(sheet.width() / 2) + 1000, "{} {}", half(0), half(sheet.width() / 2));
}

#[test]
fn the_example_is_good() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/dusk.json");
    let checked = haze(folder().path(), &["preset", "check", path]);
    assert_eq!(String::from_utf8(checked.stdout).unwrap(), format!("{path}: good\n"));
}

#[test]
fn tracks_are_checked_and_shown() {
    let folder = folder();
    let folder = folder.path();
    let text = |arguments: &[&str]| {
        let output = haze(folder, arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    std::fs::write(folder.join("my.json"), ANIMATED).unwrap();
    let note = "environment.lamp has no effect: only in the yard";
    assert_eq!(text(&["preset", "check", "my.json"]), format!("my.json: good\n  {note}\n"));
    let shown = text(&["preset", "show", "my.json", "--changed"]);
    assert!(shown.contains("default 1.0; keyframes at 0, 2 s\n"), "{shown}");
    std::fs::write(folder.join("bad.json"), ANIMATED.replace("[0].intensity", "[0].intensty")).unwrap();
    let refused = refusal(folder, &["preset", "check", "bad.json"]);
    assert!(refused.contains("bad.json: animation[0].setting: \"lights[0].intensty\" is not valid"), "{refused}");
    // A light that the keyframes turn on later has an effect.
    let later = ANIMATED.replace("\"intensity\": 3", "\"intensity\": 0");
    std::fs::write(folder.join("later.json"), later).unwrap();
    assert_eq!(text(&["preset", "check", "later.json"]), format!("later.json: good\n  {note}\n"));
}
