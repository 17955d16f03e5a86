//! Edits of a sprite on its tab: shown, written and undone, superseded by changes from outside.

mod flipbook;
mod sprite_files;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, Rect, Role, Theme, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, Node};
use haze::FieldError;
use haze_author::sprite::bake::{BakedSprite, SpriteRecipe};
use haze_core::assets::sprite::Sprite;
use haze_preset::{CompressionEffort, Preset, write_png};

use super::sprite_source::recipe_of_built_in;
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window};
use haze_author::light_angles::Angles;

const LONG: Duration = Duration::from_secs(30);

/// Folder with a preset whose sprite is `mine.png`, made from a recipe beside it.
struct Folder(tempfile::TempDir);

fn small() -> SpriteRecipe {
    SpriteRecipe { size: 96, columns: 2, rows: 1, ..recipe_of_built_in("puff").unwrap() }
}

fn baked(recipe: &SpriteRecipe) -> BakedSprite {
    recipe.bake(|_| Ok::<_, FieldError>(())).unwrap()
}

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let mut preset = Preset::load("column").unwrap();
        let material = &mut preset.systems[0].material;
        material.sprite = "mine.png".into();
        material.detail = "mine.detail.png".into();
        material.columns = 2;
        folder.write_preset(&preset);
        std::fs::write(folder.path("mine.sprite.json"), small().to_json()).unwrap();
        let BakedSprite { image, detail } = baked(&small());
        write_png(&folder.path("mine.png"), &image.into(), CompressionEffort::Quick).unwrap();
        write_png(&folder.path("mine.detail.png"), &detail.into(), CompressionEffort::Quick).unwrap();
        folder
    }

    fn write_preset(&self, preset: &Preset) {
        std::fs::write(self.path("own.json"), preset.to_json("")).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn recipe(&self) -> SpriteRecipe {
        SpriteRecipe::load(&self.path("mine.sprite.json")).unwrap()
    }

    fn sprite(&self) -> Option<Sprite> {
        Sprite::load(&self.path("mine.png"), self.recipe().layout()).ok()
    }

    /// Returns true if the image equals the one that the recipe makes.
    fn is_baked(&self) -> bool {
        let recipe = self.recipe();
        let sprite = self.sprite();
        sprite == Sprite::from_image("".as_ref(), &baked(&recipe).image, recipe.layout()).ok()
    }

    fn open(&self) -> Harness<'static, Window> {
        page_of(self.path("own.json").to_str().unwrap())
    }
}

/// Opens the tab and waits until it has settled.
fn page_of(preset: &str) -> Harness<'static, Window> {
    let mut harness = window(preset, Vec2::new(1280.0, 1400.0), Theme::Dark);
    harness.state_mut().session.view.sprite.is_playing = false;
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite…").is_none());
    unfold(&mut harness);
    harness
}

/// Expands the collapsed parts of the recipe.
fn unfold(harness: &mut Harness<'_, Window>) {
    for heading in ["Wisps", "Motion", "Surface", "Sheet"] {
        // A channel of the flipbook above has the name of a heading.
        if let Some(heading) = harness.query_all_by_label(heading).last() {
            heading.click();
        }
        harness.run_steps(12);
    }
}

fn until(harness: &mut Harness<'_, Window>, is_so: impl Fn(&Harness<'_, Window>) -> bool) {
    let start = Instant::now();
    harness.run_steps(2);
    while !is_so(harness) {
        let said = harness.state().session.messages.latest().map(|message| message.text.clone());
        assert!(start.elapsed() < LONG, "never; said: {said:?}");
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
    }
    harness.run_steps(2);
}

fn slider<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
    harness.get_all_by_label(name).find(|node| node.accesskit_node().role() == Role::Slider).unwrap()
}

fn set(harness: &mut Harness<'_, Window>, name: &str, value: f64) {
    slider(harness, name).set_value_accesskit(value);
    harness.run_steps(3);
}

/// Returns the sprite that the system is drawn with.
fn used(harness: &Harness<'_, Window>) -> Sprite {
    harness.state().session.materials()[0].sprite.clone()
}

fn shown(harness: &mut Harness<'_, Window>, part: &str) -> f64 {
    let part = harness.get_by_label(part).rect();
    brightness(&screenshot(harness), part)
}

fn undo_name(harness: &Harness<'_, Window>) -> Option<String> {
    harness.state().session.document.history().undo_name().map(str::to_owned)
}

fn has_error(harness: &Harness<'_, Window>) -> bool {
    harness.state().session.messages.latest().is_some_and(|message| message.is_error)
}

#[test]
fn a_slider_shows_a_coarse_bake_then_the_full_one_which_is_written_and_undone() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = folder.recipe();
    let sprite = used(&harness);
    let brightness = [shown(&mut harness, "viewport"), shown(&mut harness, "Flipbook")];
    let rect = slider(&harness, "Erosion").rect();
    let at = |fraction: f32| rect.left_center() + Vec2::new(fraction * rect.width(), 0.0);
    harness.drag_at(at(0.25));
    for fraction in [0.3, 0.5, 0.7] {
        harness.hover_at(at(fraction));
        harness.step();
    }
    until(&mut harness, |harness| used(harness).size() == 64 && !harness.state().session.sprites.is_baking());
    for (before, part) in brightness.into_iter().zip(["viewport", "Flipbook"]) {
        let now = shown(&mut harness, part);
        assert!((now - before).abs() > 0.5, "{part}: {before} {now}");
    }
    assert_eq!(folder.recipe(), before, "nothing is written on the way");
    harness.drop_at(at(0.7));
    until(&mut harness, |harness| used(harness).size() == 96 && !harness.state().session.sprites.is_baking());
    let after = folder.recipe();
    assert!(after.erosion > before.erosion && SpriteRecipe { erosion: before.erosion, ..after.clone() } == before);
    assert!(folder.is_baked());
    assert_eq!(Some(used(&harness)), folder.sprite());
    // It is one named step, and undo also writes the files.
    assert_eq!(undo_name(&harness).as_deref(), Some("Recipe of mine.png"));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until(&mut harness, |harness| used(harness) == sprite);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    assert_eq!((folder.recipe(), undo_name(&harness)), (before, None));
    assert!(folder.is_baked());
    harness.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    until(&mut harness, |_| folder.recipe() == after);
    assert!(!harness.state().session.document.is_dirty(), "the preset is as it was");
}

#[test]
fn a_new_layout_changes_recipe_and_preset_in_one_step() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = harness.state().session.document.preset.clone();
    set(&mut harness, "Rows", 2.0);
    until(&mut harness, |_| folder.sprite().is_some_and(|sprite| sprite.frame_count() == 4));
    let material = &harness.state().session.document.preset.systems[0].material;
    assert_eq!((material.columns, material.rows), (2, 2));
    // The files that are read again match, without an error.
    until(&mut harness, |harness| harness.state().session.loaded_materials.of(&before)[0].sprite.frame_count() == 4);
    assert!(!has_error(&harness));
    assert_eq!(undo_name(&harness).as_deref(), Some("Recipe of mine.png"));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until(&mut harness, |harness| folder.recipe().rows == 1 && !harness.state().session.sprites.is_baking());
    assert_eq!(harness.state().session.document.preset, before);
    assert!(folder.is_baked());
}

#[test]
fn dependent_numbers_are_clamped_to_their_new_ranges() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "Ball radius min", 0.8);
    until(&mut harness, |_| (folder.recipe().ball_radius_min - 0.8).abs() < 1e-6);
    assert!((folder.recipe().ball_radius_max - 0.8).abs() < 1e-6);
}

#[test]
fn a_broken_recipe_is_reported_with_its_line_and_the_last_valid_one_stays() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let good = std::fs::read_to_string(folder.path("mine.sprite.json")).unwrap();
    let sprite = used(&harness);
    std::fs::write(folder.path("mine.sprite.json"), good.replace("\"erosion\": ", "\"erosion\": x")).unwrap();
    let is_said = |harness: &Harness<'_, Window>| harness.query_by_label_contains("mine.sprite.json:").is_some();
    until(&mut harness, is_said);
    assert!(harness.query_by_label_contains("mine.sprite.json:15:14: ").is_some());
    assert!(slider(&harness, "Erosion").accesskit_node().is_disabled());
    assert_eq!(used(&harness), sprite);
    std::fs::write(folder.path("mine.sprite.json"), &good).unwrap();
    until(&mut harness, |harness| !is_said(harness));
    assert!(!slider(&harness, "Erosion").accesskit_node().is_disabled());
    // A value out of range is an error too.
    std::fs::write(folder.path("mine.sprite.json"), good.replace("\"seed\"", "\"length\": 7.5, \"seed\"")).unwrap();
    until(&mut harness, is_said);
    assert!(harness.query_by_label_contains("length: 7.5 is not valid; expected 0 to 1").is_some());
}
