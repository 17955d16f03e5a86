//! A simulation on the Sprite tab: previewed, stopped, baked, edited again.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use haze_core::assets::json;
use haze_core::settings::SpriteAnimation;

use super::*;
use crate::document::copied_assets::copy_assets;
use crate::document::sprite_edits::sprite_source::SpriteOrigin;
use crate::window::Window;
use crate::window::testing::window;

/// Fire that takes some milliseconds.
const SMALL: &str = r#"{
    "version": 1,
    "grid": { "width": 16, "height": 24, "depth": 16, "detail": 1 },
    "sources": [{ "position": [0, 0.4, 0], "radius": [0.2, 0.2, 0.2], "end": 0.1, "smoke": 1, "fuel": 1 }],
    "time": { "duration": 0.4 },
    "sheet": { "size": 32, "columns": 4, "rows": 2 }
}"#;

fn small() -> SimRecipe {
    json::parse(Path::new("small.sim.json"), SMALL).unwrap()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("own.json"), Preset::load("column").unwrap().to_json("")).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Opens the Sprite tab with the built-in simulation `puff`.
    fn open(&self) -> Harness<'static, Window> {
        let preset = self.path("own.json");
        let mut harness = window(preset.to_str().unwrap(), Vec2::new(1280.0, 1400.0), Theme::Dark);
        harness.get_by_label("Sprite").click();
        until(&mut harness, |harness| harness.query_by_label("Make my own…").is_some());
        choose(&mut harness, "Simulate", "Puff");
        harness
    }
}

fn choose(harness: &mut Harness<'_, Window>, menu: &str, item: &str) {
    harness.get_by_label(menu).scroll_to_me();
    harness.run_steps(20);
    harness.get_by_label(menu).click();
    harness.run_steps(3);
    harness.get_by_label(item).click();
    harness.run_steps(2);
}

fn until(harness: &mut Harness<'_, Window>, is_so: impl Fn(&Harness<'_, Window>) -> bool) {
    let start = Instant::now();
    harness.run_steps(2);
    while !is_so(harness) {
        let said = harness.state().session.messages.latest().map(|message| message.text.clone());
        assert!(start.elapsed() < Duration::from_secs(60), "never; said: {said:?}");
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
    }
    harness.run_steps(2);
}

fn edit(harness: &mut Harness<'_, Window>, change: impl Fn(&mut SimRecipe)) {
    let simulation = &mut harness.state_mut().session.simulation;
    change(&mut simulation.of_system(0).unwrap().recipe);
    harness.run_steps(2);
}

fn sprite(harness: &Harness<'_, Window>) -> Sprite {
    harness.state().session.materials()[0].sprite.clone()
}

fn system(harness: &Harness<'_, Window>) -> PresetSystem {
    harness.state().session.document.preset.systems[0].clone()
}

#[test]
fn a_simulation_is_previewed_baked_and_edited_again() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = sprite(&harness);
    let before_preset = harness.state().session.document.preset.clone();
    edit(&mut harness, |recipe| *recipe = small());
    until(&mut harness, |harness| sprite(harness).frame_count() == 2);
    let first = sprite(&harness);
    assert_eq!(first.size(), 32);
    assert!(!folder.path("puff_mine.png").exists(), "a preview writes nothing");
    // Another number is another preview.
    edit(&mut harness, |recipe| recipe.physics.buoyancy = 20.0);
    until(&mut harness, |harness| sprite(harness) != first);
    // One that is not valid is said by its field, and the last preview stays.
    let last = sprite(&harness);
    edit(&mut harness, |recipe| recipe.grid.height = 22);
    until(&mut harness, |harness| harness.state().session.messages.latest().is_some_and(|message| message.is_error));
    let said = harness.state().session.messages.latest().unwrap().text.clone();
    assert!(said.contains("grid.height"), "{said}");
    assert!(sprite(&harness) == last);
    edit(&mut harness, |recipe| recipe.grid.height = 24);
    harness.get_by_label("Bake").click();
    until(&mut harness, |harness| system(harness).material.sprite == "puff_mine.png");
    let now = system(&harness);
    assert_eq!((now.material.detail.as_str(), now.material.columns, now.material.rows), ("puff_mine.detail.png", 4, 2));
    assert_eq!(now.settings.sprite.animation, SpriteAnimation::Volume);
    until(&mut harness, |harness| sprite(harness).frame_count() == 8);
    for name in ["puff_mine.detail.png", "puff_mine.heat.png"] {
        assert!(is_baked_png(&folder.path(name)), "{name}");
    }
    let written = SimRecipe::load(&folder.path("puff_mine.sim.json")).unwrap();
    assert!((written.physics.buoyancy - 20.0).abs() < 1e-6);
    // The same images are baked again.
    until(&mut harness, |harness| harness.query_by_label("Edit simulation").is_some());
    harness.get_by_label("Edit simulation").click();
    harness.run_steps(3);
    edit(&mut harness, |recipe| recipe.sheet.rows = 1);
    let full = sprite(&harness);
    harness.get_by_label("Bake").click();
    until(&mut harness, |harness| sprite(harness).frame_count() == 4);
    assert!(sprite(&harness) != full && !folder.path("puff_mine_mine.png").exists());
    // Undo goes back to the sprite before.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until(&mut harness, |harness| harness.state().session.document.preset == before_preset);
    assert!(sprite(&harness) == before);
}

#[test]
fn a_simulation_goes_with_its_preset_and_changes_of_its_file_are_seen() {
    let folder = Folder::new();
    let mut harness = folder.open();
    edit(&mut harness, |recipe| *recipe = small());
    harness.get_by_label("Bake").click();
    until(&mut harness, |harness| harness.query_by_label("Edit simulation").is_some());
    let other = tempfile::tempdir().unwrap();
    let preset = &harness.state().session.document.preset;
    copy_assets(preset, folder.0.path(), other.path()).unwrap();
    assert_eq!(SimRecipe::load(&other.path().join("puff_mine.sim.json")).unwrap(), small());
    let mut changed = small();
    changed.physics.buoyancy = 7.0;
    std::fs::write(folder.path("puff_mine.sim.json"), changed.to_json()).unwrap();
    until(&mut harness, |harness| {
        let known = harness.state().session.sprites.known("puff_mine.png");
        known.is_some_and(|known| known.source == SpriteOrigin::Simulated(Box::new(changed.clone())))
    });
}

#[test]
fn closing_or_stopping_a_simulation_leaves_the_sprite_as_it_was() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = sprite(&harness);
    edit(&mut harness, |recipe| *recipe = small());
    until(&mut harness, |harness| sprite(harness).frame_count() == 2);
    edit(&mut harness, |recipe| recipe.sheet.columns = 16);
    assert!(harness.query_by_label("Simulation: puff").is_some());
    harness.get_by_label("Bake").click();
    until(&mut harness, |harness| harness.query_by_label("Stop").is_some());
    harness.get_by_label("Stop").click();
    until(&mut harness, |harness| harness.query_by_label("Close").is_some());
    harness.get_by_label("Close").click();
    harness.run_steps(3);
    assert!(sprite(&harness) == before && harness.query_by_label("Simulation: puff").is_none());
    assert_eq!(std::fs::read_dir(folder.0.path()).unwrap().count(), 1);
}

#[test]
fn a_simulation_stays_with_its_system() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let session = &mut harness.state_mut().session;
    session.add_layer(haze_preset::layers::find_layer("LAYER", "steam").unwrap());
    session.move_system(0, 1);
    assert!(session.simulation.of_system(0).is_none() && session.simulation.of_system(1).is_some());
    session.remove_system(0);
    assert!(session.simulation.of_system(0).is_some());
    session.duplicate_system(0);
    assert!(session.simulation.of_system(0).is_some());
    session.remove_system(0);
    assert!((0..2).all(|system| session.simulation.of_system(system).is_none()));
}

#[test]
fn six_way_light_is_turned_off_by_the_bake() {
    let folder = Folder::new();
    let mut harness = folder.open();
    harness.state_mut().session.document.preset.systems[0].settings.lighting = Lighting::SixWay;
    edit(&mut harness, |recipe| *recipe = small());
    until(&mut harness, |harness| harness.query_by_label_contains("No preview with six-way light").is_some());
    harness.get_by_label("Bake").click();
    until(&mut harness, |harness| system(harness).material.sprite == "puff_mine.png");
    assert!(!system(&harness).settings.is_six_way());
}

#[test]
fn a_source_is_added_and_removed() {
    let folder = Folder::new();
    let mut harness = folder.open();
    edit(&mut harness, |recipe| *recipe = small());
    let count = |harness: &mut Harness<'_, Window>| {
        harness.run_steps(2);
        harness.state_mut().session.simulation.of_system(0).unwrap().recipe.sources.len()
    };
    assert!(harness.query_by_label("Remove source").is_none());
    harness.get_by_label("Add source").click();
    assert_eq!(count(&mut harness), 2);
    harness.get_by_label("Remove source").click();
    assert_eq!(count(&mut harness), 1);
}

/// Writes images of the tab to the folder that HAZE_LOOK names.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_a_simulation() {
    let Some(look) = std::env::var_os("HAZE_LOOK") else { return };
    let folder = Folder::new();
    for size in [Vec2::new(1280.0, 800.0), Vec2::new(640.0, 400.0)] {
        let preset = folder.path("own.json");
        let mut harness = window(preset.to_str().unwrap(), size, Theme::Dark);
        harness.get_by_label("Sprite").click();
        until(&mut harness, |harness| harness.query_by_label("Make my own…").is_some());
        choose(&mut harness, "Simulate", "Mushroom");
        until(&mut harness, |harness| sprite(harness).frame_count() == 16);
        harness.state_mut().session.view.sprite.frame = 9.0;
        harness.run_steps(4);
        let image = crate::window::testing::screenshot(&mut harness);
        image.save(Path::new(&look).join(format!("simulation_{}.png", size.x))).unwrap();
    }
}
