//! Tasks of an artist, and the number of actions that each takes: a click, a drag or a key is one.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Role, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze::{LightKind, LightRole};
use haze_author::daylight::sun_of;
use haze_author::ramp::template::Template;
use haze_core::settings::CoverageMode;
use haze_preset::{CompressionEffort, Preset, write_png};
use image::RgbaImage;

use crate::window::Window;
use crate::window::testing::{brightness, click_at, screenshot, window};

/// Window whose actions are counted.
struct Script {
    harness: Harness<'static, Window>,
    actions: u32,
}

impl Script {
    fn open(preset: &str, size: Vec2) -> Self {
        Self { harness: window(preset, size, Theme::Dark), actions: 0 }
    }

    fn click(&mut self, name: &str) {
        self.actions += 1;
        self.harness.get_by_label(name).click();
        self.harness.run_steps(4);
    }

    fn right_click(&mut self, at: Pos2) {
        self.actions += 1;
        click_at(&mut self.harness, at, PointerButton::Secondary);
    }

    fn key(&mut self, key: Key, modifiers: Modifiers) {
        self.actions += 1;
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.run_steps(4);
    }

    /// Drags the slider of a row to a fraction of its length.
    fn drag_slider(&mut self, name: &str, fraction: f32) {
        self.actions += 1;
        let sliders = self.harness.get_all_by_label(name);
        let slider = sliders.into_iter().find(|node| node.accesskit_node().role() == Role::Slider).unwrap().rect();
        self.drag(slider.center(), Modifiers::NONE, |_, step| {
            (step < 3).then(|| slider.left_center() + Vec2::new(fraction * slider.width(), 0.0))
        });
    }

    /// Presses, moves to the positions that `next` returns, and releases.
    fn drag(
        &mut self,
        from: Pos2,
        modifiers: Modifiers,
        mut next: impl FnMut(&mut Harness<'static, Window>, u32) -> Option<Pos2>,
    ) {
        let harness = &mut self.harness;
        let button = |pos, pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers };
        harness.event(Event::ModifiersChanged(modifiers));
        harness.hover_at(from);
        harness.run_steps(2);
        harness.event(button(from, true));
        harness.run_steps(2);
        let mut at = from;
        let mut step = 0;
        while let Some(to) = next(harness, step) {
            harness.hover_at(to);
            harness.run_steps(2);
            at = to;
            step += 1;
        }
        harness.event(button(at, false));
        harness.event(Event::ModifiersChanged(Modifiers::NONE));
        harness.run_steps(4);
    }

    fn preset(&self) -> &Preset {
        &self.harness.state().session.document.preset
    }

    fn image(&self) -> Rect {
        self.harness.get_by_label("viewport").rect()
    }
}

/// Mean red over mean blue of a part of an image.
fn warmth(image: &RgbaImage, part: Rect) -> f64 {
    let mut sums = [0.0; 3];
    for y in part.top() as u32..part.bottom() as u32 {
        for x in part.left() as u32..part.right() as u32 {
            let pixel = image.get_pixel(x, y).0;
            sums.iter_mut().zip(pixel).for_each(|(sum, channel)| *sum += f64::from(channel));
        }
    }
    sums[0] / sums[2]
}

#[test]
fn a_sunset_from_the_column_takes_at_most_8_actions() {
    let mut script = Script::open("column", Vec2::new(1000.0, 640.0));
    script.click("Light");
    script.click("Add a sun");
    script.click("Noon");
    let noon = warmth(&screenshot(&mut script.harness), script.image());
    script.click("Sunset");
    script.drag_slider("Sun azimuth", 0.25);
    script.click("Point 1");
    script.click("Delete");
    assert!(script.actions <= 8, "{}", script.actions);
    let lights = &script.preset().lights;
    assert!(sun_of(lights).is_some() && lights.len() == 3, "{lights:?}");
    let sunset = warmth(&screenshot(&mut script.harness), script.image());
    assert!(sunset > 1.1 * noon, "{sunset} {noon}");
}

#[test]
fn a_toon_look_takes_at_most_6_actions() {
    let mut script = Script::open("column", Vec2::new(1000.0, 1400.0));
    script.click("Ramps");
    script.click("Looks: Diffuse ramp");
    script.click("Look diffuse_soft_toon");
    script.click("Turn on coverage ramp: Coverage ramp");
    script.click("Looks: Coverage ramp");
    script.click("Look coverage_cut");
    assert!(script.actions <= 6, "{}", script.actions);
    let system = &script.preset().systems[0];
    assert_eq!(system.settings.coverage, CoverageMode::Ramp);
    assert_eq!(system.material.diffuse_ramp, "diffuse_soft_toon");
    assert_eq!(system.material.coverage_ramp, "coverage_cut");
}

#[test]
fn a_rim_light_takes_at_most_3_actions() {
    let mut script = Script::open("column", Vec2::new(1000.0, 640.0));
    let middle = script.image().center();
    script.right_click(middle);
    script.click("Add Rim Light");
    assert!(script.actions <= 3, "{}", script.actions);
    let preset = script.preset();
    let rim = preset.lights.last().unwrap();
    assert_eq!((preset.lights.len(), rim.role, rim.kind), (4, LightRole::Rim, LightKind::Point));
    let view = preset.camera.target - preset.camera.position;
    assert!((rim.position - preset.camera.target).dot(view) > 0.0, "{rim:?}");
}

#[test]
fn the_brightness_of_a_pixel_is_matched_by_one_drag_on_the_smoke() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut preset = Preset::load("column").unwrap();
    preset.systems[0].material.diffuse_ramp = "mine.png".into();
    std::fs::write(path("own.json"), preset.to_json("")).unwrap();
    let recipe = Template::find("neutral").unwrap().recipe();
    std::fs::write(path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let mut script = Script::open(path("own.json").to_str().unwrap(), Vec2::new(1000.0, 640.0));
    let position = script.image().center();
    let around = Rect::from_center_size(position, Vec2::splat(12.0));
    let wanted = brightness(&screenshot(&mut script.harness), around) + 18.0;
    script.click("Inspect");
    let actions = script.actions;
    script.harness.hover_at(position);
    let start = Instant::now();
    while script.harness.query_all_by_label_contains("Coverage").next().is_none() {
        assert!(start.elapsed() < Duration::from_secs(20), "no values of the pixel");
        screenshot(&mut script.harness);
        std::thread::sleep(Duration::from_millis(20));
    }
    let mut found = 0.0;
    script.actions += 1;
    script.drag(position, Modifiers::COMMAND, |harness, step| {
        // Upwards until the smoke is as bright as wanted.
        found = brightness(&screenshot(harness), around);
        (found < wanted && step < 100).then(|| position - Vec2::new(0.0, 4.0 * (step + 3) as f32))
    });
    assert!((found - wanted).abs() < 4.0, "{found} {wanted}");
    assert_eq!(script.actions - actions, 1);
    assert_eq!(script.harness.state().session.document.history().undo_name(), Some("Paint on smoke: mine.png"));
}

#[test]
fn sparks_are_added_to_a_campfire_in_at_most_4_actions() {
    let mut script = Script::open("campfire", Vec2::new(1000.0, 640.0));
    script.click("Add system");
    script.click("Sparks");
    assert!(script.actions <= 4, "{}", script.actions);
    let [fire, _, added] = &script.preset().systems[..] else { panic!("three systems") };
    assert_eq!(added.name, "sparks 2");
    // They rise from the fire.
    let above = added.emitter.position - fire.emitter.position;
    assert!(above.with_y(0.0).length() < 1e-6 && (0.0..0.3).contains(&above.y), "{above}");
    assert_eq!(script.harness.state().session.view.system, 2);
}

#[test]
fn a_flipbook_with_normals_takes_at_most_3_actions() {
    let folder = tempfile::tempdir().unwrap();
    let mut script = Script::open("fence", Vec2::new(1000.0, 640.0));
    let job = &mut script.harness.state_mut().export_job;
    job.folder = Some(folder.path().to_owned());
    job.options.frame_size = glam::UVec2::splat(16);
    job.options.cells = glam::UVec2::new(1, 2);
    job.options.last = 1;
    script.key(Key::E, Modifiers::COMMAND.plus(Modifiers::ALT));
    // Accepts the suggested folder.
    script.key(Key::Enter, Modifiers::NONE);
    assert!(script.actions <= 3, "{}", script.actions);
    let start = Instant::now();
    while script.harness.state().export_job.progress().is_some() {
        assert!(start.elapsed() < Duration::from_secs(60));
        script.harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    script.harness.run_steps(3);
    let made = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
    let has = |name: &str| Path::new(&made).join(name).is_file();
    assert!(has("color.png") && has("normals.png") && has("flipbook.json"), "{made:?}");
}

#[test]
fn steam_under_a_sun_takes_at_most_15_actions() {
    let mut script = Script::open("column", Vec2::new(1000.0, 640.0));
    script.click("Add system");
    script.click("Steam");
    script.click("Edit smoke");
    script.click("Delete");
    script.click("Light");
    script.click("Add a sun");
    script.click("Noon");
    for lamp in ["Point 1", "Practical (Point 2)"] {
        script.click(lamp);
        script.click("Delete");
    }
    assert!(script.actions <= 15, "{}", script.actions);
    let preset = script.preset();
    let [steam] = &preset.systems[..] else { panic!("one system") };
    assert_eq!((steam.name.as_str(), steam.settings.burns()), ("steam", false));
    assert!(preset.lights.iter().all(|light| light.kind == LightKind::Directional) && sun_of(&preset.lights).is_some());
    look(&mut script, "steam");
}

#[test]
fn a_spell_takes_at_most_60_actions() {
    let mut script = Script::open("column", Vec2::new(1000.0, 900.0));
    // Two arms of wisps, and embers.
    script.click("Add system");
    script.click("Magic wisps");
    script.click("Edit smoke");
    script.click("Delete");
    script.click("Edit magic wisps");
    script.click("Duplicate");
    script.click("Add system");
    script.click("Embers");
    // Dark, so that it lights the scene alone.
    script.click("Light");
    for light in ["Key (Point 1)", "Fill (Sun 1)", "Practical (Point 1)"] {
        script.click(light);
        script.click("Delete");
    }
    script.click("Look");
    script.drag_slider("Bloom", 0.5);
    assert!(script.actions <= 60, "{}", script.actions);
    let preset = script.preset();
    assert_eq!(preset.systems.len(), 3);
    assert!(preset.systems.iter().all(|system| system.settings.burns()) && preset.lights.is_empty(), "{preset:?}");
    assert!(preset.camera.bloom > 0.1, "{}", preset.camera.bloom);
    look(&mut script, "spell");
}

/// Writes an image of the window to the folder that HAZE_LOOK names, for visual inspection.
fn look(script: &mut Script, name: &str) {
    if let Some(folder) = std::env::var_os("HAZE_LOOK") {
        screenshot(&mut script.harness).save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
    }
}
