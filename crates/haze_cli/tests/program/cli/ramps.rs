//! `haze ramp`: the authoring commands.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
#[cfg(target_os = "linux")]
use std::process::Command;
use std::time::{Duration, Instant};

use haze_author::ramp::template::TEMPLATES;
use haze_core::assets::ramp::RampRole;
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA};

use super::{folder, haze, refusal, stderr};

#[test]
fn a_ramp_of_very_many_stops_bakes_quickly() {
    let folder = folder();
    let recipe = |rows: u32, stops: u32, height: u32| {
        let mut text = format!(r#"{{"version": 1, "width": 256, "height": {height}, "rows": ["#);
        for row in 0..rows {
            let _ =
                write!(text, r#"{}{{"at": {}, "stops": ["#, if row > 0 { "," } else { "" }, row as f32 / rows as f32);
            for stop in 0..stops {
                let at = stop as f32 / stops as f32;
                let color = (row * 7919 + stop * 104_729) % 0x100_0000;
                let _ = write!(text, r##"{}{{"at": {at}, "color": "#{color:06x}"}}"##, if stop > 0 { "," } else { "" });
            }
            text += "]}";
        }
        text + "]}"
    };
    fs::write(folder.path().join("wide.ramp.json"), recipe(100, 1000, 256)).unwrap();
    fs::write(folder.path().join("long.ramp.json"), recipe(1, 10_000, 1)).unwrap();
    let started = Instant::now();
    let output = haze(folder.path(), &["ramp", "bake", "wide.ramp.json", "long.ramp.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    // 0.3 s for a release build on two cores; here other tests run at the same time, and serde_json is not optimised.
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
}

/// Runs a command that must succeed, and returns its standard output.
pub fn stdout_of(folder: &Path, arguments: &[&str]) -> String {
    let output = haze(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_template_can_be_written_and_baked_and_passes_the_check() {
    let folder = folder();
    for template in TEMPLATES {
        let name = format!("{}_{}", template.role.name(), template.name);
        let recipe = format!("{name}.ramp.json");
        let line = stdout_of(folder.path(), &["ramp", "new", "--template", template.name, "-o", &recipe]);
        assert!(line.starts_with(&format!("{recipe}: {}", template.description)), "{line}");
        stdout_of(folder.path(), &["ramp", "bake", &recipe]);
        let image = format!("{name}.png");
        let checked = stdout_of(folder.path(), &["ramp", "check", &recipe, &image]);
        assert_eq!(checked, format!("{recipe}: good\n{image}: good\n"));
    }
    // Existing files are not replaced.
    let again = refusal(folder.path(), &["ramp", "new", "-o", "diffuse_moon.ramp.json"]);
    assert!(again.contains("expected a name that does not exist yet"), "{again}");
    let name = refusal(folder.path(), &["ramp", "new", "-o", "moon.json"]);
    assert!(name.contains("expected a name that ends in .ramp.json"), "{name}");
    let unknown = refusal(folder.path(), &["ramp", "new", "--template", "tune", "-o", "a.ramp.json"]);
    assert!(unknown.contains("soft_toon") && unknown.contains("night_lamp"), "{unknown}");
}

#[test]
fn an_imported_image_bakes_back_within_the_stated_error() {
    let folder = folder();
    for (name, error) in [("specular_halo", 2.0), ("diffuse_dusk", 2.0)] {
        let source = format!("{}/../../ramps/{name}.png", env!("CARGO_MANIFEST_DIR"));
        let line = stdout_of(folder.path(), &["ramp", "import", &source, "-o", "mine.ramp.json", "--error", "2"]);
        let stated: f32 = line.rsplit("at most ").next().unwrap().split('/').next().unwrap().parse().unwrap();
        assert!(line.starts_with("mine.ramp.json: ") && stated <= error, "{line}");
        stdout_of(folder.path(), &["ramp", "bake", "mine.ramp.json"]);
        let read = |path: &Path| haze_core::assets::image::read_png(path).unwrap().into_rgb16();
        let before = read(source.as_ref());
        let after = read(&folder.path().join("mine.png"));
        let off = before.iter().zip(after.iter()).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!((f32::from(off) / 257.0 - stated).abs() < 0.06, "{line}: {off}");
    }
    fs::write(folder.path().join("a.txt"), "0 (0 0 0)\n1 (1 1 1)\n").unwrap();
    let line = stdout_of(folder.path(), &["ramp", "import", "a.txt", "-o", "a.ramp.json"]);
    assert_eq!(line, "a.ramp.json: 2 stops, at most 0.5/255 off\n");
    let gradients = ["a", "b"].map(|id| format!("[sub_resource type=\"Gradient\" id=\"{id}\"]\n"));
    fs::write(folder.path().join("two.tres"), format!("[gd_resource type=\"Curve\"]\n{}", gradients.concat())).unwrap();
    let two = haze(folder.path(), &["ramp", "import", "two.tres", "-o", "b.ramp.json"]);
    assert_eq!(stderr(&two), "haze: two.tres:2: read gradient a, not b; --gradient chooses one\n");
    let chosen = haze(folder.path(), &["ramp", "import", "two.tres", "-o", "b.ramp.json", "--gradient", "b"]);
    assert_eq!((chosen.status.success(), stderr(&chosen)), (true, String::new()));
    let line = refusal(folder.path(), &["ramp", "import", "a.txt", "-o", "a.txt"]);
    assert!(line.contains("expected a name that ends in .ramp.json"), "{line}");
    fs::write(folder.path().join("a.png"), "GIF89a").unwrap();
    let line = refusal(folder.path(), &["ramp", "import", "a.png", "-o", "a.ramp.json"]);
    assert_eq!(line, "haze: a.png: not a PNG file; export it as PNG\n");
    let line = refusal(folder.path(), &["ramp", "import", "a.txt", "-o", "a.ramp.json", "--error=-1"]);
    assert_eq!(line, "haze: invalid value '-1' for '--error <STEPS>': expected a number, 1 to 64\n");
    fs::remove_file(folder.path().join("a.png")).unwrap();
    assert_eq!(stdout_of(folder.path(), &["ramp", "bake", "a.ramp.json"]), "a.png: 256x1\n");
}

#[test]
fn ramp_check_reports_findings_and_exits_with_1() {
    let folder = folder();
    let save = |name: &str, image: DynamicImage| image.save(folder.path().join(name)).unwrap();
    save("specular_gray.png", DynamicImage::ImageLuma8(GrayImage::from_pixel(16, 16, Luma([90]))));
    let slope = |x: u32| Luma([(20 + x * 40 / 256) as u8]);
    save("a.png", DynamicImage::ImageLuma8(GrayImage::from_fn(256, 1, |x, _| slope(x))));
    save("age.png", DynamicImage::ImageLumaA8(ImageBuffer::from_pixel(4, 1, LumaA([90, 128]))));
    let output = haze(folder.path(), &["ramp", "check", "specular_gray.png", "a.png", "age.png"]);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!((output.status.code(), stderr(&output)), (Some(1), String::new()), "{text}");
    let names: Vec<_> = text.lines().map(|line| line.rsplitn(2, ';').last().unwrap()).collect();
    assert_eq!(
        names,
        [
            "specular_gray.png: ends: brightness 90 of 255 at amount 0, the bottom row",
            "specular_gray.png: ends: brightness 90 of 255 at distance 1, the last column",
            "a.png: warning: banding: visible steps at 0.10 across",
            "age.png: color_space: transparent texels",
        ]
    );
    let output = haze(folder.path(), &["ramp", "check", "--as", "diffuse", "specular_gray.png"]);
    assert!(output.status.success());
    // A warning names its cure, which removes it.
    let warned = stdout_of(folder.path(), &["ramp", "check", "a.png"]);
    let cure = "`haze ramp import a.png -o a.ramp.json`, then `haze ramp bake --overwrite a.ramp.json`\n";
    assert!(warned.ends_with(cure), "{warned}");
    stdout_of(folder.path(), &["ramp", "import", "a.png", "-o", "a.ramp.json"]);
    stdout_of(folder.path(), &["ramp", "bake", "--overwrite", "a.ramp.json"]);
    assert_eq!(stdout_of(folder.path(), &["ramp", "check", "a.png"]), "a.png: good\n");
    // A file that cannot be read is bad input.
    assert!(refusal(folder.path(), &["ramp", "check", "gone.png"]).starts_with("haze: gone.png: "));
    fs::write(folder.path().join("a.ggr"), "GIMP Gradient\n").unwrap();
    for command in ["check", "show"] {
        let line = refusal(folder.path(), &["ramp", command, "a.ggr"]);
        assert!(line.contains("`haze ramp import` converts the gradient"), "{line}");
    }
}

#[test]
fn a_ramp_is_shown_as_text_and_as_an_image() {
    let folder = folder();
    stdout_of(folder.path(), &["ramp", "new", "--template", "hard_toon", "-o", "toon.ramp.json"]);
    let text = stdout_of(folder.path(), &["ramp", "show", "toon.ramp.json"]);
    // Standard output is not a terminal: no colors, but the curve and the stops.
    assert!(!text.contains('\u{1b}') && text.contains('█'), "{text}");
    assert!(text.starts_with("toon.ramp.json: 256x1\n") && text.ends_with("0.720  #f6efe2  constant\n"), "{text}");
    stdout_of(folder.path(), &["ramp", "show", "toon.ramp.json", "-o", "toon.png"]);
    let image = haze_core::assets::image::read_png(&folder.path().join("toon.png")).unwrap().into_rgb8();
    assert_eq!(image.get_pixel(100, 40).0, [0x2b, 0x2a, 0x3a]);
    assert_eq!(image.get_pixel(540, 40).0, [0xf6, 0xef, 0xe2]);
    let line = refusal(folder.path(), &["ramp", "show", "toon.png", "-o", "toon.png"]);
    assert!(line.contains("is also an input; expected another file"), "{line}");
}

/// Runs a command on a terminal and returns its output.
#[cfg(target_os = "linux")]
fn terminal_output_of(folder: &Path, arguments: &str, no_color: &str) -> String {
    let command = format!("{} {arguments}", env!("CARGO_BIN_EXE_haze"));
    let script = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(folder)
        .env("NO_COLOR", no_color)
        .output();
    String::from_utf8(script.unwrap().stdout).unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_shows_colors_unless_no_color_is_set() {
    let folder = folder();
    stdout_of(folder.path(), &["ramp", "new", "--template", "hard_toon", "-o", "toon.ramp.json"]);
    let colored = terminal_output_of(folder.path(), "ramp show toon.ramp.json", "");
    assert!(colored.contains("\u{1b}[38;2;43;42;58;48;2;43;42;58m"), "{colored:?}");
    let plain = terminal_output_of(folder.path(), "ramp show toon.ramp.json", "1");
    assert!(!plain.contains('\u{1b}') && plain.contains("#f6efe2"), "{plain:?}");
}

#[test]
fn a_blank_of_every_role_has_labelled_axes() {
    let folder = folder();
    for role in RampRole::ALL {
        let name = format!("{}_mine.png", role.name());
        let line = stdout_of(folder.path(), &["ramp", "new", "--blank", role.name(), "-o", &name]);
        let size = if matches!(role, RampRole::Specular | RampRole::Backlight | RampRole::Shadow) {
            "512x256"
        } else {
            "512x64"
        };
        assert_eq!(line, format!("{name}: a {} ramp to paint over, {size}\n", role.name()));
        // Text at both ends: without it, a ramp changes by less than a code from one line to the next. The check allows 12.
        let image = haze_core::assets::image::read_png(&folder.path().join(&name)).unwrap().to_luma8();
        let middle = image.height() / 2;
        for end in [0..150, 362..512] {
            let is_edge = |x: &u32, y| image[(*x, y)].0[0].abs_diff(image[(*x, y + 1)].0[0]) > 6;
            let edges = (middle - 10..middle + 10).map(|y| end.clone().filter(|x| is_edge(x, y)).count());
            let edges: usize = edges.sum();
            assert!(edges > 20, "{name}, {end:?}: {edges}");
        }
        let checked = stdout_of(folder.path(), &["ramp", "check", &name]);
        assert_eq!(checked, format!("{name}: good\n"));
        assert!(
            refusal(folder.path(), &["ramp", "new", "--blank", role.name(), "-o", &name])
                .contains("does not exist yet")
        );
    }
    let line = refusal(folder.path(), &["ramp", "new", "--blank", "age", "-o", "a.ramp.json"]);
    assert!(line.contains("expected a name that ends in .png"), "{line}");
}

#[test]
fn shadow_ramps_are_fitted_to_path_traced_clouds() {
    let folder = folder();
    let fit = ["ramp", "fit-shadow", "--size", "16", "--samples", "4", "-o", "shadow_mine.ramp.json"];
    let lines = stdout_of(folder.path(), &fit);
    assert_eq!(lines.lines().filter(|line| line.contains("% off")).count(), 12, "{lines}");
    assert!(lines.contains("multiply diffuse.intensity by "), "{lines}");
    stdout_of(folder.path(), &["ramp", "check", "shadow_mine.png"]);
    assert!(refusal(folder.path(), &[&fit[..], &["--rows", "0"]].concat()).contains("1 to 16"));
}

#[test]
fn ramps_are_fitted_to_path_traced_smoke() {
    let folder = folder();
    let puff = ["--size", "16", "--samples", "8"];
    let fit = ["ramp", "fit", "-o", "lit.ramp.json"];
    let both = ["--medium", "dust", "--backlight", "against.ramp.json", "--sheet", "sheet.png"];
    let told = stdout_of(folder.path(), &[&fit[..], &puff, &both].concat());
    // First the default ramp, then the fitted one.
    let error = |name: &str| -> f32 {
        let line = told.lines().find(|line| line.starts_with(name)).unwrap();
        line.split(' ').nth(2).unwrap().parse().unwrap()
    };
    assert!(error("fitted:") < 10.0 && error("diffuse_soft:") > 30.0, "{told}");
    assert_eq!(told.lines().filter(|line| line.contains('°')).count(), 32, "{told}");
    for name in ["lit", "against"] {
        let image = folder.path().join(name).with_extension("png");
        assert_eq!(haze_core::assets::image::read_png(&image).unwrap().to_rgb16().dimensions(), (128, 64));
        assert!(haze_author::ramp::RampRecipe::load(&image.with_extension("ramp.json")).unwrap().rows.len() == 5);
    }
    assert!(folder.path().join("sheet.png").is_file());
    let render = ["render", "--size", "32x18", "--backend", "cpu", "-o", "a.png", "--set", "diffuse.backlight=ramp"];
    assert!(haze(folder.path(), &render).status.success());
    let check = ["ramp", "check", "lit.png", "--truth", "dust", "--backlight", "against.png"];
    let output = haze(folder.path(), &check);
    assert!(String::from_utf8(output.stdout).unwrap().starts_with("lit.png against dust: brightness "));
    let refused = |rest: &[&str]| refusal(folder.path(), &[&fit[..], &puff, rest].concat());
    assert!(
        refused(&["--albedo", "1.5"])
            .contains("invalid value '1.5' for '--albedo <FRACTION>': expected a number, 0 to 1")
    );
    assert!(
        refused(&["--albedo", "0.5,0.25"])
            .contains("--albedo: 2 numbers are given; expected one number, or three: red, green and blue")
    );
    assert!(
        refused(&["--g", "nan"]).contains("invalid value 'nan' for '--g <COSINE>': expected a number, -0.95 to 0.95")
    );
    assert!(
        refused(&["--density", "0"])
            .contains("invalid value '0' for '--density <EXTINCTION>': expected a number, 0.1 to 100")
    );
    assert!(refused(&["--sprite", "smoke"]).contains("--sprite: smoke is not valid; expected a *.sprite.json file"));
}

#[test]
fn sprite_light_path_traces_a_sprite() {
    let folder = folder();
    let light = ["sprite", "light", "ball", "--medium", "milk", "--size", "16", "--samples", "4", "-o", "a.png"];
    let told = stdout_of(folder.path(), &[&light[..], &["--volume", "ball.vol"]].concat());
    assert_eq!(told.lines().count(), 17, "{told}");
    assert_eq!(haze_core::assets::image::read_png(&folder.path().join("a.png")).unwrap().height(), 212);
    let grid = fs::read(folder.path().join("ball.vol")).unwrap();
    let refused = |option: &str, text: &str| refusal(folder.path(), &["sprite", "light", "-o", "b.png", option, text]);
    for (option, text, range) in [
        ("--size", "big", "a whole number, 8 to 256"),
        ("--size", "-8", "a whole number, 8 to 256"),
        ("--samples", "0", "a whole number, 1 to 65536"),
        ("--seed", "x", "0 to 4294967295"),
        ("--albedo", "white", "a number, 0 to 1"),
        ("--g", "forward", "a number, -0.95 to 0.95"),
        ("--density", "thick", "a number, 0.1 to 100"),
    ] {
        let line = refused(option, text);
        assert!(line.contains(option) && line.ends_with(&format!("expected {range}\n")), "{line}");
    }
    assert!(grid.starts_with(b"VOL\x03\x01\0\0\0\x10\0\0\0\x10\0\0\0"), "{:?}", &grid[..24]);
}

#[test]
fn a_file_of_another_kind_is_refused_with_the_right_command() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("a.ramp.json", &TEMPLATES[0].recipe().to_json());
    write("recipe.json", &TEMPLATES[0].recipe().to_json());
    // Recognized by its name, although its content is broken.
    write("broken.sprite.json", "{");
    write("a.json", &haze_preset::Preset::load(Path::new("column")).unwrap().to_json(""));
    for (command, file, is, other) in [
        ("preset", "a.ramp.json", "a ramp recipe", "haze ramp check"),
        ("preset", "recipe.json", "a ramp recipe", "haze ramp check"),
        ("preset", "broken.sprite.json", "a sprite recipe", "haze sprite bake"),
        ("ramp", "a.json", "a preset", "haze preset check"),
        ("ramp", "broken.sprite.json", "a sprite recipe", "haze sprite bake"),
        ("sprite", "a.ramp.json", "a ramp recipe", "haze ramp check"),
        ("sprite", "a.json", "a preset", "haze preset check"),
        ("sprite", "broken.sprite.json", "a sprite recipe", "haze sprite bake"),
    ] {
        let stdout_of = refusal(folder.path(), &[command, "check", file]);
        assert!(
            stdout_of.contains(&format!("{file} is {is}; expected "))
                && stdout_of.contains(&format!(", or `{other}` for this file")),
            "{command} {file}: {stdout_of}"
        );
    }
    // A broken file of the right kind and a missing file keep their own errors.
    write("broken.ramp.json", "{");
    assert!(refusal(folder.path(), &["ramp", "check", "broken.ramp.json"]).contains("broken.ramp.json:1:1: "));
    assert!(!refusal(folder.path(), &["preset", "check", "gone.ramp.json"]).contains("haze ramp check"));
}
