//! Tests of the File menu through the window.

mod saving;

use std::fs;
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Modifiers, Theme, Vec2, ViewportEvent, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use haze::FieldError;
use haze_preset::Preset;
use tempfile::TempDir;

use super::*;
use crate::files::persistence::{Layout, Persistence};
use crate::files::shared_look;
use crate::window::{Start, Window, testing};

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

struct Bench {
    folder: TempDir,
    window: Harness<'static, Window>,
}

/// Opens a preset that is saved in a folder of its own.
fn bench() -> Bench {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my.json");
    fs::write(&path, Preset::load("column").unwrap().to_json("")).unwrap();
    Bench { window: window(&path, Some(folder.path().join("state"))), folder }
}

fn window(path: &Path, state: Option<PathBuf>) -> Harness<'static, Window> {
    let mut session = Session::open(path, None).unwrap();
    let persistence = state.map(|folder| Persistence::new(folder, &mut session));
    let start = Start { persistence, ..testing::start_of(session) };
    testing::open(start, Vec2::new(800.0, 500.0), Theme::Dark)
}

impl Bench {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn session(&mut self) -> &mut Session {
        &mut self.window.state_mut().session
    }

    fn said(&mut self) -> String {
        self.session().messages.latest().map(|message| message.text.clone()).unwrap_or_default()
    }

    fn until(&mut self, is_so: impl Fn(&mut Self) -> bool) {
        let start = Instant::now();
        while !is_so(self) {
            assert!(start.elapsed() < Duration::from_secs(30), "never; said: {:?}", self.said());
            self.window.step();
        }
    }

    fn change(&mut self, exposure: f32) {
        self.session().document.preset.camera.exposure = exposure;
        self.window.run_steps(2);
    }

    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.window.key_press_modifiers(modifiers, key);
        self.window.run_steps(3);
    }

    fn click(&mut self, label: &str) {
        self.window.get_by_label(label).click();
        self.window.run_steps(3);
    }

    /// Types into the text field for paths.
    fn type_path(&mut self, path: &Path) {
        self.window.state_mut().file_actions.typed.as_mut().unwrap().text = path.display().to_string();
        self.window.run_steps(2);
        self.press(Modifiers::NONE, Key::Enter);
    }

    fn drop_file(&mut self, path: &Path) {
        #[derive(Debug)]
        struct DroppedImage(PathBuf);
        impl egui::DroppedFile for DroppedImage {
            fn path(&self) -> &Path {
                &self.0
            }
            fn bytes(&self) -> Result<Vec<u8>, String> {
                Err("not read".into())
            }
        }
        self.window.input_mut().dropped_files = vec![Arc::new(DroppedImage(path.into()))];
        self.window.step();
    }

    fn close(&mut self) {
        let viewports = &mut self.window.input_mut().viewports;
        viewports.entry(ViewportId::ROOT).or_default().events.push(ViewportEvent::Close);
        self.window.run_steps(2);
    }
}

fn exposure(path: &Path) -> i32 {
    (Preset::load(path).unwrap().camera.exposure * 100.0) as i32
}

#[test]
fn opening_another_preset_asks_about_unsaved_work() {
    let mut bench = bench();
    bench.change(1.5);
    let other = bench.path("other.json");
    fs::write(&other, Preset::load("fence").unwrap().to_json("")).unwrap();
    let open = |bench: &mut Bench| {
        bench.press(Modifiers::COMMAND, Key::O);
        bench.type_path(&other);
        bench.until(|bench| bench.window.state().file_actions.waiting.is_some());
        bench.window.run_steps(2);
    };
    open(&mut bench);
    bench.click("Cancel");
    assert_eq!(
        (bench.session().document.path().to_owned(), exposure(&bench.path("my.json"))),
        (bench.path("my.json"), 55)
    );
    open(&mut bench);
    bench.click("Save");
    bench.until(|bench| bench.session().document.path().ends_with("other.json"));
    assert_eq!(exposure(&bench.path("my.json")), 150);
    assert!(!bench.session().document.is_dirty());
}

#[test]
fn an_unreadable_file_is_reported_once_and_the_document_stays() {
    let mut bench = bench();
    bench.change(1.5);
    let big = bench.path("big.json");
    fs::File::create(&big).unwrap().set_len(10 << 30).unwrap();
    let image = bench.path("image.png");
    fs::write(&image, "no image").unwrap();
    let folder = bench.folder.path().to_owned();
    let gone = bench.path("gone.json");
    for (path, expected) in
        [(&folder, "a folder, not a file"), (&big, "10737418240 bytes"), (&image, "not a PNG"), (&gone, "No such file")]
    {
        bench.drop_file(path);
        bench.until(|bench| bench.said().contains(expected));
        assert!(bench.window.state().file_actions.waiting.is_none());
    }
    assert_eq!((bench.session().document.preset.camera.exposure * 100.0) as i32, 150);
    assert_eq!(bench.session().document.path().file_name().unwrap(), "my.json");
    // A click removes the message.
    let said = bench.said();
    bench.window.run_steps(2);
    bench.click(&said);
    assert_eq!(bench.said(), "");
}

#[test]
fn long_and_unusual_names_do_not_change_the_layout() {
    let mut bench = bench();
    let find = |bench: &Bench| bench.window.get_by_label("Find").rect();
    let before = find(&bench);
    let name = format!("a\nname\t{}", "of many words ".repeat(300));
    let preset = &mut bench.session().document.preset;
    preset.systems.push(preset.systems[0].clone());
    preset.name = name.clone();
    preset.systems[0].name = name.clone();
    preset.systems[1].name = name;
    bench.window.run_steps(3);
    assert_eq!(find(&bench), before);
    let path = bench.path("a\nb.json");
    bench.press(COMMAND_SHIFT, Key::S);
    bench.type_path(&path);
    bench.until(|bench| bench.said().starts_with("Saved "));
    assert!(bench.said().ends_with("a b.json") && path.exists());
    // Longer than a file name can be.
    bench.press(COMMAND_SHIFT, Key::S);
    bench.type_path(&path.with_file_name(format!("{}.json", "n".repeat(4000))));
    bench.until(|bench| bench.said().contains("too long"));
    assert!(bench.said().contains('…') && bench.session().document.path() == path);
    assert_eq!(find(&bench), before);
}

#[test]
fn a_dropped_preset_is_opened_and_a_dropped_ramp_is_used() {
    let mut bench = bench();
    let ramp = bench.path("mine.png");
    let gray = image::RgbImage::from_pixel(64, 1, image::Rgb([20; 3]));
    haze_preset::write_png(&ramp, &gray.into(), haze_preset::CompressionEffort::Quick).unwrap();
    bench.drop_file(&ramp);
    bench.until(|bench| bench.session().document.preset.systems[0].material.diffuse_ramp == "mine.png");
    assert_eq!(bench.said(), "mine.png is now the diffuse ramp of smoke");
    bench.session().undo();
    let scatter = bench.path("scatter_mine.png");
    fs::rename(&ramp, &scatter).unwrap();
    bench.drop_file(&scatter);
    bench.until(|bench| bench.session().document.preset.systems[0].material.soft_scatter_ramp == "scatter_mine.png");
    assert_ne!(bench.session().document.preset.systems[0].material.diffuse_ramp, "scatter_mine.png");
    bench.session().undo();
    let other = bench.path("other.json");
    fs::write(&other, Preset::load("fence").unwrap().to_json("")).unwrap();
    bench.window.run_steps(2);
    bench.drop_file(&other);
    bench.until(|bench| bench.session().document.path() == other);
}

/// A file of the example with an own scene and sky.
fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/own_scene").join(name)
}

#[test]
fn a_dropped_scene_and_sky_are_shown_from_any_folder_and_copied_when_the_preset_is_saved() {
    let mut bench = bench();
    let before = bench.session().document.preset.clone();
    bench.drop_file(&example("court.glb"));
    bench.until(|bench| bench.session().document.preset.environment.scene_file == "court.glb");
    assert!(bench.said().starts_with("court.glb is now the scene: ") && bench.said().ends_with(", a camera, 2 lights"));
    bench.drop_file(&example("dusk.hdr"));
    bench.until(|bench| bench.session().document.preset.environment.sky_file == "dusk.hdr");
    assert_eq!(bench.said(), "dusk.hdr is now the sky. It lights the scene and the smoke");
    let link = shared_look::fragment_of(bench.session()).unwrap_err().to_string();
    assert!(link.starts_with("link: environment.scene_file names a file; expected the demo scene"), "{link}");
    // The artist's camera and lights stay until others are asked for.
    let dropped = bench.session().document.preset.clone();
    assert!(dropped.camera == before.camera && dropped.lights == before.lights);
    let shot = bench.session().shot(glam::UVec2::new(16, 9));
    assert!(shot.backdrop.scene.is_some() && shot.backdrop.sky.is_some());
    bench.window.get_by_role_and_label(egui::accesskit::Role::Button, "Light").click();
    bench.window.run_steps(4);
    for name in ["Use its camera", "Use its lights"] {
        bench.window.get_by_label(name).scroll_to_me();
        bench.window.run_steps(4);
        bench.click(name);
    }
    let taken = bench.session().document.preset.clone();
    assert_eq!((taken.lights.len(), taken.camera.exposure.to_bits()), (2, before.camera.exposure.to_bits()));
    assert_ne!(taken.camera.position, before.camera.position);
    bench.press(Modifiers::COMMAND, Key::S);
    bench.until(|bench| !bench.session().document.is_dirty());
    for name in ["court.glb", "dusk.hdr"] {
        assert_eq!(fs::read(bench.path(name)).unwrap(), fs::read(example(name)).unwrap());
    }
    for _ in 0..4 {
        bench.session().undo();
    }
    assert!(bench.session().document.preset == before);
    bench.window.run_steps(2);
    assert!(bench.session().shot(glam::UVec2::new(16, 9)).backdrop.scene.is_none());
}

#[test]
fn a_sky_beside_a_scene_from_blender_is_turned() {
    let mut bench = bench();
    let scene = bench.path("view.gltf");
    let text = r#"{"asset":{"version":"2.0","generator":"Khronos glTF Blender I/O v5.0.21"},"scenes":[{"nodes":[0,1]}],
        "nodes":[{"camera":0,"name":"front"},{"camera":0,"name":"back","translation":[0,0,-9]}],
        "cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}]}"#;
    fs::write(&scene, text).unwrap();
    bench.drop_file(&scene);
    bench.until(|bench| bench.session().document.preset.environment.scene_file == "view.gltf");
    assert_eq!(bench.said(), "view.gltf is now the scene: 0 triangles, 2 cameras");
    bench.drop_file(&example("dusk.hdr"));
    bench.until(|bench| bench.session().document.preset.environment.sky_file == "dusk.hdr");
    let rotation = |bench: &mut Bench| bench.session().document.preset.environment.sky_rotation.to_bits();
    assert!(
        bench.said().starts_with("dusk.hdr is now the sky, turned as the world of a scene from Blender. It lights")
    );
    assert_eq!(rotation(&mut bench), 90.0_f32.to_bits());
    bench.session().document.preset.environment.sky_rotation = 0.0;
    bench.window.get_by_role_and_label(egui::accesskit::Role::Button, "Light").click();
    bench.window.run_steps(4);
    bench.window.get_by_label("Sky from Blender").scroll_to_me();
    bench.window.run_steps(4);
    bench.click("Sky from Blender");
    assert_eq!(rotation(&mut bench), 90.0_f32.to_bits());
    // Of several cameras, one is chosen.
    bench.click("Use its camera");
    bench.click("back");
    assert_eq!(bench.session().document.preset.camera.position.z.to_bits(), (-9.0_f32).to_bits());
}

#[test]
fn a_dropped_file_that_is_no_scene_changes_nothing_and_says_why() {
    let mut bench = bench();
    let before = bench.session().document.preset.clone();
    let broken = bench.path("broken.glb");
    fs::write(&broken, &fs::read(example("court.glb")).unwrap()[..400]).unwrap();
    bench.drop_file(&broken);
    bench.until(|bench| bench.said().contains("broken.glb: "));
    assert!(bench.said().ends_with("; expected a whole glTF 2.0 file"), "{}", bench.said());
    // The name would stand for another file.
    fs::write(bench.path("dusk.hdr"), "another").unwrap();
    bench.drop_file(&example("dusk.hdr"));
    bench.until(|bench| bench.said().contains("dusk.hdr has the name of "));
    assert!(bench.session().document.preset == before);
}

#[test]
fn a_preset_can_be_copied_and_pasted_and_an_invalid_text_is_refused() {
    let mut bench = bench();
    let mut preset = Preset::load("fence").unwrap();
    preset.camera.exposure = 0.5;
    let paste = |bench: &mut Bench, text: &str| {
        bench.window.event(Event::Paste(text.into()));
        bench.window.run_steps(2);
    };
    let before = bench.session().document.preset.clone();
    for nonsense in ["some text", &preset.to_json("").replace("0.5", "NaN")] {
        paste(&mut bench, nonsense);
        assert!(bench.said().starts_with("Cannot paste: "), "{}", bench.said());
        assert!(bench.session().document.preset == before);
    }
    paste(&mut bench, &preset.to_json(""));
    assert!(bench.session().document.preset == preset);
    bench.press(Modifiers::COMMAND, Key::Z);
    assert!(bench.session().document.preset == before);
    let key = Event::Key { key: Key::C, physical_key: None, pressed: true, repeat: false, modifiers: COMMAND_SHIFT };
    bench.window.input_mut().events.push(key);
    bench.window.step();
    let copied = |command: &egui::OutputCommand| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    };
    let text = bench.window.output().platform_output.commands.iter().find_map(copied).unwrap();
    assert!(Preset::parse(Path::new("copied"), &text).unwrap() == before);
}

#[test]
fn closing_a_window_asks_about_unsaved_work() {
    let mut bench = bench();
    bench.close();
    assert!(bench.window.state().file_actions.waiting.is_none());
    bench.change(1.5);
    bench.close();
    let cancels = |bench: &Bench| {
        let commands = bench.window.output().viewport_output.values().flat_map(|output| &output.commands);
        commands.cloned().collect::<Vec<_>>()
    };
    bench.click("Don't Save");
    bench.window.step();
    assert!(cancels(&bench).contains(&egui::ViewportCommand::Close));
    assert_eq!(exposure(&bench.path("my.json")), 55);
}

#[test]
fn the_preset_list_shows_built_in_presets_and_those_of_the_folder() {
    let mut bench = bench();
    fs::write(bench.path("no_preset.json"), "{}").unwrap();
    bench.press(Modifiers::COMMAND, Key::N);
    bench.until(|bench| bench.window.state().thumbnails.entries.iter().all(|entry| entry.about.is_some()));
    let names: Vec<_> = bench.window.state().thumbnails.entries.iter().map(|entry| entry.path.clone()).collect();
    assert!(names.contains(&bench.path("my.json")) && names.contains(&"fence".into()), "{names:?}");
    assert!(!names.contains(&bench.path("no_preset.json")));
    let name = Preset::load("backlit_fog").unwrap().name;
    bench.window.get_by_role_and_label(egui::accesskit::Role::Button, &name).click();
    bench.until(|bench| bench.session().document.path() == Path::new("backlit_fog"));
}
