//! Edits of a sprite on its tab: shown, written and undone, superseded by changes from outside.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Key, Modifiers, Rect, Role, Theme, Vec2, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, Node};
use haze::FieldError;
use haze::image::{CompressionEffort, write_png};
use haze::preset::Preset;
use haze::sprite::Sprite;
use haze_author::sprite::bake::{BakedSprite, SpriteRecipe};

use super::sprite_bake_job::{SpriteBakeJob, What};
use super::sprite_source::{recipe_of_built_in, stamps};
use crate::tweak::document::light_angles::Angles;
use crate::tweak::window::testing::{brightness, picture, window};
use crate::tweak::window::{Window, testing};

const LONG: Duration = Duration::from_secs(30);

/// Folder with a preset whose sprite is `mine.png`, made from a recipe beside it.
struct Folder(tempfile::TempDir);

fn small() -> SpriteRecipe {
    SpriteRecipe { version: 2, size: 96, columns: 2, rows: 1, ..recipe_of_built_in("puff").unwrap() }
}

fn baked(recipe: &SpriteRecipe) -> BakedSprite {
    recipe.bake(|_| Ok::<_, FieldError>(())).unwrap()
}

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let mut preset = Preset::load("column").unwrap();
        let material = &mut preset.systems[0].material;
        (material.sprite, material.detail) = ("mine.png".into(), "mine.detail.png".into());
        material.columns = 2;
        folder.write_preset(&preset);
        std::fs::write(folder.path("mine.sprite.json"), small().to_text()).unwrap();
        let BakedSprite { picture, detail } = baked(&small());
        write_png(&folder.path("mine.png"), &picture.into(), CompressionEffort::Quick).unwrap();
        write_png(&folder.path("mine.detail.png"), &detail.into(), CompressionEffort::Quick).unwrap();
        folder
    }

    fn write_preset(&self, preset: &Preset) {
        std::fs::write(self.path("own.json"), preset.to_text("")).unwrap();
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
        let (recipe, sprite) = (self.recipe(), self.sprite());
        sprite == Sprite::from_image("".as_ref(), &baked(&recipe).picture, recipe.layout()).ok()
    }

    fn open(&self) -> Harness<'static, Window> {
        page_of(self.path("own.json").to_str().unwrap())
    }
}

/// Opens the tab and waits until it has settled.
fn page_of(preset: &str) -> Harness<'static, Window> {
    let mut harness = window(preset, Vec2::new(1280.0, 1400.0), Theme::Dark);
    harness.state_mut().session.show.sprite.is_playing = false;
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite.").is_none());
    unfold(&mut harness);
    harness
}

/// Expands the collapsed parts of the recipe.
fn unfold(harness: &mut Harness<'_, Window>) {
    for heading in ["wisps", "motion", "surface", "sheet"] {
        if let Some(heading) = harness.query_by_label(heading) {
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
    brightness(&picture(harness), part)
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
    let (before, sprite) = (folder.recipe(), used(&harness));
    let brightness = [shown(&mut harness, "viewport"), shown(&mut harness, "flipbook")];
    let rect = slider(&harness, "erosion").rect();
    let at = |share: f32| rect.left_center() + Vec2::new(share * rect.width(), 0.0);
    harness.drag_at(at(0.25));
    for share in [0.3, 0.5, 0.7] {
        harness.hover_at(at(share));
        harness.step();
    }
    until(&mut harness, |harness| used(harness).size() == 64 && !harness.state().session.sprites.is_baking());
    for (before, part) in brightness.into_iter().zip(["viewport", "flipbook"]) {
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
    assert_eq!(undo_name(&harness).as_deref(), Some("recipe of mine.png"));
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
    set(&mut harness, "rows", 2.0);
    until(&mut harness, |_| folder.sprite().is_some_and(|sprite| sprite.frame_count() == 4));
    let material = &harness.state().session.document.preset.systems[0].material;
    assert_eq!((material.columns, material.rows), (2, 2));
    // The files that are read again match, without an error.
    until(&mut harness, |harness| harness.state().session.pictures.of(&before)[0].sprite.frame_count() == 4);
    assert!(!has_error(&harness));
    assert_eq!(undo_name(&harness).as_deref(), Some("recipe of mine.png"));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    until(&mut harness, |harness| folder.recipe().rows == 1 && !harness.state().session.sprites.is_baking());
    assert_eq!(harness.state().session.document.preset, before);
    assert!(folder.is_baked());
}

#[test]
fn dependent_numbers_are_clamped_to_their_new_ranges() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "ball radius min", 0.8);
    until(&mut harness, |_| (folder.recipe().ball_radius_min - 0.8).abs() < 1e-6);
    assert!((folder.recipe().ball_radius_max - 0.8).abs() < 1e-6);
    set(&mut harness, "version", 1.0);
    assert!(slider(&harness, "travel").accesskit_node().is_disabled());
    harness.get_by_label("Convert to version 2").click();
    harness.run_steps(3);
    assert!(!slider(&harness, "travel").accesskit_node().is_disabled());
}

#[test]
fn a_broken_recipe_is_reported_with_its_line_and_the_last_valid_one_stays() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let (good, sprite) = (std::fs::read_to_string(folder.path("mine.sprite.json")).unwrap(), used(&harness));
    std::fs::write(folder.path("mine.sprite.json"), good.replace("\"erosion\": ", "\"erosion\": x")).unwrap();
    let is_said = |harness: &Harness<'_, Window>| harness.query_by_label_contains("mine.sprite.json:").is_some();
    until(&mut harness, is_said);
    assert!(harness.query_by_label_contains("mine.sprite.json:15:14: ").is_some());
    assert!(slider(&harness, "erosion").accesskit_node().is_disabled());
    assert_eq!(used(&harness), sprite);
    std::fs::write(folder.path("mine.sprite.json"), &good).unwrap();
    until(&mut harness, |harness| !is_said(harness));
    assert!(!slider(&harness, "erosion").accesskit_node().is_disabled());
    // A value out of range is an error too.
    std::fs::write(folder.path("mine.sprite.json"), good.replace("\"seed\"", "\"length\": 7.5, \"seed\"")).unwrap();
    until(&mut harness, is_said);
    assert!(harness.query_by_label_contains("length: 7.5 is not valid; expected 0 to 1").is_some());
}

#[test]
fn files_changed_by_another_program_are_not_overwritten_until_requested() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "bump", 3.0);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    let other = SpriteRecipe { seed: 77, ..small() };
    write_png(&folder.path("mine.png"), &baked(&other).picture.into(), CompressionEffort::Quick).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake the recipe").is_some());
    until(&mut harness, |harness| Some(used(harness)) == folder.sprite());
    assert!(harness.query_by_label("erosion").is_none() && (folder.recipe().bump - 3.0).abs() < 1e-6);
    // A recipe that is written by hand is another recipe as well.
    std::fs::write(folder.path("mine.sprite.json"), other.to_text()).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake the recipe").is_none());
    std::fs::write(folder.path("mine.sprite.json"), small().to_text()).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake the recipe").is_some());
    harness.get_by_label("Bake the recipe").click();
    until(&mut harness, |_| folder.is_baked());
    assert_eq!(folder.recipe(), small());
}

#[test]
fn a_built_in_sprite_is_copied_beside_the_preset() {
    let folder = Folder::new();
    folder.write_preset(&Preset::load("column").unwrap());
    let mut harness = folder.open();
    let (name, sprite) = ("puff", used(&harness));
    assert!(slider(&harness, "erosion").accesskit_node().is_disabled());
    harness.get_by_label("Make my own").click();
    harness.run_steps(4);
    let file = format!("{name}_mine.png");
    assert_eq!(harness.state().session.document.preset.systems[0].material.sprite, file);
    assert!(folder.path("puff_mine.detail.png").is_file());
    assert_eq!(SpriteRecipe::load(&folder.path("puff_mine.sprite.json")).unwrap(), recipe_of_built_in(name).unwrap());
    until(&mut harness, |harness| {
        let session = &harness.state().session;
        session.pictures.of(&session.document.preset)[0].detail.is_some()
    });
    assert_eq!(used(&harness), sprite, "it looks as it did");
    assert!(!slider(&harness, "erosion").accesskit_node().is_disabled());
    assert!(harness.query_by_label("Version 1 is slow to bake.").is_some() && !has_error(&harness));
}

#[test]
fn a_sprite_without_a_recipe_shows_that_and_the_findings_of_its_check() {
    let folder = Folder::new();
    std::fs::remove_file(folder.path("mine.sprite.json")).unwrap();
    let colours = image::RgbaImage::from_fn(192, 96, |x, y| {
        let is_border = x % 96 % 95 == 0 || y % 95 == 0;
        image::Rgba([200, 120, 20, if is_border { 0 } else { 255 }])
    });
    write_png(&folder.path("mine.png"), &colours.into(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    assert!(harness.query_by_label_contains("There is no recipe: mine.sprite.json").is_some());
    assert!(harness.query_by_label_contains("normals: colours, not normals").is_some());
    harness.get_by_label("New from template").click();
    harness.run_steps(3);
    harness.get_by_label("ball").click();
    harness.run_steps(4);
    let material = &harness.state().session.document.preset.systems[0].material;
    assert_eq!((material.sprite.as_str(), material.columns, material.rows), ("ball_mine.png", 2, 2));
    assert!(harness.query_by_label_contains("normals: ").is_none());
    unfold(&mut harness);
    assert!(!slider(&harness, "erosion").accesskit_node().is_disabled());
}

#[test]
fn the_light_follows_its_controls_and_a_drag() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let mut halves = |azimuth| {
        harness.state_mut().session.show.sprite.light = Angles { azimuth, elevation: 0.0 };
        let rect = harness.get_by_label("flipbook").rect();
        let picture = picture(&mut harness);
        let middle = rect.center().x;
        [rect.with_max_x(middle), rect.with_min_x(middle)].map(|half: Rect| brightness(&picture, half))
    };
    let [left, right] = halves(-90.0);
    assert!(left > right + 5.0, "{left} {right}");
    let [left, right] = halves(90.0);
    assert!(right > left + 5.0, "{left} {right}");
    // A drag to the left and up moves it along.
    let middle = harness.get_by_label("flipbook").rect().center();
    let to = middle - Vec2::new(100.0, 50.0);
    harness.drag_at(middle);
    harness.hover_at(to);
    harness.step();
    harness.drop_at(to);
    harness.run_steps(2);
    let light = harness.state().session.show.sprite.light;
    assert!(light.azimuth < 60.0 && light.elevation > 10.0, "{light:?}");
}

#[test]
fn the_recipe_can_be_scrolled_to_in_the_smallest_window() {
    let mut harness = window("column", Vec2::new(640.0, 400.0), Theme::Dark);
    harness.state_mut().session.show.sprite.is_playing = false;
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite.").is_none());
    slider(&harness, "upright").scroll_to_me();
    harness.run_steps(8);
    let (row, page) = (slider(&harness, "upright").rect(), harness.get_by_label("viewport").rect());
    assert!(row.top() > page.top() && row.bottom() < page.bottom(), "{row} beside {page}");
}

#[test]
fn a_new_window_shows_the_flipbook_and_continues_the_bake() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = shown(&mut harness, "flipbook");
    let memory = harness.ctx.memory(Clone::clone);
    set(&mut harness, "columns", 8.0);
    assert!(harness.state().session.sprites.is_baking());
    let start = harness.into_state().into_start();
    let mut harness = testing::open(start, Vec2::new(1280.0, 1400.0), Theme::Dark);
    harness.ctx.memory_mut(|new| *new = memory);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    assert!(folder.recipe().columns == 8 && folder.is_baked());
    let after = shown(&mut harness, "flipbook");
    assert!((after - before).abs() < 2.0, "{before} {after}");
}

#[test]
fn the_sprite_tab_is_as_wide_as_the_others() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let width = |harness: &Harness<'_, Window>| harness.state().layout().settings.unwrap();
    harness.run_steps(10);
    let page = width(&harness);
    harness.get_by_label("Light").click();
    harness.run_steps(10);
    assert!((page - width(&harness)).abs() < 0.5 && page < 371.0, "{page}");
}

#[test]
fn the_flipbook_repaints_only_while_it_is_visible_and_playing() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let is_still = |harness: &mut Harness<'_, Window>| {
        harness.run_steps(6);
        harness.output().viewport_output.values().all(|viewport| viewport.repaint_delay > Duration::from_secs(1))
    };
    assert!(is_still(&mut harness));
    let before = picture(&mut harness);
    harness.get_by_label("Play the flipbook").click();
    assert!(!is_still(&mut harness));
    assert_ne!(picture(&mut harness), before);
    let frame = harness.state().session.show.sprite.frame;
    assert!(frame > 0.0);
    harness.get_by_label("Look").click();
    assert!(is_still(&mut harness));
    let frame = harness.state().session.show.sprite.frame;
    harness.run_steps(3);
    assert!((harness.state().session.show.sprite.frame - frame).abs() < 1e-6);
    harness.state_mut().session.show.sprite.is_playing = false;
    harness.state_mut().session.show.sprite.is_turning = true;
    harness.get_by_label("Sprite").click();
    assert!(!is_still(&mut harness));
}

#[test]
fn an_outdated_bake_is_cancelled_and_not_written() {
    let folder = Folder::new();
    let picture = folder.path("mine.png");
    let before = stamps(&picture);
    let mut bakery = SpriteBakeJob::new(|| ()).unwrap();
    let long = SpriteRecipe { size: 128, columns: 16, rows: 16, ..small() };
    let order = bakery.whole(long, picture.clone(), before);
    let start = Instant::now();
    while order.frames() < 2 {
        assert!(start.elapsed() < LONG);
    }
    order.stop();
    let wait = |bakery: &SpriteBakeJob| loop {
        assert!(start.elapsed() < LONG);
        if let Some(done) = bakery.poll() {
            return done.unwrap();
        }
    };
    let done = wait(&bakery);
    assert!(done.job == order.job && matches!(done.what, What::GivenUp) && order.frames() < 100);
    // Files that another program has changed are not overwritten either.
    std::fs::write(folder.path("mine.sprite.json"), "{}").unwrap();
    bakery.whole(small(), picture.clone(), before);
    assert!(matches!(wait(&bakery).what, What::GivenUp));
    assert_eq!(std::fs::read_to_string(folder.path("mine.sprite.json")).unwrap(), "{}");
    assert_eq!(stamps(&picture)[..2], before[..2]);
}

#[test]
fn closing_the_window_waits_for_the_bake_to_be_written() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "columns", 8.0);
    assert!(harness.state().session.sprites.is_baking());
    let close = |harness: &mut Harness<'_, Window>| {
        let viewport = harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
        viewport.events.push(ViewportEvent::Close);
        harness.step();
    };
    let asked = |harness: &Harness<'_, Window>, command: &ViewportCommand| {
        let output = &harness.output().viewport_output;
        output.values().any(|viewport| viewport.commands.contains(command))
    };
    close(&mut harness);
    assert!(asked(&harness, &ViewportCommand::CancelClose));
    let start = Instant::now();
    while !asked(&harness, &ViewportCommand::Close) {
        assert!(start.elapsed() < LONG);
        harness.step();
    }
    assert!(folder.is_baked());
}

#[test]
fn a_built_in_preset_must_be_saved_before_a_sprite_is_copied() {
    let mut harness = page_of("column");
    harness.get_by_label("Make my own").click();
    harness.run_steps(4);
    let folder = tempfile::tempdir().unwrap();
    let Window { filing, session, .. } = harness.state_mut();
    filing.finish_typing(Some(&folder.path().join("mine.json")), session);
    until(&mut harness, |_| folder.path().join("puff_mine.png").is_file());
    assert_eq!(harness.state().session.document.preset.systems[0].material.sprite, "puff_mine.png");
}

#[test]
fn a_write_error_is_reported() {
    let folder = Folder::new();
    std::fs::remove_file(folder.path("mine.detail.png")).unwrap();
    std::fs::create_dir(folder.path("mine.detail.png")).unwrap();
    let mut preset = Preset::load(folder.path("own.json")).unwrap();
    preset.systems[0].material.detail.clear();
    folder.write_preset(&preset);
    let mut harness = folder.open();
    set(&mut harness, "bump", 3.0);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    let said = harness.state().session.messages.latest().map(|message| message.text.clone());
    assert!(has_error(&harness) && said.as_ref().is_some_and(|said| said.contains("mine.detail.png")), "{said:?}");
    std::fs::remove_dir(folder.path("mine.detail.png")).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake the recipe").is_some());
    harness.get_by_label("Bake the recipe").click();
    until(&mut harness, |_| folder.is_baked() && folder.path("mine.detail.png").is_file());
}

/// `HAZE_LOOK=DIR` names the folder to write to.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_the_sprite_tab() {
    let into = PathBuf::from(std::env::var_os("HAZE_LOOK").unwrap());
    let folder = Folder::new();
    let mut harness = window(folder.path("own.json").to_str().unwrap(), Vec2::new(1280.0, 800.0), Theme::Dark);
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite.").is_none());
    for theme in [Theme::Dark, Theme::Light] {
        harness.ctx.set_theme(theme);
        harness.run_steps(3);
        picture(&mut harness).save(into.join(format!("sprite_own_{theme:?}.png"))).unwrap();
    }
    for (index, (_, name, _)) in crate::tweak::session::sprite_view::SHOWN.iter().enumerate() {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        picture(&mut harness).save(into.join(format!("sprite_shown_{index}.png"))).unwrap();
    }
}
