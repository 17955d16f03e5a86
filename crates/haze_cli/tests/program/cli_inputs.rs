//! Input files on the command line: a bad file is refused at once, in one line that says which file it is, what is
//! wrong and what would be right.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use image::{DynamicImage, GrayImage, ImageFormat, RgbImage};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// Timeout. Nothing here takes a second; waiting for a pipe would never end.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Runs a command that must be refused with exit code 2, and returns its one line on stderr.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let mut child: Child = Command::new(env!("CARGO_BIN_EXE_haze"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > TIMEOUT {
            child.kill().unwrap();
            panic!("{arguments:?} does not end");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
    text.trim_end().to_owned()
}

/// Returns the refusal of a preset whose systems have these contents besides their names.
fn preset(folder: &Path, systems: &[&str]) -> String {
    let systems: Vec<_> = systems.iter().map(|inside| format!("{{\"name\": \"s\", {inside}}}")).collect();
    let text = format!("{{\"version\": 1, \"name\": \"x\",\n\"systems\": [{}]}}", systems.join(", "));
    std::fs::write(folder.join("my.json"), text).unwrap();
    refusal(folder, &["preset", "check", "my.json"])
}

/// Returns the refusal of a preset whose first system is valid and whose second one has this content.
fn system(folder: &Path, inside: &str) -> String {
    preset(folder, &["\"settings\": {}", inside])
}

#[test]
fn overlong_files_and_folders_are_refused() {
    let folder = folder();
    let refused = |name: &str| refusal(folder.path(), &["preset", "check", name]);
    std::fs::create_dir(folder.path().join("folder.json")).unwrap();
    assert_eq!(
        refused("folder.json"),
        "haze: folder.json: a folder, not a file; expected a JSON file of at most 1048576 bytes (1 MiB)"
    );
    File::create(folder.path().join("long.json")).unwrap().set_len(100 << 20).unwrap();
    assert_eq!(
        refused("long.json"),
        "haze: long.json: 104857600 bytes; expected a JSON file of at most 1048576 bytes (1 MiB)"
    );
    for (command, recipe) in [("ramp", "a.ramp.json"), ("ramp", "a.motif.json"), ("sprite", "a.noise.json")] {
        // Ramp recipes may be longer, because they may have many stops.
        let most = if recipe == "a.ramp.json" { 16 } else { 1 };
        File::create(folder.path().join(recipe)).unwrap().set_len((most + 1) << 20).unwrap();
        assert!(refusal(folder.path(), &[command, "bake", recipe]).contains(&format!("({most} MiB)")));
    }
    // A sparse file, which takes no room on the disk.
    File::create(folder.path().join("long.png")).unwrap().set_len(3 << 30).unwrap();
    assert_eq!(
        system(folder.path(), "\"material\": {\"motif\": \"long.png\"}"),
        "haze: my.json: systems[1].material.motif: long.png: 3221225472 bytes; \
         expected a PNG file of at most 67108864 bytes (64 MiB)"
    );
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_without_waiting() {
    let folder = folder();
    for name in ["pipe.json", "pipe.png"] {
        assert!(Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    }
    let refused = |name: &str| refusal(folder.path(), &["preset", "check", name]);
    assert!(refused("pipe.json").starts_with("haze: pipe.json: a pipe, not a file; expected a JSON file"));
    assert!(refused("/dev/zero").starts_with("haze: /dev/zero: a device, not a file; expected a JSON file"));
    let image = system(folder.path(), "\"material\": {\"sprite\": \"pipe.png\"}");
    assert!(image.starts_with("haze: my.json: systems[1].material.sprite: pipe.png: a pipe, not a file"), "{image}");
}

#[test]
fn images_have_a_limit_each_and_a_limit_in_total() {
    let folder = folder();
    let save = |name: &str, image: DynamicImage| {
        image.save_with_format(folder.path().join(name), ImageFormat::Png).unwrap();
    };
    save("deep.png", DynamicImage::new_rgb16(4096, 4096));
    assert_eq!(
        system(folder.path(), "\"material\": {\"age_ramp\": \"deep.png\"}"),
        "haze: my.json: systems[1].material.age_ramp: deep.png: \
         96 MiB in memory, 4096x4096 pixels of 6 bytes; expected at most 64 MiB"
    );
    save("wide.png", RgbImage::new(5000, 1).into());
    let wide = system(folder.path(), "\"material\": {\"age_ramp\": \"wide.png\"}");
    assert!(wide.ends_with("wide.png: 5000x1 pixels; expected at most 4096x4096"), "{wide}");
    // 128 MiB as half floats, for each of nine fields.
    save("large.png", GrayImage::new(4096, 4096).into());
    let ramps = |names: &[&str]| {
        let fields: Vec<_> = names.iter().map(|name| format!("\"{name}\": \"large.png\"")).collect();
        format!("\"material\": {{{}}}", fields.join(", "))
    };
    let five = ramps(&["diffuse_ramp", "soft_scatter_ramp", "specular_ramp", "motif", "age_ramp"]);
    let four = ramps(&["diffuse_ramp", "soft_scatter_ramp", "specular_ramp", "motif"]);
    assert_eq!(
        preset(folder.path(), &[&five, &four]),
        "haze: my.json: systems[1].material.motif: up to this one, the images of the preset take \
         1152 MiB; expected at most 1024 MiB, each image counted as often as it is named"
    );
}

#[test]
fn files_that_are_not_json_are_refused_with_their_kind() {
    let folder = folder();
    let said = |bytes: &[u8]| {
        std::fs::write(folder.path().join("a.json"), bytes).unwrap();
        refusal(folder.path(), &["preset", "check", "a.json"])
    };
    let text = "{\"version\": 1}";
    let utf16 = |bytes_of: fn(u16) -> [u8; 2]| {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes_of).collect()
    };
    let little: Vec<u8> = utf16(u16::to_le_bytes);
    let big: Vec<u8> = utf16(u16::to_be_bytes);
    for bytes in [little, big] {
        assert_eq!(said(&bytes), "haze: a.json:1:1: text in UTF-16; expected JSON as UTF-8 text");
    }
    let mut png = Vec::new();
    DynamicImage::new_rgb8(1, 1).write_to(&mut std::io::Cursor::new(&mut png), ImageFormat::Png).unwrap();
    assert_eq!(said(&png), "haze: a.json:1:1: a PNG image; expected JSON as UTF-8 text");
    assert_eq!(said(b"{\n \"name\": \"caf\xe9\"}"), "haze: a.json:2:14: not UTF-8; expected JSON as UTF-8 text");
    // A byte order mark is no mistake: what is missing is the name.
    assert_eq!(said(format!("\u{feff}{text}").as_bytes()), "haze: a.json:1:14: missing field `name`");
}

#[test]
fn errors_name_the_system_and_the_field() {
    let folder = folder();
    let said = |inside: &str| system(folder.path(), inside);
    assert_eq!(
        said("\"settings\": {\"soft_fade\": {\"fade_scale\": \"wide\"}}"),
        "haze: my.json:2:104: systems[1].settings.soft_fade.fade_scale: \"wide\" is not valid; expected a number"
    );
    assert_eq!(
        said("\"material\": {\"columns\": true}"),
        "haze: my.json:2:85: systems[1].material.columns: true is not valid; expected a whole number, 0 to 4294967295"
    );
    let image = |inside: &str| said(&format!("\"material\": {{\"columns\": 2, {inside}}}"));
    let missing = image("\"sprite\": \"none.png\"");
    assert!(missing.starts_with("haze: my.json: systems[1].material.sprite: none.png: No such file"), "{missing}");
    RgbImage::new(64, 48).save(folder.path().join("own.png")).unwrap();
    assert_eq!(
        image("\"sprite\": \"own.png\""),
        "haze: my.json: systems[1].material.sprite: own.png: 64x48 pixels do not divide into 2x1 square frames; \
         expected columns and rows that give square frames"
    );
    let own = std::fs::read(folder.path().join("own.png")).unwrap();
    for (length, change, expected) in [
        (own.len() / 2, None, "the file ends too early; expected a whole PNG"),
        (20, None, "the file ends too early; expected a whole PNG"),
        (own.len(), Some(12), "a damaged PNG; expected one that other programs can open: export it again"),
        (own.len(), Some(29), "a damaged PNG; expected one that other programs can open: export it again"),
        (own.len(), Some(45), "a damaged PNG; expected one that other programs can open: export it again"),
    ] {
        let mut bytes = own[..length].to_vec();
        if let Some(at) = change {
            bytes[at] ^= 0x20;
        }
        std::fs::write(folder.path().join("broken.png"), bytes).unwrap();
        assert_eq!(
            said("\"material\": {\"noise\": \"broken.png\"}"),
            format!("haze: my.json: systems[1].material.noise: broken.png: {expected}")
        );
    }
}

#[test]
fn file_names_cannot_forge_a_message() {
    let folder = folder();
    let forged = system(folder.path(), r#""material": {"sprite": "a\nhaze: \u001b[2Jgood\u202e.png"}"#);
    assert!(
        forged.starts_with(
            r"haze: my.json: systems[1].material.sprite: a\nhaze: \u{1b}[2Jgood\u{202e}.png: No such file"
        ),
        "{forged}"
    );
    let preset = refusal(folder.path(), &["preset", "check", "a\nb\u{1b}.json"]);
    assert!(preset.starts_with(r"haze: a\nb\u{1b}.json: No such file"), "{preset}");
}
