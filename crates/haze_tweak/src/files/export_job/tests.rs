//! Tests of exports from the window.

use std::fs;
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Modifiers, PointerButton, Role, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use haze_preset::{Preset, SceneName};
use tempfile::TempDir;

use super::*;
use crate::platform::render_job::Alpha;
use crate::session::macro_param::THICKNESS;
use crate::window::{Window, testing};

struct Bench {
    folder: TempDir,
    window: Harness<'static, Window>,
}

fn bench() -> Bench {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my.json");
    fs::write(&path, Preset::load("fence").unwrap().to_json("")).unwrap();
    // High enough for the last row of the look page.
    let mut window = testing::window(path.to_str().unwrap(), Vec2::new(800.0, 540.0), Theme::Dark);
    window.state_mut().export_job.options =
        ExportOptions { size: UVec2::new(64, 36), last: 3, ..ExportOptions::default() };
    Bench { folder, window }
}

impl Bench {
    fn until(&mut self, is_so: impl Fn(&Window) -> bool) {
        let start = Instant::now();
        while !is_so(self.window.state()) {
            let said = self.window.state().session.messages.latest().cloned();
            assert!(start.elapsed() < Duration::from_secs(60), "never; said: {said:?}");
            self.window.step();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn said(&self) -> String {
        self.window.state().session.messages.latest().map(|message| message.text.clone()).unwrap_or_default()
    }

    /// Runs an export and returns the names of new files beside the preset.
    fn make(&mut self, product: ExportKind) -> Vec<String> {
        self.window.state_mut().export_job.product = product.clone();
        self.window.state_mut().export_job.is_open = true;
        self.window.run_steps(2);
        self.window.get_by_label(if product.is_sheet() { "Preview" } else { "Export…" }).click();
        self.window.run_steps(2);
        if !product.is_sheet() {
            self.confirm_path();
        }
        self.until(|window| window.export_job.progress().is_none());
        self.window.run_steps(2);
        self.names()
    }

    /// Accepts the suggested path.
    fn confirm_path(&mut self) {
        assert!(self.window.state().file_actions.typed.is_some());
        self.window.key_press(Key::Enter);
        self.window.run_steps(3);
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| name != "my.json");
        names.sort();
        names
    }
}

#[test]
fn an_image_is_saved_beside_the_preset_without_replacing_files() {
    let mut bench = bench();
    for _ in 0..2 {
        bench.window.key_press(Key::F12);
        bench.window.run_steps(2);
        bench.confirm_path();
        bench.until(|window| window.export_job.progress().is_none());
        bench.window.run_steps(2);
        assert!(bench.said().starts_with("Exported "), "{}", bench.said());
    }
    let names = bench.names();
    assert_eq!(names.len(), 2, "{names:?}");
    assert!(names.iter().all(|name| name.ends_with("s.png") || name.ends_with("s_2.png")), "{names:?}");
    let image = haze_core::assets::image::read_png(&bench.folder.path().join(&names[0])).unwrap();
    let seen = 36.0 * bench.window.state().session.view.aspect;
    assert_eq!((image.width(), image.height()), (seen.round() as u32, 36));
}

#[test]
fn frames_are_written_as_sequence_flipbook_and_gif() {
    let mut bench = bench();
    let names = bench.make(ExportKind::Sequence);
    let folder = bench.folder.path().join(&names[0]);
    assert_eq!(fs::read_dir(folder).unwrap().count(), 4);
    let names = bench.make(ExportKind::Gif);
    assert!(names.iter().any(|name| name.ends_with(".gif")), "{names:?}");
    let names = bench.make(ExportKind::Flipbook);
    let name = names.iter().find(|name| name.contains("flipbook")).unwrap();
    let image = haze_core::assets::image::read_png(&bench.folder.path().join(name)).unwrap();
    assert_eq!((image.width(), image.height()), (8 * 64, 4 * 36));
}

#[test]
fn alpha_light_of_fire_loop_and_maps_of_a_flipbook_for_an_engine_are_chosen_in_the_dialog() {
    let mut bench = bench();
    bench.window.state_mut().session.document.preset.systems[0].settings.fire.intensity = 2.0;
    let job = &mut bench.window.state_mut().export_job;
    job.options.frame_size = UVec2::splat(16);
    job.options.cells = UVec2::new(1, 2);
    job.options.last = 1;
    job.product = ExportKind::EngineFlipbook;
    job.is_open = true;
    // The dialog moves until it fits into the window.
    bench.window.run_steps(4);
    for name in ["Premultiplied", "Separate"] {
        bench.window.get_by_label(name).click();
        bench.window.run_steps(2);
    }
    bench.window.get_by_role_and_label(Role::CheckBox, "Six-way maps").click();
    bench.window.run_steps(2);
    bench.window.get_by_role_and_label(Role::SpinButton, "Loop").click();
    bench.window.run_steps(2);
    bench.window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.window.event(Event::Text("9".into()));
    bench.window.run_steps(2);
    bench.window.key_press(Key::Enter);
    bench.window.run_steps(2);
    assert_eq!(bench.window.state().export_job.options.engine_flipbook.loop_fade, 1, "less than the number of frames");
    let names = bench.make(ExportKind::EngineFlipbook);
    let folder = bench.folder.path().join(&names[0]);
    let numbers = fs::read_to_string(folder.join("flipbook.json")).unwrap();
    for line in ["\"alpha\": \"premultiplied\"", "\"emission\": \"separate\"", "\"loop\": true"] {
        assert!(numbers.contains(line), "{numbers}");
    }
    assert!(folder.join("six_way_2.png").exists());
}

#[test]
fn files_and_alpha_are_chosen_in_the_dialog() {
    let mut bench = bench();
    bench.window.state_mut().export_job.product = ExportKind::Image;
    bench.window.state_mut().export_job.is_open = true;
    bench.window.run_steps(2);
    let choose = |bench: &mut Bench, name: &str| {
        bench.window.get_by_label(name).click();
        bench.window.run_steps(2);
    };
    assert!(bench.window.query_by_label("Premultiplied").is_none(), "images with the scene have no alpha");
    bench.window.state_mut().session.document.preset.environment.scene = SceneName::Empty;
    bench.window.run_steps(2);
    assert!(bench.window.query_by_label("Premultiplied").is_some(), "nothing is behind the smoke");
    bench.window.state_mut().session.document.preset.environment.scene = SceneName::Yard;
    bench.window.run_steps(2);
    choose(&mut bench, "Transparent");
    choose(&mut bench, "Premultiplied");
    choose(&mut bench, "PNG 16");
    let names = bench.make(ExportKind::Image);
    let image = haze_core::assets::image::read_png(&bench.folder.path().join(&names[0])).unwrap();
    assert_eq!(image.color(), image::ColorType::Rgba16);
    let format = bench.window.state().export_job.options.format;
    assert_eq!(format.alpha, Alpha::Premultiplied);
    choose(&mut bench, "EXR");
    assert!(bench.window.query_by_label("Premultiplied").is_none(), "EXR has no other");
    let names = bench.make(ExportKind::Image);
    let exr = names.iter().find(|name| name.ends_with(".exr")).unwrap();
    assert!(fs::read(bench.folder.path().join(exr)).unwrap().starts_with(&[0x76, 0x2f, 0x31, 0x01]));
    let names = bench.make(ExportKind::Sequence);
    let folder = names.iter().find(|name| name.contains("frames")).unwrap();
    let files = fs::read_dir(bench.folder.path().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    assert_eq!(files.filter(|file| file.extension().is_some_and(|ending| ending == "exr")).count(), 4);
}

#[test]
fn the_material_of_the_selected_system_is_written() {
    let mut bench = bench();
    bench.window.state_mut().export_job.options.engine = Engine::Godot;
    let names = bench.make(ExportKind::Material);
    let folder = names.iter().find(|name| name.ends_with("_material")).unwrap();
    let files = bench.folder.path().join(folder);
    let text = fs::read_to_string(files.join("haze_material.gdshader")).unwrap();
    let boost = bench.window.state().session.document.preset.systems[0].settings.boost;
    assert!(text.contains(&format!("HAZE_BOOST = {boost:?};")), "{text}");
    assert!(files.join("diffuse_ramp.png").is_file() && files.join("README.md").is_file());
}

#[test]
fn a_long_export_shows_progress_and_stops_and_a_new_sheet_replaces_the_old() {
    let mut bench = bench();
    let seeds = |bench: &mut Bench, size: UVec2| {
        bench.window.state_mut().export_job.options.size = size;
        bench.window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
        bench.window.run_steps(2);
    };
    seeds(&mut bench, UVec2::new(2560, 1440));
    let start = Instant::now();
    while bench.window.query_by_label("Stop").is_none() {
        assert!(start.elapsed() < Duration::from_secs(60) && bench.window.state().export_job.sheet.is_none());
        bench.window.step();
    }
    bench.window.get_by_label("Stop").click();
    bench.until(|window| window.export_job.progress().is_none());
    bench.window.run_steps(2);
    assert!(bench.window.state().export_job.sheet.is_none() && bench.window.query_by_label("Export…").is_none());
    let mut shown = |exposure: f32| {
        bench.window.state_mut().session.document.preset.camera.exposure = exposure;
        seeds(&mut bench, UVec2::new(192, 108));
        // The previous sheet is open meanwhile.
        bench.until(|window| window.export_job.progress().is_none());
        bench.window.run_steps(3);
        let part = bench.window.get_by_label("Image of the sheet").rect();
        testing::brightness(&testing::screenshot(&mut bench.window), part)
    };
    let dark = shown(-3.0);
    let bright = shown(2.0);
    assert!(bright > dark + 5.0, "{dark} {bright}");
}

#[test]
fn sheets_are_shown_and_saved_on_request() {
    let mut bench = bench();
    bench.window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    bench.window.run_steps(2);
    bench.until(|window| window.export_job.sheet.is_some());
    assert!(bench.names().is_empty());
    bench.window.run_steps(2);
    bench.window.get_by_label("Save…").click();
    bench.window.run_steps(2);
    bench.confirm_path();
    bench.until(|window| window.export_job.progress().is_none() && window.export_job.sheet.is_none());
    bench.window.run_steps(2);
    assert!(bench.names()[0].contains("seeds"), "{:?}", bench.names());
    for (product, count) in
        [(ExportKind::DebugView, 9), (ExportKind::Values("systems[0].settings.accumulate.downscale".into()), 1)]
    {
        bench.make(product);
        bench.until(|window| window.export_job.sheet.is_some());
        let Sheet { image, .. } = bench.window.state_mut().export_job.sheet.take().unwrap();
        assert!(image.width() > 64 && count > 0);
    }
}

#[test]
fn a_stopped_export_is_reported_as_partial() {
    let mut bench = bench();
    bench.window.state_mut().export_job.options.last = 9999;
    bench.window.state_mut().export_job.is_open = true;
    bench.window.run_steps(2);
    bench.window.get_by_label("Export…").click();
    bench.window.run_steps(2);
    bench.confirm_path();
    bench.until(|window| window.export_job.progress().is_some_and(|(done, _)| done >= 2));
    bench.window.step();
    bench.window.get_by_label("Stop").click();
    bench.until(|window| window.export_job.progress().is_none());
    bench.window.run_steps(2);
    assert!(bench.said().contains("this sequence is partial, "), "{}", bench.said());
}

#[test]
fn the_row_menu_makes_the_same_sheet_as_the_export_dialog() {
    let mut bench = bench();
    let path = "camera.exposure";
    bench.make(ExportKind::Values(path.into()));
    bench.until(|window| window.export_job.sheet.is_some());
    let Sheet { image: made, .. } = bench.window.state_mut().export_job.sheet.take().unwrap();
    bench.window.state_mut().export_job.is_open = false;
    bench.window.run_steps(3);
    testing::row_menu(&mut bench.window, "Exposure");
    bench.window.get_by_label("Five values side by side").click();
    bench.window.run_steps(2);
    bench.until(|window| window.export_job.sheet.is_some());
    let Sheet { image: sheet, .. } = bench.window.state_mut().export_job.sheet.take().unwrap();
    assert!(sheet == made, "another sheet");
    // The same for a row that several settings make.
    testing::row_menu(&mut bench.window, "Thickness");
    bench.window.get_by_label("Five values side by side").click();
    bench.window.run_steps(2);
    bench.until(|window| window.export_job.sheet.is_some());
    let Sheet { kind, .. } = bench.window.state_mut().export_job.sheet.take().unwrap();
    assert_eq!(kind.file_ending(FileKind::Png).0, "thickness");
}

#[test]
fn the_button_beside_a_name_makes_a_sheet() {
    let mut bench = bench();
    bench.window.state_mut().session.hints.begin();
    let mut made = |tab: &str, name: &str, button: &str| {
        bench.window.get_by_label(tab).click();
        bench.window.run_steps(3);
        assert!(bench.window.query_by_label(button).is_none());
        let name = testing::row_name(&bench.window, name);
        bench.window.hover_at(name);
        bench.window.run_steps(2);
        let position = bench.window.get_by_label(button).rect().center();
        testing::click_at(&mut bench.window, position, PointerButton::Primary);
        bench.until(|window| window.export_job.sheet.is_some());
        let kind = bench.window.state().export_job.sheet.as_ref().unwrap().kind.clone();
        // Escape closes the sheet and nothing below it.
        let hints = bench.window.state().session.hints.left();
        bench.window.key_press(Key::Escape);
        bench.window.run_steps(2);
        let window = bench.window.state();
        assert!(window.export_job.sheet.is_none() && window.session.hints.left() == hints && !hints.is_empty());
        kind.file_ending(FileKind::Png).0.to_owned()
    };
    assert!(made("Look", "Thickness", "Five values side by side: Thickness").contains("thickness"));
    assert!(made("Advanced", "Coverage", "All values side by side: Coverage").contains("coverage"));
    assert!(made("Smoke", "Seed", "Nine seeds side by side: Seed").contains("seeds"));
}

#[test]
fn values_of_a_field_cover_its_slider_or_surround_its_value_and_are_valid() {
    let shot = Shot::load("column", UVec2::new(64, 36)).unwrap();
    let labels = |path: &str| variations(&shot, path).into_iter().map(|(label, _)| label).collect::<Vec<_>>();
    assert_eq!(labels("systems[0].settings.boost").len(), 5);
    assert_eq!(labels("systems[0].settings.accumulate.opacity"), ["0", "0.25", "0.5", "0.75", "1"]);
    let rate = shot.preset.systems[0].emitter.rate;
    let rates = [0.25, 0.5, 1.0, 2.0, 4.0].map(|times| (rate * times).to_string());
    assert_eq!(labels("systems[0].emitter.rate"), rates);
    assert_eq!(labels("systems[0].emitter.seed").len(), 5);
    assert!(labels("systems[0].emitter.wind").is_empty());
    assert_eq!(labels("systems[0].settings.debug.freeze_animation").len(), 2);
    assert!(labels("systems[0].settings.path").contains(&"forward".to_owned()));
    assert!(labels("systems[0].settings.accumulate.downscale").iter().all(|label| label.parse::<u32>().unwrap() <= 16));
    assert!(labels("systems[0].name").is_empty());
    let thicker = variations(&shot, "systems[0].thickness").into_iter().map(|(label, shot)| {
        let of = &shot.preset.systems[0];
        let thickness = (THICKNESS.get)(of);
        assert!((thickness / label.parse::<f32>().unwrap() - 1.0).abs() < 1e-2, "{label} {thickness}");
        thickness
    });
    let thicker: Vec<_> = thicker.collect();
    assert!(thicker.len() == 5 && thicker.is_sorted(), "{thicker:?}");
    assert_eq!((labels("systems[0].wind").len(), labels("systems[0].softness").len()), (5, 5));
    assert!(labels("systems[1].wind").is_empty());
}

#[test]
fn the_folder_of_an_export_is_remembered_and_files_have_the_name_of_the_document() {
    let mut bench = bench();
    let folder = bench.folder.path().join("pictures");
    fs::create_dir(&folder).unwrap();
    let ask = |bench: &mut Bench| {
        bench.window.key_press(Key::F12);
        bench.window.run_steps(2);
        bench.window.state().file_actions.typed.as_ref().unwrap().text.clone()
    };
    let suggested = ask(&mut bench);
    let name = Path::new(&suggested).file_name().unwrap().to_str().unwrap().to_owned();
    assert!(name.starts_with("my_") && name.ends_with("s.png"), "{suggested}");
    // Escape cancels.
    bench.window.key_press(Key::Escape);
    bench.window.run_steps(3);
    assert!(bench.window.state().export_job.progress().is_none() && bench.names() == ["pictures"]);
    ask(&mut bench);
    let typed = folder.join("mine").display().to_string();
    bench.window.state_mut().file_actions.typed.as_mut().unwrap().text = typed;
    bench.window.run_steps(2);
    bench.confirm_path();
    bench.until(|window| window.export_job.progress().is_none());
    bench.window.run_steps(2);
    assert!(folder.join("mine.png").exists(), "{}", bench.said());
    assert_eq!(Path::new(&ask(&mut bench)).parent(), Some(&*folder));
    assert_eq!(bench.window.state().layout().export_folder.as_deref(), Some(&*folder));
}
