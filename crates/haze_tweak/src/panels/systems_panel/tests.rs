//! Tests of the list of systems, through the window.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::{Event, Key, Modifiers, Rect, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze_preset::{MAX_SYSTEMS, Preset};

use crate::document::keyframes::add_key;
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window};

/// Opens a window that is small, so that its images are drawn fast.
fn open(preset: &str) -> Harness<'static, Window> {
    window(preset, Vec2::new(640.0, 400.0), Theme::Dark)
}

fn click(harness: &mut Harness<'_, Window>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(4);
}

/// Adds a layer of the shelf.
fn add(harness: &mut Harness<'_, Window>, layer: &str) {
    click(harness, "Add system");
    click(harness, layer);
}

/// Runs an entry of a system's menu.
fn run(harness: &mut Harness<'_, Window>, system: &str, entry: &str) {
    click(harness, &format!("Edit {system}"));
    click(harness, entry);
}

fn key(harness: &mut Harness<'_, Window>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(4);
}

fn type_name(harness: &mut Harness<'_, Window>, name: &str, end: Key) {
    key(harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(name.into()));
    harness.run_steps(3);
    key(harness, Modifiers::NONE, end);
}

fn preset<'h>(harness: &'h Harness<'_, Window>) -> &'h Preset {
    &harness.state().session.document.preset
}

fn names(harness: &Harness<'_, Window>) -> Vec<String> {
    preset(harness).systems.iter().map(|system| system.name.clone()).collect()
}

fn tracks(harness: &Harness<'_, Window>) -> Vec<String> {
    preset(harness).animation.iter().map(|track| track.setting.clone()).collect()
}

fn selected(harness: &Harness<'_, Window>) -> usize {
    harness.state().session.view.system
}

/// Brightness of the image.
fn shown(harness: &mut Harness<'_, Window>) -> f64 {
    let part = harness.get_by_label("viewport").rect();
    brightness(&screenshot(harness), part)
}

/// An edit; the names, tracks and selection after it, and the name of its step.
type Case = (fn(&mut Harness<'_, Window>), &'static [&'static str], &'static [usize], usize, &'static str);

#[test]
fn every_edit_is_one_step_and_keyframes_follow() {
    let mut harness = open("campfire");
    add_key(&mut harness.state_mut().session.document.preset, "systems[1].settings.boost", 1.0);
    harness.run_steps(3);
    click(&mut harness, "System sparks");
    let before = preset(&harness).clone();
    let rename = |harness: &mut Harness<'_, Window>| {
        run(harness, "sparks", "Rename");
        type_name(harness, "glints", Key::Enter);
    };
    let cases: [Case; 6] = [
        (|harness| add(harness, "Steam"), &["fire", "sparks", "steam"], &[1], 2, "System added"),
        (|harness| add(harness, "Sparks"), &["fire", "sparks", "sparks 2"], &[1], 2, "System added"),
        (rename, &["fire", "glints"], &[1], 1, "Name of glints"),
        (|harness| run(harness, "fire", "Duplicate"), &["fire", "fire 2", "sparks"], &[2], 1, "System added"),
        (|harness| run(harness, "sparks", "Move Up"), &["sparks", "fire"], &[0], 0, "System moved"),
        (|harness| run(harness, "sparks", "Delete"), &["fire"], &[], 0, "System removed"),
    ];
    for (edit, expected, positions, index, step) in cases {
        edit(&mut harness);
        let after = preset(&harness).clone();
        after.validate().unwrap();
        assert_eq!(names(&harness), expected, "{step}");
        let settings: Vec<_> = positions.iter().map(|position| format!("systems[{position}].settings.boost")).collect();
        assert_eq!((tracks(&harness), selected(&harness)), (settings, index), "{step}");
        assert_eq!(harness.state().session.document.history().undo_name(), Some(step));
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        assert!(*preset(&harness) == before, "{step}");
        key(&mut harness, Modifiers::COMMAND, Key::Y);
        assert!(*preset(&harness) == after, "{step}");
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        click(&mut harness, "System sparks");
    }
    // Keyframes are copied too.
    run(&mut harness, "sparks", "Duplicate");
    assert_eq!(tracks(&harness), ["systems[1].settings.boost", "systems[2].settings.boost"]);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    // Escape leaves the name.
    run(&mut harness, "sparks", "Rename");
    type_name(&mut harness, "glints", Key::Escape);
    assert!(*preset(&harness) == before && harness.state().session.view.systems.renaming.is_none());
}

#[test]
fn mute_and_solo_change_the_image_and_nothing_else() {
    let mut harness = open("campfire");
    let before = preset(&harness).clone();
    let all = shown(&mut harness);
    click(&mut harness, "Mute: hide this system: fire");
    let sparks = shown(&mut harness);
    assert!(sparks < 0.7 * all, "{sparks} {all}");
    click(&mut harness, "Mute: hide this system: sparks");
    let none = shown(&mut harness);
    assert!(none < sparks, "{none} {sparks}");
    click(&mut harness, "Solo: show only this system: sparks");
    assert!((shown(&mut harness) - sparks).abs() < 0.05);
    let session = &harness.state().session;
    assert!(*preset(&harness) == before && !session.document.is_dirty());
    // Exports draw all systems.
    let exported = session.animated_shot(glam::UVec2::new(64, 36)).preset;
    assert_eq!(exported.systems, before.systems);
    click(&mut harness, "Solo: show only this system: sparks");
    click(&mut harness, "Mute: hide this system: sparks");
    click(&mut harness, "Mute: hide this system: fire");
    assert!((shown(&mut harness) - all).abs() < 0.05);
}

#[test]
fn the_last_system_can_be_deleted_and_the_first_added() {
    let mut harness = open("column");
    run(&mut harness, "smoke", "Delete");
    assert!(names(&harness).is_empty() && harness.query_by_label("No systems").is_some());
    let empty = shown(&mut harness);
    for tab in ["Smoke", "Ramps", "Sprite", "Advanced", "Cost", "Look"] {
        click(&mut harness, tab);
    }
    add(&mut harness, "Flame");
    assert_eq!((names(&harness), selected(&harness)), (vec!["flame".to_owned()], 0));
    let start = Instant::now();
    // Its images are loaded by another thread.
    while shown(&mut harness) < empty + 0.2 {
        assert!(start.elapsed() < Duration::from_secs(30), "no flame");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_file_saved_after_adding_opens_again_equal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.json");
    std::fs::write(&path, Preset::load("campfire").unwrap().to_json("")).unwrap();
    let mut harness = open(path.to_str().unwrap());
    add(&mut harness, "Magic wisps");
    add(&mut harness, "Ground dust");
    key(&mut harness, Modifiers::COMMAND, Key::S);
    let start = Instant::now();
    while harness.state().session.document.is_dirty() {
        assert!(start.elapsed() < Duration::from_secs(30), "not saved");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
    assert!(Preset::load(&path).unwrap() == *preset(&harness));
    let again = open(path.to_str().unwrap());
    assert_eq!(names(&again), ["fire", "sparks", "magic wisps", "ground dust"]);
    // On the ground below the fire.
    let [fire, .., dust] = &preset(&again).systems[..] else { panic!("four systems") };
    assert!(fire.emitter.position.y > 0.4 && dust.emitter.position.y < 0.1);
}

#[test]
fn the_list_fits_and_scrolls_in_small_and_large_windows() {
    for size in [Vec2::new(640.0, 400.0), Vec2::new(1280.0, 800.0)] {
        let mut harness = window("campfire", size, Theme::Dark);
        let room = Rect::from_min_size(Default::default(), size);
        let fits = |harness: &Harness<'_, Window>, name: &str| {
            let rect = harness.get_by_label(name).rect();
            let image = harness.get_by_label("viewport").rect();
            assert!(room.contains_rect(rect) && rect.left() >= image.right(), "{name}: {rect} in {size}");
        };
        for tab in ["Look", "Smoke", "Ramps", "Sprite", "Advanced"] {
            click(&mut harness, tab);
            for name in ["System fire", "Solo: show only this system: fire", "Mute: hide this system: fire"] {
                fits(&harness, name);
            }
            ["System sparks", "Edit sparks", "Edit fire", "Add system"].iter().for_each(|name| fits(&harness, name));
        }
        // The whole shelf is in the window.
        click(&mut harness, "Add system");
        for layer in haze_preset::layers::layers() {
            // A tab is named like the first layer.
            let rect = harness.get_all_by_label(&layer.title).last().unwrap().rect();
            assert!(room.contains_rect(rect), "{} in {size}", layer.title);
        }
        key(&mut harness, Modifiers::NONE, Key::Escape);
        for _ in 2..MAX_SYSTEMS {
            run(&mut harness, "sparks", "Duplicate");
            click(&mut harness, "System sparks");
        }
        assert_eq!(preset(&harness).systems.len(), MAX_SYSTEMS);
        harness.run_steps(20);
        fits(&harness, "Add system");
        assert!(harness.get_by_label("Add system").accesskit_node().is_disabled());
        // The list takes no more than its fraction.
        let slider = harness.get_all_by_label("Technique").next().map(|node| node.rect());
        assert!(slider.is_some_and(|rect| rect.top() < 0.6 * size.y), "{slider:?}");
    }
}

/// Writes images of the list and of the shelf to the folder that HAZE_LOOK names.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_the_list() {
    let Some(folder) = std::env::var_os("HAZE_LOOK") else { return };
    for (size, theme) in [(Vec2::new(640.0, 400.0), Theme::Dark), (Vec2::new(1280.0, 800.0), Theme::Light)] {
        let mut harness = window("campfire", size, theme);
        let save = |harness: &mut Harness<'_, Window>, name: &str| {
            for _ in 0..20 {
                std::thread::sleep(Duration::from_millis(50));
                harness.step();
            }
            screenshot(harness).save(Path::new(&folder).join(format!("{name}_{}.png", size.x))).unwrap();
        };
        save(&mut harness, "list");
        click(&mut harness, "Add system");
        save(&mut harness, "shelf");
        click(&mut harness, "Magic wisps");
        click(&mut harness, "Mute: hide this system: sparks");
        add_key(&mut harness.state_mut().session.document.preset, "systems[1].settings.boost", 1.0);
        save(&mut harness, "added");
        click(&mut harness, "Edit magic wisps");
        save(&mut harness, "menu");
        click(&mut harness, "Rename");
        save(&mut harness, "rename");
        key(&mut harness, Modifiers::NONE, Key::Escape);
        click(&mut harness, "Solo: show only this system: magic wisps");
        for layer in ["Smoke", "Steam", "Embers", "Shock ring"] {
            click(&mut harness, "Add system");
            harness.get_all_by_label(layer).last().unwrap().click();
            harness.run_steps(4);
        }
        save(&mut harness, "many");
    }
}
