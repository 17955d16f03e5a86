//! Command line: results and error messages.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/drivers.rs"]
mod drivers;
#[path = "cli/many.rs"]
mod many;
#[path = "cli/names.rs"]
mod names;
#[path = "cli/outputs.rs"]
mod outputs;
#[path = "cli/particles.rs"]
mod particles;
#[path = "cli/ramps.rs"]
mod ramps;
#[path = "cli/shaders.rs"]
mod shaders;
#[path = "cli/sprites.rs"]
mod sprites;
#[path = "cli/streams.rs"]
mod streams;
#[path = "cli/watch.rs"]
mod watch;

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

use haze::settings::DebugView;
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
    let picture = haze::image::read_png(path).unwrap();
    (picture.width(), picture.height())
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
    let picture = |arguments: &[&str]| {
        let output = render(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        std::fs::read(folder.path().join("out.png")).unwrap()
    };
    let plain = picture(&[]);
    assert_eq!(plain, picture(&["column"]), "the same command makes the same bytes");
    let changes: [&[&str]; 6] = [
        &["--time", "3"],
        &["--scale", "8"],
        &["--seed", "9"],
        &["--view", "normals"],
        &["--path", "forward"],
        &["fence"],
    ];
    for change in changes {
        assert_ne!(plain, picture(change), "{change:?}");
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
        ("--view", "colour", "final, combined, diffuse"),
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
fn bad_presets_are_refused_with_file_and_place() {
    let folder = folder();
    let message = |text: &str| {
        std::fs::write(folder.path().join("my.json"), text).unwrap();
        refusal(folder.path(), &["render", "-o", "a.png", "my.json"])
    };
    let preset = |inside: &str| format!("{{\"version\": 1, \"name\": \"x\",\n{inside}}}");
    assert!(message("").starts_with("haze: my.json:1:1: the file ends where a value should be"));
    assert!(message("{\n\"version\": 1,\n\"nmae\": 2}").contains("my.json:3:6: unknown field `nmae`"));
    assert!(message("{\"version\": 7}").contains("my.json:1:2: version 7 is newer"));
    let range = message(&preset("\"time\": 1e9"));
    assert!(range.contains("my.json: time: 1000000000 is not valid; expected -100000 to 100000 s"), "{range}");
    let system = |inside: &str| preset(&format!("\"systems\": [{{\"name\": \"s\", {inside}}}]"));
    let escape = message(&system("\"material\": {\"sprite\": \"../secret.png\"}"));
    assert!(escape.contains("my.json: systems[0].material.sprite: \"../secret.png\" is not valid"), "{escape}");
    let missing = message(&system("\"material\": {\"sprite\": \"wisp2.png\"}"));
    assert!(missing.contains("wisp2.png: No such file"), "{missing}");
    std::fs::write(folder.path().join("text.png"), "not a picture").unwrap();
    let broken = message(&system("\"material\": {\"diffuse_ramp\": \"text.png\"}"));
    assert!(broken.contains("text.png: not a PNG file"), "{broken}");
    assert!(refusal(folder.path(), &["render", "-o", "a.png", "none.json"]).contains("none.json: No such file"));
}

#[test]
fn a_preset_finds_files_in_its_folder() {
    let folder = folder();
    let sprites = folder.path().join("shots");
    std::fs::create_dir(&sprites).unwrap();
    std::fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sprites/wisp.png"), sprites.join("mine.png")).unwrap();
    let material = "\"material\": {\"sprite\": \"mine.png\", \"columns\": 4, \"rows\": 2}";
    let text = format!("{{\"version\": 1, \"name\": \"x\", \"systems\": [{{\"name\": \"s\", {material}}}]}}");
    std::fs::write(sprites.join("my.json"), text).unwrap();
    let output = render(folder.path(), &["shots/my.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
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
fn shade_tree_sheet_shows_every_stage() {
    let folder = folder();
    let output = haze(folder.path(), &["shade-tree", "--size", "192x108", "--backend", "cpu", "-o", "sheet.png"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let sheet = haze::image::read_png(&folder.path().join("sheet.png")).unwrap().to_rgb8();
    // Every stage is on the sheet as `haze render --view` renders it, in three rows of three.
    let mut corners = BTreeSet::new();
    for stage in DebugView::ALL {
        let output = render(folder.path(), &["--view", stage.name()]);
        assert!(output.status.success(), "{}", stderr(&output));
        let alone = haze::image::read_png(&folder.path().join("out.png")).unwrap().to_rgb8();
        let is_at =
            |x: u32, y: u32| alone.enumerate_pixels().all(|(dx, dy, pixel)| sheet.get_pixel(x + dx, y + dy) == pixel);
        let (right, bottom) = (sheet.width() - alone.width(), sheet.height() - alone.height());
        let corner = (0..=bottom).find_map(|y| (0..=right).find(|&x| is_at(x, y)).map(|x| (x, y)));
        corners.insert(corner.unwrap_or_else(|| panic!("no {} on the sheet", stage.name())));
    }
    let distinct = |list: Vec<u32>| list.into_iter().collect::<BTreeSet<_>>().len();
    let columns = distinct(corners.iter().map(|corner| corner.0).collect());
    let rows = distinct(corners.iter().map(|corner| corner.1).collect());
    assert_eq!((corners.len(), columns, rows), (9, 3, 3));
}

#[test]
fn recipes_are_baked_to_images_beside_them() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let stops = r##"[{"at": 0, "colour": "#000000"}, {"at": 1, "colour": "#ff8000"}]"##;
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
fn presets_are_listed_checked_and_described() {
    let folder = folder();
    let text = |arguments: &[&str]| {
        let output = haze(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(text(&["preset", "list"]).lines().count() >= 6);
    assert_eq!(text(&["preset", "check", "column", "inside"]), "column: good\ninside: good\n");
    let idle = r#"{"version": 1, "name": "x", "systems": [{"name": "s", "settings": {"blend_mode": "additive", "boost": 2}}]}"#;
    std::fs::write(folder.path().join("idle.json"), idle).unwrap();
    let note = "idle.json: good\n  systems[0].settings.blend_mode has no effect: forward only\n";
    assert_eq!(text(&["preset", "check", "idle.json"]), note);
    let shown = text(&["preset", "show", "idle.json"]);
    let line = |field: &str| shown.lines().find(|line| line.starts_with(&format!("systems[0].{field} "))).unwrap();
    assert!(line("settings.boost").ends_with(" 2.0                    default 3.0"), "{shown}");
    assert!(line("settings.accumulate.scale").ends_with(" 2                      default"), "{shown}");
    assert!(line("settings.blend_mode").ends_with("default \"alpha\"; no effect: forward only"), "{shown}");
    assert_eq!(text(&["preset", "show", "--changed", "idle.json"]).lines().count(), 4);
    assert!(text(&["preset", "schema"]).contains("\"soft_fade\""));
    let info = text(&["info"]);
    assert!(info.contains("gpu: ") && info.contains("choices of path auto"), "{info}");
    let reasons: Vec<_> = info.lines().filter(|line| line.starts_with("  ")).collect();
    let is_reason = |line: &&str| line.contains(": about ") && line.contains("probe") || line.contains("no path tiled");
    assert!(!reasons.is_empty() && reasons.iter().all(is_reason), "{info}");
    assert!(text(&["--help"]).contains("shade-tree"));
}

#[test]
fn preset_new_copies_a_preset_with_its_images() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(path("theirs")).unwrap();
    image::RgbImage::from_pixel(8, 1, image::Rgb([9; 3])).save(path("theirs/own.png")).unwrap();
    let text = r#"{"version": 1, "name": "x", "systems": [{"name": "s", "material": {"diffuse_ramp": "own.png"}}]}"#;
    std::fs::write(path("theirs/first.json"), text).unwrap();
    let done = |arguments: &[&str]| {
        let output = haze(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
    };
    done(&["preset", "new", "mine", "--from", "theirs/first.json"]);
    done(&["preset", "check", "mine.json"]);
    assert!(std::fs::read_to_string(path("mine.json")).unwrap().contains("\"name\": \"mine\""));
    assert!(path("own.png").exists());
    let again = refusal(folder.path(), &["preset", "new", "mine"]);
    assert!(again.contains("mine.json") && again.contains("no file is replaced"), "{again}");
    assert!(refusal(folder.path(), &["preset", "new", "a.png"]).contains("ends in .json"));
    // Another image of that name exists.
    image::RgbImage::from_pixel(8, 1, image::Rgb([7; 3])).save(path("own.png")).unwrap();
    assert!(refusal(folder.path(), &["preset", "new", "b", "--from", "theirs/first.json"]).contains("own.png"));
    assert!(!path("b.json").exists());
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
fn images_are_found_in_the_shared_assets_folder() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(path("team")).unwrap();
    // A glow is wrong as a diffuse ramp.
    let glow = |x, y| image::Rgb([((63 - x) * (y + 1) / 2) as u8; 3]);
    image::RgbImage::from_fn(64, 8, glow).save(path("team/glow.png")).unwrap();
    let text = r#"{"version": 1, "name": "x", "systems": [{"name": "s", "material":
        {"diffuse_ramp": "glow.png", "age_ramp": "glwo.png", "noise": "fmb.png"}}]}"#;
    std::fs::write(path("my.json"), text).unwrap();
    let check = |arguments: &[&str]| {
        let output = haze(folder.path(), &[&["preset", "check", "my.json"], arguments].concat());
        (output.status.code(), stderr(&output), String::from_utf8(output.stdout).unwrap())
    };
    let (code, said, notes) = check(&[]);
    // All errors in the order of the fields; notes are printed too.
    let lines: Vec<_> = said.lines().collect();
    assert_eq!((code, lines.len()), (Some(2), 3), "{said}");
    let idle = "my.json: bad\n  systems[0].material.age_ramp has no effect: forward only\n  systems[0].material.noise has no effect: ";
    assert!(notes.starts_with(idle) && notes.lines().count() == 3, "{notes}");
    assert!(lines[0].contains("systems[0].material.diffuse_ramp: glow.png: No such file in "), "{said}");
    let (_, said, notes) = check(&["--assets", "team"]);
    assert!(notes.contains("  systems[0].material.diffuse_ramp: glow.png: black where it faces the light"), "{notes}");
    assert!(said.lines().count() == 2 && said.contains("the nearest name is \"glow.png\""), "{said}");
    std::fs::write(path("my.json"), text.replace("glwo", "glow").replace("fmb.png", "fbm")).unwrap();
    let (code, said, doubts) = check(&["--assets", "team"]);
    assert_eq!((code, said.as_str()), (Some(0), ""), "{said}");
    assert!(
        doubts.contains("  systems[0].material.diffuse_ramp: glow.png: black where it faces the light"),
        "{doubts}"
    );
    let render = ["render", "my.json", "--size", "32x18", "--backend", "cpu", "-o", "a.png"];
    assert!(haze(folder.path(), &[&render[..], &["--assets", "team"]].concat()).status.success());
    assert!(refusal(folder.path(), &[&render[..], &["--assets", "none"]].concat()).contains("--assets: none"));
}

#[test]
fn techniques_sheet_shows_every_technique_with_its_cost() {
    let folder = folder();
    for backend in ["cpu", "gpu"] {
        let arguments = ["techniques", "--size", "128x72", "--backend", backend, "-o", "t.png", "--curves", "c.png"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        // Two columns of 64 pixels, five rows of 36, with margins, labels and lines below.
        let (width, height) = size_of(&folder.path().join("t.png"));
        let foot = height - (5 * (36 + 12 + 28) + 12);
        assert!(width == 2 * (64 + 12) + 12 && foot >= 24 && foot.is_multiple_of(24), "{width}x{height}");
        assert_eq!(size_of(&folder.path().join("c.png")), (800, 360));
    }
    let help = String::from_utf8(haze(folder.path(), &["techniques", "--help"]).stdout).unwrap();
    assert!(help.contains("Twice the size of an image on the sheet"), "{help}");
    let unknown = refusal(folder.path(), &["render", "--technique", "softest", "-o", "a.png"]);
    assert!(unknown.contains("volumetric_soft"), "{unknown}");
}

#[test]
fn without_visible_smoke_costs_are_left_out() {
    let folder = folder();
    let run = |time: &str| {
        let arguments =
            ["techniques", "explosion", "--size", "400x40", "--backend", "cpu", "--time", time, "-o", "t.png"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        let sheet = haze::image::read_png(&folder.path().join("t.png")).unwrap().to_rgb8();
        // Right of the name of the first cell, `hard`, and above its image.
        let costs = image::imageops::crop_imm(&sheet, 70, 12, 130, 28).to_image();
        let paper = *sheet.get_pixel(0, 0);
        (stderr(&output), costs.pixels().any(|pixel| *pixel != paper))
    };
    assert_eq!(run("0.5"), (String::new(), true));
    assert_eq!(run("1000"), ("haze: no smoke is visible: costs are left out\n".into(), false));
}

#[test]
fn nv_experiment_prints_the_papers_figures_beside_its_own() {
    let folder = folder();
    let output = haze(folder.path(), &["bench", "soft-particles", "--loops", "2", "--rounds", "1", "--size", "64x36"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = String::from_utf8(output.stdout).unwrap();
    let paper = [("hard", "34.6", "1.00"), ("soft", "13.3", "2.60"), ("soft_linear", "26.7", "1.30")];
    for source in ["reduced", "host"] {
        for (technique, fps, ratio) in paper {
            let rows = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
            let row = rows.into_iter().find(|row| row[..2] == [source, technique]).unwrap();
            assert_eq!(row[5..], [fps, ratio], "{table}");
            assert_eq!(row[3], "-", "one round has no spread: {table}");
            assert!(row[2].parse::<f64>().unwrap() > 0.0, "{table}");
        }
    }
    assert!(table.contains("one round"), "{table}");
    for bad in [["--loops", "0"], ["--loops", "-1"], ["--rounds", "x"]] {
        refusal(folder.path(), &[&["bench", "soft-particles"][..], &bad].concat());
    }
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

#[test]
fn preset_check_refuses_a_preset_that_cannot_be_rendered() {
    let folder = folder();
    let preset = |material: &str, technique: &str| {
        let text = format!(
            r#"{{"version": 1, "name": "x", "systems": [{{"name": "s", "material": {material},
                "settings": {{"technique": "{technique}"}}}}]}}"#
        );
        std::fs::write(folder.path().join("own.json"), text).unwrap();
        refusal(folder.path(), &["preset", "check", "own.json"])
    };
    let sprite = image::RgbaImage::new(16, 16);
    sprite.save(folder.path().join("mine.png")).unwrap();
    let lacks = preset(r#"{"sprite": "mine.png"}"#, "depth_sprite_soft");
    assert!(lacks.starts_with("haze: own.json: systems[0].settings.technique"), "{lacks}");
    let ignored = preset(r#"{"detail": "mine.png"}"#, "soft");
    assert!(ignored.contains("material.detail") && ignored.contains("has its own"), "{ignored}");
    let columns = preset(r#"{"columns": 0}"#, "soft");
    assert!(columns.contains("systems[0].material.columns: 0 is not valid; expected 1 to 256 frames"), "{columns}");
    let ignored = preset(r#"{"columns": 2}"#, "soft");
    assert!(ignored.contains("material.columns and rows: 2x1"), "{ignored}");
    let ignored = preset(r#"{"y_down": true}"#, "soft");
    assert!(
        ignored.contains("systems[0].material.y_down: true is not valid; expected false with a built-in"),
        "{ignored}"
    );
    let missing = preset(r#"{"noise": "none.png"}"#, "soft");
    assert!(missing.contains("own.json: systems[0].material.noise: none.png: "), "{missing}");
    let outside = preset(r#"{"sprite": "mine.png", "detail": "../x.png"}"#, "soft");
    assert!(outside.contains("expected a PNG inside the preset's folder"), "{outside}");
}
