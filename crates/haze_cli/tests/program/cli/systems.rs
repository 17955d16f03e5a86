//! Layers, systems that are added to presets, and systems that are drawn alone.

use super::*;

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = haze(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Names and descriptions that `haze preset layers` prints.
fn layers(folder: &Path) -> Vec<(String, String)> {
    let list = done(folder, &["preset", "layers"]);
    let split = |line: &str| line.split_once("  ").map(|(name, text)| (name.to_owned(), text.trim().to_owned()));
    list.lines().map(|line| split(line).unwrap()).collect()
}

/// Fraction of the pixels of `out.png` that differ from those of another image.
fn changed(folder: &Path, before: &image::RgbaImage) -> f64 {
    let now = image::open(folder.join("out.png")).unwrap().to_rgba8();
    let differs = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8);
    let pixels = now.pixels().zip(before.pixels());
    pixels.filter(differs).count() as f64 / f64::from(now.width() * now.height())
}

#[test]
fn every_layer_is_described_checked_and_seen_in_the_demo_scene() {
    let folder = folder();
    // The yard with its lights, without the brazier at the origin.
    let mut empty = haze_preset::Preset::load("column").unwrap();
    empty.systems.clear();
    empty.environment.brazier = false;
    empty.camera.position = glam::vec3(0.6, 1.1, 3.4);
    empty.camera.target = glam::Vec3::Y * 0.8;
    empty.time = 6.5;
    std::fs::write(folder.path().join("empty.json"), empty.to_json("")).unwrap();
    assert!(render(folder.path(), &["empty.json"]).status.success());
    let before = image::open(folder.path().join("out.png")).unwrap().to_rgba8();
    let layers = layers(folder.path());
    assert!(layers.len() >= 8 && layers.iter().all(|(_, text)| text.len() > 10), "{layers:?}");
    for (name, _) in layers {
        done(folder.path(), &["preset", "add-system", "empty.json", &name, "-o", "with.json"]);
        assert_eq!(done(folder.path(), &["preset", "check", "with.json"]), "with.json: good\n", "{name}");
        assert!(render(folder.path(), &["with.json"]).status.success());
        let fraction = changed(folder.path(), &before);
        println!("{name}: {:.2} % of the pixels", 100.0 * fraction);
        // Sparks and embers are small.
        assert!(fraction > 0.002, "{name}: {fraction}");
    }
}

#[test]
fn a_layer_is_added_to_a_copy_or_to_the_file_itself() {
    let folder = folder();
    let load = |name: &str| haze_preset::Preset::load(folder.path().join(name)).unwrap();
    let said =
        done(folder.path(), &["preset", "add-system", "campfire", "sparks", "--at", "-1,0.5,2", "-o", "my.json"]);
    assert_eq!(said, "my.json: Campfire with the system \"sparks 2\", systems[2]\n");
    let [campfire, mine] = [haze_preset::Preset::load("campfire").unwrap(), load("my.json")];
    assert_eq!(mine.systems[..2], campfire.systems);
    let position = mine.systems[2].emitter.position;
    assert!((position - glam::vec3(-1.0, position.y, 2.0)).length() < 1e-6 && position.y >= 0.5);
    // A default that the file names stays.
    let text = std::fs::read_to_string(folder.path().join("my.json")).unwrap();
    assert!(!text.contains("\"near\""));
    let text = text.replacen("\"fov\"", "\"near\": 0.1, \"fov\"", 1);
    std::fs::write(folder.path().join("my.json"), &text).unwrap();
    done(folder.path(), &["preset", "add-system", "my.json", "steam"]);
    let now = std::fs::read_to_string(folder.path().join("my.json")).unwrap();
    assert!(now.contains("\"near\": 0.1"), "{now}");
    let names: Vec<_> = load("my.json").systems.into_iter().map(|system| system.name).collect();
    assert_eq!(names, ["fire", "sparks", "sparks 2", "steam"]);
}

#[test]
fn systems_that_cannot_be_added_are_refused_with_one_line() {
    let folder = folder();
    let refused = |arguments: &[&str]| refusal(folder.path(), &[&["preset", "add-system"], arguments].concat());
    let unknown = refused(&["campfire", "sprks", "-o", "a.json"]);
    let names: Vec<_> = layers(folder.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(unknown, format!("haze: LAYER: \"sprks\" is not valid; expected one of {}\n", names.join(", ")));
    assert_eq!(
        refused(&["campfire", "sparks"]),
        "haze: PRESET: campfire is no file; expected --output FILE.json, or the path of a file\n"
    );
    assert!(refused(&["campfire", "sparks", "-o", "a.png"]).contains("--output: a.png is not valid; expected a name"));
    assert!(refused(&["campfire", "sparks", "-o", "none/a.json"]).contains("a folder that exists"));
    assert!(refused(&["gone.json", "sparks"]).contains("gone.json"));
    let wrong = haze(folder.path(), &["preset", "add-system", "campfire", "sparks", "--at", "1,2", "-o", "a.json"]);
    assert!(!wrong.status.success() && stderr(&wrong).contains("expected X,Y,Z in metres"), "{}", stderr(&wrong));
    let mut full = haze_preset::Preset::load("campfire").unwrap();
    full.systems = vec![full.systems[1].clone(); haze_preset::MAX_SYSTEMS];
    std::fs::write(folder.path().join("full.json"), full.to_json("")).unwrap();
    let before = std::fs::read(folder.path().join("full.json")).unwrap();
    assert_eq!(refused(&["full.json", "sparks"]), "haze: systems: the preset has 32 systems; expected at most 32\n");
    assert!(std::fs::read(folder.path().join("full.json")).unwrap() == before);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn solo_draws_one_system_by_name_or_number() {
    let folder = folder();
    let image = |arguments: &[&str]| {
        let output = render(folder.path(), &[&["campfire"], arguments].concat());
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        std::fs::read(folder.path().join("out.png")).unwrap()
    };
    let [all, fire, sparks] = [image(&[]), image(&["--solo", "fire"]), image(&["--solo", "sparks"])];
    assert!(all != fire && all != sparks && fire != sparks);
    assert!(image(&["--solo", "1"]) == sparks);
    // Settings are named by their positions in the preset.
    let set = ["--set", "systems[1].settings.fire.intensity=1"];
    assert!(image(&[&["--solo", "1"], &set[..]].concat()) != sparks);
    let said = refusal(folder.path(), &["render", "campfire", "--solo", "smoke", "-o", "a.png"]);
    assert_eq!(said, "haze: --solo: \"smoke\" is not valid; expected one of \"fire\", \"sparks\"\n");
    let said = refusal(folder.path(), &["render", "campfire", "--solo", "2", "-o", "a.png"]);
    assert!(said.contains("expected one of \"fire\", \"sparks\""), "{said}");
}
