//! Presets on the command line: loading, and `haze preset`.

use super::{folder, haze, refusal, render, stderr};

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
    std::fs::write(folder.path().join("text.png"), "not an image").unwrap();
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
fn a_setting_without_effect_is_reported() {
    let folder = folder();
    let output = render(folder.path(), &["corridor", "--set", "accumulate.downscale=8"]);
    let note = "haze: --set accumulate.downscale has no effect: only with scale_mode fixed\n";
    assert_eq!((output.status.success(), stderr(&output).as_str()), (true, note));
    let output = render(folder.path(), &["corridor", "--set", "accumulate.downscale=8", "--set", "scale_mode=fixed"]);
    assert_eq!((output.status.success(), stderr(&output).as_str()), (true, ""));
    let sheet = ["sheet", "corridor", "--size", "64x36", "--backend", "cpu", "-o", "a.png"];
    let vary = |field: &str| stderr(&haze(folder.path(), &[&sheet[..], &["--vary", field]].concat()));
    assert_eq!(vary("accumulate.downscale=2,4"), note.replace("--set", "--vary"));
    assert_eq!(vary("accumulate.max_error=0.05,0.1"), "");
    // A refused command says its error alone.
    image::RgbImage::new(4, 4).save(folder.path().join("own.png")).unwrap();
    let own = ["-o", "own.png", "corridor"];
    let set = refusal(folder.path(), &[&["render", "--set", "material.motif=own.png"], &own[..]].concat());
    assert_eq!(set, "haze: --output: own.png is also an input; expected another file\n");
    let vary =
        refusal(folder.path(), &[&["sheet", "--vary", "material.motif=motif_studio,own.png"], &own[..]].concat());
    assert_eq!(vary, set);
}

#[test]
fn presets_are_listed_checked_and_described() {
    let folder = folder();
    let text = |arguments: &[&str]| {
        let output = haze(folder.path(), arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let list = text(&["preset", "list"]);
    let names: Vec<&str> = list.lines().map(|line| line.split_once("  ").unwrap_or_default().0).collect();
    assert_eq!(names, haze_preset::builtin::PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>());
    assert_eq!(text(&["preset", "check", "column", "inside"]), "column: good\ninside: good\n");
    let idle = r#"{"version": 1, "name": "x", "systems": [{"name": "s", "settings": {"path": "forward", "coverage": "ramp", "boost": 2}}]}"#;
    std::fs::write(folder.path().join("idle.json"), idle).unwrap();
    let note = "idle.json: good\n  systems[0].settings.coverage has no effect: deferred only\n";
    assert_eq!(text(&["preset", "check", "idle.json"]), note);
    let shown = text(&["preset", "show", "idle.json"]);
    let line = |field: &str| shown.lines().find(|line| line.starts_with(&format!("systems[0].{field} "))).unwrap();
    assert!(line("settings.boost").ends_with(" 2.0                    default 3.0"), "{shown}");
    assert!(line("settings.accumulate.opacity").ends_with(" 1.0                    default"), "{shown}");
    assert!(line("settings.coverage").ends_with("default \"linear\"; no effect: deferred only"), "{shown}");
    assert_eq!(text(&["preset", "show", "--changed", "idle.json"]).lines().count(), 5);
    assert!(text(&["preset", "schema"]).contains("\"soft_fade\""));
    let info = text(&["info"]);
    assert!(info.contains("gpu: ") && info.contains("choices of path auto"), "{info}");
    let reasons: Vec<_> = info.lines().filter(|line| line.starts_with("  ")).collect();
    let is_reason = |line: &&str| line.contains(": about ") && line.contains("probe") || line.contains("no path tiled");
    assert!(!reasons.is_empty() && reasons.iter().all(is_reason), "{info}");
    assert!(text(&["--help"]).contains("debug-views"));
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

/// Link of the tests of links: `column` with changes, another light and a ramp of its own.
fn link() -> &'static str {
    include_str!("../../../../haze_export/src/share_link/links_1.txt").lines().nth(2).unwrap()
}

#[test]
fn links_are_rendered_shown_checked_and_saved_as_presets() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let done = |arguments: &[&str]| {
        let output = haze(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(done(&["preset", "show", "--changed", link()]).contains("lights[1].intensity"));
    assert!(done(&["preset", "check", link()]).contains(": good"));
    assert!(render(folder.path(), &[link()]).status.success());
    let of_link = std::fs::read(path("out.png")).unwrap();
    done(&["export", "material", link(), "--engine", "wgsl", "-o", "material"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "a link leaves no files");
    done(&["preset", "new", "mine", "--from", link()]);
    done(&["ramp", "check", "mine.ramp.json"]);
    assert!(path("mine.png").exists());
    assert!(render(folder.path(), &["mine.json"]).status.success());
    assert!(std::fs::read(path("out.png")).unwrap() == of_link);
    let taken = refusal(folder.path(), &["preset", "new", "other", "--from", link()]);
    assert_eq!(taken, "haze: FILE: mine.png exists already; expected a folder without the ramps of the link\n");
    assert!(!path("other.json").exists());
    let swapped = refusal(folder.path(), &["preset", "new", link()]);
    assert_eq!(swapped, "haze: FILE: it is a link; expected a name that ends in .json, then --from LINK\n");
}

#[test]
fn bad_links_are_refused_with_one_line() {
    let folder = folder();
    let cut = &link()[..link().len() - 9];
    let damaged = "haze: link: it is damaged; expected a whole link, as it was copied\n";
    for (name, expected) in [
        (cut, damaged),
        (
            "https://example.org/haze/#9AAAA",
            "haze: link: it is of a version that this program does not know; expected a link of version 1\n",
        ),
        (
            "https://example.org/haze/",
            "haze: link: https://example.org/haze/ has no look after #; expected a whole link, as it was copied\n",
        ),
    ] {
        for command in [
            &["render", "-o", "a.png"][..],
            &["preset", "show"],
            &["preset", "check"],
            &["preset", "new", "a", "--from"],
        ] {
            assert_eq!(refusal(folder.path(), &[command, &[name]].concat()), expected);
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
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
    let idle = "my.json: bad\n  systems[0].material.age_ramp has no effect: only at an age_color above 0\n  systems[0].material.noise has no effect: ";
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
