//! Command line: results and error messages.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "cli/animation.rs"]
mod animation;
#[path = "cli/backdrop.rs"]
mod backdrop;
#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/drivers.rs"]
mod drivers;
#[path = "cli/exports.rs"]
mod exports;
#[cfg(target_os = "linux")]
#[path = "cli/limits.rs"]
mod limits;
#[path = "cli/many.rs"]
mod many;
#[path = "cli/names.rs"]
mod names;
#[path = "cli/odd_inputs.rs"]
mod odd_inputs;
#[path = "cli/outputs.rs"]
mod outputs;
#[path = "cli/particles.rs"]
mod particles;
#[path = "cli/presets.rs"]
mod presets;
#[path = "cli/ramp_sheet.rs"]
mod ramp_sheet;
#[path = "cli/ramps.rs"]
mod ramps;
#[path = "cli/shaders.rs"]
mod shaders;
#[path = "cli/sheets.rs"]
mod sheets;
#[path = "cli/special_targets.rs"]
mod special_targets;
#[path = "cli/sprite_read.rs"]
mod sprite_read;
#[path = "cli/sprites.rs"]
mod sprites;
#[path = "cli/streams.rs"]
mod streams;
#[path = "cli/systems.rs"]
mod systems;
#[path = "cli/watch.rs"]
mod watch;

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A recipe that bakes quickly.
const MOTIF: &str = r##"{"version": 1, "size": 8, "ambient": "#000000", "lights": []}"##;

fn haze(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_haze"))
        .args(arguments)
        .current_dir(folder)
        // Without this variable, a Mesa layer complains on stderr.
        .env("XDG_RUNTIME_DIR", folder)
        .output()
        .unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a command that must be refused with exit code 2, and returns its one line on stderr.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = haze(folder, arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert_eq!(text.lines().count(), 1, "{arguments:?}: {text}");
    text
}

fn render(folder: &Path, arguments: &[&str]) -> Output {
    let small = ["render", "--size", "64x36", "--backend", "cpu", "-o", "out.png"];
    haze(folder, &[&small[..], arguments].concat())
}

fn size_of(path: &Path) -> (u32, u32) {
    let image = haze_core::assets::image::read_png(path).unwrap();
    (image.width(), image.height())
}

#[test]
fn both_renderers_write_an_image_of_the_requested_size() {
    let folder = folder();
    for backend in ["cpu", "gpu", "auto"] {
        let output = haze(folder.path(), &["render", "--size", "65x37", "--backend", backend, "-o", "a.png"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output), "");
        assert_eq!(size_of(&folder.path().join("a.png")), (65, 37));
        std::fs::remove_file(folder.path().join("a.png")).unwrap();
    }
}

#[test]
fn every_option_changes_the_image() {
    let folder = folder();
    let image = |arguments: &[&str]| {
        let output = render(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        std::fs::read(folder.path().join("out.png")).unwrap()
    };
    let plain = image(&[]);
    assert_eq!(plain, image(&["column"]), "the same command makes the same bytes");
    let changes: [&[&str]; 6] = [
        &["--time", "3"],
        &["--scale", "8"],
        &["--seed", "9"],
        &["--view", "normals"],
        &["--path", "forward"],
        &["fence"],
    ];
    for change in changes {
        assert_ne!(plain, image(change), "{change:?}");
    }
}

#[test]
fn bad_values_are_refused_in_one_line_with_field_value_and_range() {
    let folder = folder();
    let line = |option: &str, value: &str| refusal(folder.path(), &["render", "-o", "a.png", option, value]);
    for (option, value, expected) in [
        ("--scale", "0", "1 to 16"),
        ("--scale", "17", "1 to 16"),
        ("--size", "0x720", "1 to 8192"),
        ("--size", "1280", "WxH"),
        ("--size", "9000x9000", "1 to 8192"),
        ("--time", "soon", "-100000 to 100000"),
        ("--size", "-1x3", "1 to 8192"),
        ("--time", "nan", "-100000 to 100000"),
        ("--time", "-inf", "-100000 to 100000"),
        ("--scale", "-a", "1 to 16"),
        ("--view", "color", "final, combined, diffuse"),
        ("--path", "tilde", "auto, raster, tiled, forward"),
        ("--backend", "tpu", "auto, gpu, cpu"),
        ("--seed", "-1", "0 to 4294967295"),
    ] {
        let line = line(option, value);
        assert!(line.contains(option) && line.contains(value) && line.contains(expected), "{line}");
    }
    assert!(refusal(folder.path(), &["render"]).contains("--output"));
    assert!(refusal(folder.path(), &["rendr"]).contains("rendr"));
    assert!(refusal(folder.path(), &["render", "-o", "a.png", "colunm"]).contains("column, backlit_fog"));
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn a_failed_render_keeps_the_old_image() {
    let folder = folder();
    assert!(render(folder.path(), &[]).status.success());
    let before = std::fs::read(folder.path().join("out.png")).unwrap();
    assert!(!render(folder.path(), &["none.json"]).status.success());
    assert_eq!(before, std::fs::read(folder.path().join("out.png")).unwrap());
    let output = haze(folder.path(), &["render", "--size", "8x8", "--backend", "cpu", "-o", "no/such/folder/a.png"]);
    assert!(!output.status.success() && stderr(&output).contains("no/such/folder/a.png"));
}

#[test]
fn without_an_adapter_the_cpu_renders_and_says_so() {
    let folder = folder();
    let blind = |backend: &str| {
        Command::new(env!("CARGO_BIN_EXE_haze"))
            .args(["render", "--size", "64x36", "--backend", backend, "-o", "a.png"])
            .current_dir(folder.path())
            // This system does not have the backend, which is the same as having no driver.
            .env("WGPU_BACKEND", if cfg!(target_os = "windows") { "metal" } else { "dx12" })
            .output()
            .unwrap()
    };
    let output = blind("auto");
    assert!(output.status.success());
    let text = stderr(&output);
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains("rendering on the CPU") && text.contains("mesa-vulkan-drivers"), "{text}");
    let on_cpu = std::fs::read(folder.path().join("a.png")).unwrap();
    assert!(render(folder.path(), &[]).status.success());
    assert_eq!(on_cpu, std::fs::read(folder.path().join("out.png")).unwrap());
    let refused = blind("gpu");
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("apt-get install mesa-vulkan-drivers"));
}

#[test]
fn recipes_are_baked_to_images_beside_them() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let stops = r##"[{"at": 0, "color": "#000000"}, {"at": 1, "color": "#ff8000"}]"##;
    write(
        "fire.ramp.json",
        &format!("{{\"version\": 1, \"width\": 32, \"height\": 1, \"rows\": [{{\"stops\": {stops}}}]}}"),
    );
    assert!(haze(folder.path(), &["ramp", "bake", "fire.ramp.json"]).status.success());
    assert_eq!(size_of(&folder.path().join("fire.png")), (32, 1));
    write("bad.ramp.json", "{\"version\": 1, \"width\": 1, \"height\": 1, \"rows\": []}");
    let line = refusal(folder.path(), &["ramp", "bake", "bad.ramp.json"]);
    assert!(line.contains("bad.ramp.json: width: 1 is not valid; expected 2 to 4096 texels"), "{line}");
    assert!(refusal(folder.path(), &["sprite", "bake", "fire.ramp.json"]).contains("*.sprite.json"));
}

#[test]
fn every_command_in_looks_md_renders_a_different_image() {
    let folder = folder();
    let mut made = std::collections::HashSet::new();
    for line in include_str!("../../../../docs/looks.md").lines().filter(|line| line.starts_with("haze ")) {
        let mut arguments: Vec<_> = line.split(' ').skip(1).collect();
        let output = arguments.pop().unwrap();
        assert!(output.starts_with("docs/pictures/looks/"), "{line}");
        let done = haze(folder.path(), &[&arguments[..], &["a.png", "--size", "48x27", "--backend", "cpu"]].concat());
        assert!(done.status.success(), "{line}: {}", stderr(&done));
        assert!(
            made.insert(std::fs::read(folder.path().join("a.png")).unwrap()),
            "{line}: the image of an earlier command"
        );
    }
    assert!(made.len() > 5);
}

#[test]
fn outputs_are_checked_before_anything_is_drawn_or_replaced() {
    let folder = folder();
    let preset = include_str!("../../../../presets/crates.json");
    std::fs::write(folder.path().join("own.json"), preset).unwrap();
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    std::fs::write(folder.path().join("old.png"), "old").unwrap();
    let refused = |output: &str| refusal(folder.path(), &["render", "own.json", "--size", "8x8", "-o", output]);
    assert!(refused("own.json").contains("ends in .png"));
    assert!(refused("folder.png").contains("a file, or a name that does not exist yet"));
    assert!(refused("missing/a.png").contains("a folder that exists"));
    // A sheet that cannot be written leaves the other outputs unchanged.
    let sheet = ["techniques", "--size", "8x8", "-o", "missing/a.png", "--curves", "old.png"];
    assert!(refusal(folder.path(), &sheet).contains("a folder that exists"));
    assert_eq!(std::fs::read_to_string(folder.path().join("old.png")).unwrap(), "old");
    assert_eq!(std::fs::read_to_string(folder.path().join("own.json")).unwrap(), preset);
    let ignored = ["techniques", "--technique", "soft", "-o", "a.png"];
    assert!(refusal(folder.path(), &ignored).contains("the sheet shows every technique"));
}

#[cfg(unix)]
#[test]
fn an_output_that_is_a_link_is_followed() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("pictures")).unwrap();
    std::os::unix::fs::symlink("pictures/real.png", folder.path().join("out.png")).unwrap();
    std::fs::write(folder.path().join("pictures/real.png"), "old").unwrap();
    assert!(render(folder.path(), &[]).status.success());
    assert!(folder.path().join("out.png").is_symlink());
    assert_eq!(size_of(&folder.path().join("pictures/real.png")), (64, 36));
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_or_full_stdout_does_not_panic() {
    let folder = folder();
    let run = |redirect: &str| {
        let line = format!("'{}' preset schema {redirect}", env!("CARGO_BIN_EXE_haze"));
        Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap()
    };
    let full = run("> /dev/full");
    assert_eq!((full.status.code(), stderr(&full).lines().count()), (Some(1), 1), "{}", stderr(&full));
    assert!(stderr(&full).starts_with("haze: standard output: "), "{}", stderr(&full));
    assert_eq!(stderr(&run("| true")), "");
}
