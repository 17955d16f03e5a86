//! `haze sprite`: the authoring commands.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{folder, haze, refusal, stderr};

#[test]
fn a_large_flipbook_bakes_quickly() {
    let folder = folder();
    let recipe = include_str!("../../../../../tests/corpus/sprite/good_first");
    let recipe = recipe.replace("\"columns\": 4", "\"columns\": 8").replace("\"rows\": 2", "\"rows\": 8");
    fs::write(folder.path().join("puff.sprite.json"), recipe).unwrap();
    let started = Instant::now();
    let output = haze(folder.path(), &["sprite", "bake", "puff.sprite.json"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "puff.png: 2048x2048\npuff.detail.png: 512x512\n");
    assert!(output.status.success(), "{}", stderr(&output));
    // 8 s of CPU time on two cores, 4.4 to 5.3 s elapsed; here other tests run at the same time.
    assert!(started.elapsed() < Duration::from_secs(40), "{:?}", started.elapsed());
}

#[test]
fn sprite_check_reports_findings_and_exits_with_1() {
    let folder = folder();
    let wisp = concat!(env!("CARGO_MANIFEST_DIR"), "/../../sprites/wisp.png");
    // The recipe beside the sprite gives its layout.
    let output = haze(folder.path(), &["sprite", "check", wisp]);
    assert_eq!(String::from_utf8_lossy(&output.stdout), format!("{wisp}: good\n"), "{}", stderr(&output));
    let sheet = image::open(wisp).unwrap().to_rgba8();
    let mut turned = sheet.clone();
    turned.pixels_mut().for_each(|texel| texel.0[1] = 255 - texel.0[1]);
    turned.save(folder.path().join("down.png")).unwrap();
    let colors = image::RgbaImage::from_pixel(8, 8, image::Rgba([250, 120, 20, 255]));
    colors.save(folder.path().join("fire.png")).unwrap();
    let output = haze(folder.path(), &["sprite", "check", "--columns", "4", "--rows", "2", "down.png"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.starts_with("down.png: y_down: green points down, "), "{text}");
    assert_eq!((output.status.code(), text.lines().count(), stderr(&output)), (Some(1), 1, String::new()), "{text}");
    let arguments = ["sprite", "check", "--columns", "4", "--rows", "2", "--y-down", "down.png"];
    assert!(haze(folder.path(), &arguments).status.success());
    let output = haze(folder.path(), &["sprite", "check", "fire.png"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("fire.png: border: frame 0 has alpha 255") && text.contains("fire.png: normals: "), "{text}");
    // A sheet that does not divide into frames is bad input.
    let text = refusal(folder.path(), &["sprite", "check", "--columns", "3", "down.png"]);
    assert!(text.contains("square frames"), "{text}");
}

#[test]
fn images_of_other_kinds_are_imported_as_sprites() {
    let folder = folder();
    let said = |arguments: &[&str]| {
        let output = haze(folder.path(), &[&["sprite", "import"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let wisp = concat!(env!("CARGO_MANIFEST_DIR"), "/../../sprites/wisp.png");
    let grid = ["--columns", "4", "--rows", "2"];
    let text = said(&[&[wisp, "-o", "up.png"], &grid[..]].concat());
    assert!(text.starts_with("up.png: 4x2 frames\n  green points up: a guess, "), "{text}");
    let mut down = image::open(wisp).unwrap().to_rgba8();
    down.pixels_mut().for_each(|texel| texel.0[1] = 255 - texel.0[1]);
    down.save(folder.path().join("down.png")).unwrap();
    let text = said(&[&["down.png", "-o", "turned.png"], &grid[..]].concat());
    assert!(text.contains("green points down and was flipped: a guess, "), "{text}");
    let text = said(&[&["down.png", "-o", "told.png", "--y-down"], &grid[..]].concat());
    assert!(text.contains("green points down and was flipped, as --y-down says"), "{text}");
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("turned.png"), read("told.png"));
    // Numbered frames.
    for index in 0..4 {
        let frame = image::imageops::crop_imm(&down, 0, 0, down.width() / 4, down.height() / 2).to_image();
        frame.save(folder.path().join(format!("smoke_{index:04}.png"))).unwrap();
    }
    let frames = ["smoke_0000.png", "smoke_0001.png", "smoke_0002.png", "smoke_0003.png"];
    let text = said(&[&frames[..], &["--from", "alpha", "-o", "puff.png"]].concat());
    assert_eq!(text, "puff.png: 2x2 frames\n");
    let checked = haze(folder.path(), &["sprite", "check", "--columns", "2", "--rows", "2", "puff.png"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    // Numbers without leading zeros, in the order of a shell.
    for number in [9, 10] {
        let dot = |x: u32, y: u32| image::Luma([if (x, y) == (number, 8) { 255 } else { 0 }]);
        image::GrayImage::from_fn(16, 16, dot).save(folder.path().join(format!("dot_{number}.png"))).unwrap();
    }
    said(&["dot_10.png", "dot_9.png", "--from", "alpha", "-o", "dots.png"]);
    let dots = image::open(folder.path().join("dots.png")).unwrap().to_rgba8();
    assert_eq!([dots[(9, 8)].0[3], dots[(16 + 10, 8)].0[3]], [255, 255]);
    let text = refusal(folder.path(), &["sprite", "import", "down.png", "--from", "six_way_unity", "-o", "a.png"]);
    assert!(text.contains("1 sheets; expected 2"), "{text}");
    let fire = image::RgbaImage::from_pixel(16, 16, image::Rgba([250, 120, 20, 255]));
    fire.save(folder.path().join("fire.png")).unwrap();
    // Nothing is written that the check would refuse.
    let slope = |x: u32, _| image::Luma([4 * x as u8]);
    image::GrayImage::from_fn(64, 64, slope).save(folder.path().join("gray.png")).unwrap();
    let dome = |x: u32, y: u32| image::Luma([255 - (((x as i32 - 32).pow(2) + (y as i32 - 32).pow(2)) / 9) as u8]);
    image::GrayImage::from_fn(64, 64, dome).save(folder.path().join("dome.png")).unwrap();
    for (arguments, expected) in [
        (&["fire.png"][..], "fire.png: colors, not normals; expected normals, or --from with the contents"),
        (&["gray.png"], "gray.png: shades of gray; expected normals, or --from with the contents"),
        (&["gray.png", "--from", "height"], "gray.png: these heights make no puff; expected a puff that is highest"),
        (&["dome.png", "--from", "height"], "dome.png: alpha is 255 everywhere inside the borders, so that each frame"),
    ] {
        let text = refusal(folder.path(), &[&["sprite", "import", "-o", "a.png"], arguments].concat());
        assert!(text.contains(expected), "{text}");
        assert!(!folder.path().join("a.png").exists());
    }
    said(&["gray.png", "--from", "alpha", "-o", "a.png"]);
    let checked = haze(folder.path(), &["sprite", "check", "a.png"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    fs::remove_file(folder.path().join("a.png")).unwrap();
    // Options that would be ignored are refused.
    for (arguments, expected) in [
        (
            &["fire.png", "fire.png", "fire.png", "--from", "six_way_unity"][..],
            "none of 3 sheets is gray; expected two",
        ),
        (
            &["fire.png", "fire.png", "--from", "six_way_rlt_bbf"],
            "fire.png: no opacity: alpha of the light maps is the same everywhere; expected the amount in alpha of the first",
        ),
        (
            &["fire.png", "--from", "alpha", "--y-down"],
            "--y-down: has no effect with --from alpha; expected --from normals",
        ),
        (&["smoke_0000.png", "smoke_0001.png", "--columns", "2"], "2x1 is given for 2 files; expected 1x1"),
    ] {
        let text = refusal(folder.path(), &[&["sprite", "import", "-o", "a.png"], arguments].concat());
        assert!(text.contains(expected), "{text}");
    }
    let text = refusal(folder.path(), &["sprite", "import", "down.png", "-o", "down.png"]);
    assert!(text.contains("is also an input; expected another file"), "{text}");
}

/// Runs a command that must succeed, and returns its standard output.
fn stdout_of(folder: &Path, arguments: &[&str]) -> String {
    let output = haze(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Returns a folder with the sprite `mine` and its six-way maps, and the output of the bake.
fn folder_with_six_way_maps() -> (TempDir, String) {
    let folder = folder();
    let recipe = include_str!("../../../../../tests/corpus/sprite/good_first");
    let size = recipe.lines().find(|line| line.contains("\"size\"")).unwrap();
    fs::write(folder.path().join("mine.sprite.json"), recipe.replace(size, "\"size\": 16,")).unwrap();
    let bake = ["sprite", "bake", "mine.sprite.json", "--six-way", "steam", "--samples", "4"];
    let text = stdout_of(folder.path(), &bake);
    (folder, text)
}

#[test]
fn six_way_maps_are_baked_and_rendered() {
    let (folder, text) = folder_with_six_way_maps();
    assert!(
        text.starts_with("mine.png: 64x32\nmine.detail.png: 16x8\nmine.six_way.png: 64x64\n  to look like steam: "),
        "{text}"
    );
    // Smoke can be rendered with them.
    fs::write(
        folder.path().join("own.json"),
        r#"{"version": 1, "name": "x", "systems": [{"name": "a", "settings": {"lighting": "six_way"},
            "material": {"sprite": "mine.png", "six_way": "mine.six_way.png", "columns": 4, "rows": 2}}]}"#,
    )
    .unwrap();
    stdout_of(folder.path(), &["preset", "check", "own.json"]);
    stdout_of(folder.path(), &["render", "own.json", "--size", "64x36", "--backend", "cpu", "-o", "lit.png"]);
}

#[test]
fn exported_six_way_maps_are_imported_with_the_same_light() {
    let (folder, _) = folder_with_six_way_maps();
    for packing in ["unity", "rlt_bbf"] {
        stdout_of(folder.path(), &["sprite", "export", "mine.six_way.png", "--to", packing, "-o", "a.png", "b.png"]);
        let from = format!("six_way_{packing}");
        let text = stdout_of(
            folder.path(),
            &[
                "sprite",
                "import",
                "a.png",
                "b.png",
                "--from",
                &from,
                "-o",
                "again.png",
                "--columns",
                "4",
                "--rows",
                "2",
            ],
        );
        assert!(text.contains("again.six_way.png: the light maps, for lighting six_way"), "{text}");
        assert!(!text.contains("emission"), "{text}");
        let [first, again] = ["mine", "again"]
            .map(|name| image::open(folder.path().join(format!("{name}.six_way.png"))).unwrap().to_rgba8());
        let light = |code: u8| (f32::from(code) / 255.0).powi(2);
        let apart = |a: &image::Rgba<u8>, b: &image::Rgba<u8>| {
            a.0.iter().zip(b.0).map(|(&a, b)| (light(a) - light(b)).abs()).fold(0.0, f32::max)
        };
        let seen = first.pixels().zip(again.pixels()).filter(|(texel, _)| texel.0[3] > 0);
        let most = seen.map(|(a, b)| apart(a, b)).fold(0.0, f32::max);
        // The same light, within one of its steps.
        assert!(most < 1.5 / 255.0, "{packing}: {most}");
    }
    let mut burning = image::open(folder.path().join("b.png")).unwrap().to_rgba8();
    burning.enumerate_pixels_mut().for_each(|(x, _, texel)| texel.0[3] = 3 * x as u8);
    burning.save(folder.path().join("b.png")).unwrap();
    let import = ["a.png", "b.png", "--from", "six_way_rlt_bbf", "-o", "again.png", "--columns", "4", "--rows", "2"];
    let text = stdout_of(folder.path(), &[&["sprite", "import"], &import[..]].concat());
    assert!(text.contains("alpha of the second map, up to 189, is not the amount and was left out"), "{text}");
}

#[test]
fn six_way_options_and_files_that_do_not_fit_are_refused() {
    let (folder, _) = folder_with_six_way_maps();
    for (arguments, expected) in [
        (
            &["bake", "mine.sprite.json", "--albedo", "0.5"][..],
            "--albedo: has no effect without --six-way; expected --six-way as well",
        ),
        (&["bake", "streaks"], "expected a *.sprite.json or *.noise.json file"),
        (&["bake", "mine.sprite.json", "--six-way", "--g", "2"], "invalid value '2' for '--g <COSINE>'"),
        (&["export", "mine.six_way.png", "-o", "mine.six_way.png", "b.png"], "is also an input; expected another file"),
        (
            &["import", "mine.png", "mine.png", "--from", "six_way_unity", "-o", "mine.png"],
            "is also an input; expected another file",
        ),
    ] {
        let text = refusal(folder.path(), &[&["sprite"], arguments].concat());
        assert!(text.contains(expected), "{text}");
    }
    fs::write(
        folder.path().join("none.json"),
        r#"{"version": 1, "name": "x", "systems": [{"name": "a", "settings": {"lighting": "six_way"}}]}"#,
    )
    .unwrap();
    let text = refusal(folder.path(), &["preset", "check", "none.json"]);
    assert!(
        text.contains("none.json: systems[0].settings.lighting: \"six_way\"") && text.contains("six-way maps"),
        "{text}"
    );
}

const FIRE: &str = r#"{
    "version": 1,
    "grid": { "width": 16, "height": 24, "depth": 16, "detail": 1 },
    "sources": [{ "position": [0, 0.4, 0], "radius": [0.2, 0.2, 0.2], "end": 0.1, "smoke": 1, "fuel": 1 }],
    "time": { "duration": 0.4 },
    "sheet": { "size": 32, "columns": 4, "rows": 2 }
}"#;

#[test]
fn simulations_are_baked_to_sprites() {
    let folder = folder();
    fs::write(folder.path().join("fire.sim.json"), FIRE).unwrap();
    let simulate = ["sprite", "simulate", "fire.sim.json"];
    let text = stdout_of(folder.path(), &[&simulate[..], &["--six-way", "ash", "--samples", "2"]].concat());
    let expected =
        "fire.png: 128x64\nfire.detail.png: 32x16\nfire.heat.png: 128x64\nfire.six_way.png: 128x128\n  to look";
    assert!(text.starts_with(expected), "{text}");
    let heat = image::open(folder.path().join("fire.heat.png")).unwrap().to_luma8();
    assert!(heat.pixels().any(|texel| texel.0[0] > 60), "nothing is hot");
    // It plays once, so `sprite check` may find no loop, but nothing else.
    let checked = haze(folder.path(), &["sprite", "check", "--columns", "4", "--rows", "2", "fire.png"]);
    let findings = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(findings.lines().all(|line| line.contains(": good") || line.contains(": loop: ")), "{findings}");
    let text = stdout_of(folder.path(), &[&simulate[..], &["--preview"]].concat());
    assert_eq!(text, "fire_preview.png: 64x32\nfire_preview.detail.png: 16x8\nfire_preview.heat.png: 64x32\n");
    // A PNG that was painted since is kept.
    image::GrayImage::new(4, 4).save(folder.path().join("fire.heat.png")).unwrap();
    let text = refusal(folder.path(), &simulate);
    assert!(text.contains("fire.heat.png was painted, or changed after it was baked, and is kept"), "{text}");
    assert_eq!(image::open(folder.path().join("fire.heat.png")).unwrap().width(), 4);
    stdout_of(folder.path(), &[&simulate[..], &["--overwrite"]].concat());
    assert_eq!(image::open(folder.path().join("fire.heat.png")).unwrap().width(), 128);
}

#[test]
#[cfg(target_os = "linux")]
fn a_stopped_simulation_goes_on_where_it_was() {
    let folder = folder();
    // Some seconds.
    let long = FIRE.replace("\"columns\": 4, \"rows\": 2", "\"columns\": 12, \"rows\": 12");
    assert_ne!(long, FIRE);
    for name in ["whole", "fire"] {
        fs::write(folder.path().join(format!("{name}.sim.json")), &long).unwrap();
    }
    stdout_of(folder.path(), &["sprite", "simulate", "whole.sim.json"]);
    let child = Command::new(env!("CARGO_BIN_EXE_haze"))
        .args(["sprite", "simulate", "fire.sim.json"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    super::bench::wait_for_handlers(&child);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = stderr(&output);
    assert!(!output.status.success() && said.contains("of 144 frames are in fire.checkpoint"), "{said}");
    assert!(!folder.path().join("fire.png").exists());
    // One of another recipe is left, and said.
    fs::write(folder.path().join("fire.sim.json"), FIRE).unwrap();
    fs::copy(folder.path().join("fire.checkpoint"), folder.path().join("kept")).unwrap();
    let text = stdout_of(folder.path(), &["sprite", "simulate", "fire.sim.json"]);
    assert!(text.starts_with("fire.checkpoint: of another recipe; starts anew\nfire.png"), "{text}");
    fs::write(folder.path().join("fire.sim.json"), &long).unwrap();
    fs::rename(folder.path().join("kept"), folder.path().join("fire.checkpoint")).unwrap();
    let text = stdout_of(folder.path(), &["sprite", "simulate", "fire.sim.json"]);
    assert!(text.starts_with("fire.checkpoint: goes on after ") && text.contains("fire.heat.png"), "{text}");
    assert!(!folder.path().join("fire.checkpoint").exists());
    for ending in ["png", "detail.png", "heat.png"] {
        let [whole, fire] =
            ["whole", "fire"].map(|name| fs::read(folder.path().join(format!("{name}.{ending}"))).unwrap());
        assert!(whole == fire, "{ending}");
    }
    fs::write(folder.path().join("fire.checkpoint"), "torn").unwrap();
    let said = refusal(folder.path(), &["sprite", "simulate", "fire.sim.json"]);
    assert!(said.contains("checkpoint: fire.checkpoint: no checkpoint of this version of haze; expected"), "{said}");
}

#[test]
fn wrong_simulations_are_refused_by_field() {
    let folder = folder();
    fs::write(folder.path().join("a.sim.json"), FIRE.replace("[0.2, 0.2, 0.2]", "[0.2, 0.2, -1]")).unwrap();
    let text = refusal(folder.path(), &["sprite", "simulate", "a.sim.json"]);
    assert!(text.contains("sources[0].radius: -1 is not valid; expected 0.001 to 4 box widths"), "{text}");
    fs::write(folder.path().join("b.sim.json"), FIRE.replace("\"duration\"", "\"length\"")).unwrap();
    let text = refusal(folder.path(), &["sprite", "simulate", "b.sim.json"]);
    assert!(text.contains("b.sim.json:5:") && text.contains("length"), "{text}");
    let text = refusal(folder.path(), &["sprite", "simulate", "a.sprite.json"]);
    assert!(text.contains("recipe: a.sprite.json is not valid; expected a *.sim.json file"), "{text}");
    let text = refusal(folder.path(), &["sprite", "simulate", "a.sim.json", "--albedo", "1"]);
    assert!(text.contains("--albedo: has no effect without --six-way"), "{text}");
}

/// Copies a file that OpenVDB has written.
fn copy_volume(name: &str, to: &Path) {
    let corpus = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/vdb"));
    fs::copy(corpus.join(name), to).unwrap();
}

#[test]
fn volumes_are_baked_to_sprites() {
    let folder = folder();
    copy_volume("good_simulation", &folder.path().join("one.vdb"));
    let bake = ["sprite", "bake", "--size", "32"];
    let text = stdout_of(
        folder.path(),
        &[&bake[..], &["one.vdb", "--six-way", "ash", "--samples", "2", "--up", "z"]].concat(),
    );
    let expected = "one.vdb: smoke from density, of which 1.328125 is 1; heat from temperature, of which 1.015625 is 1; \
                    motion from vel\none.vdb: up is z, as --up says\none.vdb: 14x12x14 cells of a voxel\n\
                    one.vdb: not read: color\none.png: 32x32\none.detail.png: 8x8\none.heat.png: 32x32\n\
                    one.six_way.png: 32x64\n  to look like ash: ";
    assert!(text.starts_with(expected), "{text}");
    for number in [1, 2, 4, 5] {
        copy_volume("good_half_blosc", &folder.path().join(format!("smoke_{number:04}.vdb")));
    }
    let output = haze(folder.path(), &[&bake[..], &["smoke_####.vdb", "--resolution", "24"]].concat());
    let missing = "haze: smoke_####.vdb: frames are missing, and the ones before them stay: 3\n";
    assert_eq!(stderr(&output), missing);
    let text = String::from_utf8(output.stdout).unwrap();
    let expected = "smoke_####.vdb: 14x8x7 cells of 2 voxels along each side\nsmoke_####.vdb: 4 of 5 frames, evenly \
                    spaced\nsmoke.png: 64x64\nsmoke.detail.png: 16x16\n";
    assert!(text.ends_with(expected), "{text}");
    // A PNG that was painted since is kept.
    image::GrayImage::new(4, 4).save(folder.path().join("smoke.png")).unwrap();
    let text = refusal(folder.path(), &[&bake[..], &["smoke_####.vdb"]].concat());
    assert!(text.contains("smoke.png was painted, or changed after it was baked, and is kept"), "{text}");
}

#[test]
fn volumes_and_options_that_do_not_fit_are_refused() {
    let folder = folder();
    copy_volume("good_blosc", &folder.path().join("a.vdb"));
    copy_volume("bad_level_set", &folder.path().join("b.vdb"));
    fs::write(folder.path().join("c.vdb"), "ply").unwrap();
    fs::write(folder.path().join("d.sprite.json"), include_str!("../../../../../tests/corpus/sprite/good_first"))
        .unwrap();
    for (arguments, expected) in [
        (&["a.vdb", "--grid", "soot"][..], "a.vdb: no grid named soot; expected one, or --grid with the name"),
        (&["b.vdb"], "b.vdb: density: a level set, distances to a surface; expected a fog volume: convert it"),
        (&["c.vdb"], "c.vdb: this is no VDB file; expected one that OpenVDB has written"),
        (&["e_##.vdb"], "e_##.vdb: no such files; expected names with digits in place of #"),
        (&["a.vdb", "--columns", "2", "--rows", "1"], "columns and rows: 2 frames from 1; expected at most 1"),
        (&["a.vdb", "--albedo", "0.5"], "--albedo: has no effect without --six-way"),
        (&["d.sprite.json", "--up", "z"], "--up: has no effect on a recipe; expected a .vdb file, or the field"),
    ] {
        let text = refusal(folder.path(), &[&["sprite", "bake"], arguments].concat());
        assert!(text.contains(expected), "{text}");
    }
    assert!(!folder.path().join("a.png").exists());
}

#[test]
fn simulations_are_written_as_volumes_that_bake_to_the_same_sprite() {
    let folder = folder();
    fs::write(folder.path().join("fire.sim.json"), FIRE).unwrap();
    let text = stdout_of(folder.path(), &["sprite", "simulate", "fire.sim.json", "--vdb", "frames"]);
    assert!(text.starts_with("frames/fire_####.vdb: 8 frames, 20 per second\nfire.png: 128x64\n"), "{text}");
    let bake =
        ["sprite", "bake", "frames/fire_####.vdb", "--fps", "20", "--size", "32", "--columns", "4", "--rows", "2"];
    let text = stdout_of(folder.path(), &bake);
    assert!(text.contains("; heat from temperature") && text.contains("; motion from vel\n"), "{text}");
    assert!(text.contains("up is y, as haze writes\n"), "{text}");
    let [simulated, read] =
        ["fire.png", "frames/fire.png"].map(|name| image::open(folder.path().join(name)).unwrap().to_rgba8());
    assert_eq!(simulated.dimensions(), read.dimensions());
    let apart = simulated.pixels().zip(read.pixels()).map(|(a, b)| f32::from(a.0[3].abs_diff(b.0[3]))).sum::<f32>();
    let mean = apart / (128.0 * 64.0);
    // The densest smoke becomes 1, and the box is a little tighter. Without smoke it would be above 60.
    assert!(mean < 25.0, "{mean}");
}
