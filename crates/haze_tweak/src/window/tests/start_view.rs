//! Start with presets to choose from.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::{AreaState, Event, Id, Key, Modifiers, PointerButton, Pos2, Rect, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use haze_preset::{Preset, builtin};

use crate::files::thumbnail_cache::{SIZE, ThumbnailCache};
use crate::session::Session;
use crate::window::testing::{click_at, open, screenshot, start_of};
use crate::window::{Start, Window};

/// Opens a window that plays behind the start view, as a program without arguments does.
fn started(size: Vec2, theme: Theme, cache: Option<PathBuf>) -> Harness<'static, Window> {
    let mut session = Session::open(Path::new("column"), None).unwrap();
    session.playback.is_playing = true;
    let cache = ThumbnailCache { folder: cache };
    open(Start { cache, has_start_view: true, ..start_of(session) }, size, theme)
}

/// Waits until a condition holds.
fn wait_until(harness: &mut Harness<'_, Window>, what: &str, mut is_so: impl FnMut(&Window) -> bool) {
    let start = Instant::now();
    while !is_so(harness.state()) {
        assert!(start.elapsed() < Duration::from_secs(120), "never: {what}");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
}

fn is_open(harness: &Harness<'_, Window>, preset: &str) -> bool {
    harness.state().session.document.path() == Path::new(preset)
}

fn rendered(window: &Window) -> usize {
    window.thumbnails.entries.iter().filter(|entry| entry.image.is_some()).count()
}

#[test]
fn a_preset_is_chosen_at_the_start_by_one_click_and_plays() {
    let mut harness = started(Vec2::new(1000.0, 640.0), Theme::Dark, None);
    harness.get_by_label("Backlit fog").click();
    harness.run_steps(3);
    wait_until(&mut harness, "the fog", |window| window.session.document.path() == Path::new("backlit_fog"));
    let before = harness.state().session.playback.time;
    harness.run_steps(3);
    assert!(harness.query_by_label("Dust storm").is_none());
    assert!(harness.state().session.playback.time > before);
    // Space pauses.
    harness.key_press(Key::Space);
    harness.run_steps(2);
    assert!(!harness.state().session.playback.is_playing);
}

#[test]
fn escape_a_click_beside_the_list_and_close_go_on_with_the_smoke_and_the_menu_opens_it_again() {
    let mut harness = started(Vec2::new(1000.0, 640.0), Theme::Dark, None);
    let is_shown = |harness: &Harness<'_, Window>| harness.query_by_label("Dust storm").is_some();
    for close in 0..3 {
        assert!(is_shown(&harness), "{close}");
        match close {
            0 => harness.key_press(Key::Escape),
            1 => click_at(&mut harness, Pos2::new(5.0, 320.0), PointerButton::Primary),
            _ => harness.get_by_label("Close").click(),
        }
        harness.run_steps(3);
        assert!(!is_shown(&harness), "{close}");
        assert!(is_open(&harness, "column") && harness.state().session.playback.is_playing);
        match close {
            0 => harness.key_press_modifiers(Modifiers::COMMAND, Key::N),
            _ => {
                harness.get_by_label("File").click();
                harness.run_steps(3);
                harness.get_by_label_contains("New from Preset…").click();
            }
        }
        harness.run_steps(3);
    }
}

#[test]
fn no_click_is_lost_while_a_thumbnail_is_rendered() {
    let mut harness = started(Vec2::new(1000.0, 640.0), Theme::Dark, None);
    wait_until(&mut harness, "a thumbnail is begun", |window| window.thumbnails.is_rendering());
    press(&mut harness, "Backlit fog");
    // Two seconds: egui takes a press of 0.8 s for no click.
    harness.run_steps(8);
    release(&mut harness);
    wait_until(&mut harness, "the click", |window| window.session.document.path() == Path::new("backlit_fog"));
}

#[test]
fn no_thumbnail_is_begun_while_a_button_is_held() {
    let mut harness = started(Vec2::new(640.0, 400.0), Theme::Dark, None);
    press(&mut harness, "Start");
    // One may have been begun before.
    wait_until(&mut harness, "its end", |window| !window.thumbnails.is_rendering());
    std::thread::sleep(Duration::from_millis(400));
    harness.run_steps(3);
    assert!(!harness.state().thumbnails.is_rendering());
    release(&mut harness);
    wait_until(&mut harness, "a thumbnail is begun", |window| window.thumbnails.is_rendering());
}

/// Presses the button on something.
fn press(harness: &mut Harness<'_, Window>, name: &str) {
    let pos = harness.get_by_label(name).rect().center();
    harness.hover_at(pos);
    harness.event(button(pos, true));
    harness.run_steps(2);
}

fn release(harness: &mut Harness<'_, Window>) {
    let pos = harness.ctx.input(|input| input.pointer.latest_pos()).unwrap();
    harness.event(button(pos, false));
    harness.run_steps(3);
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

#[test]
fn a_thumbnail_is_rendered_once_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("thumbnails");
    let size = Vec2::new(640.0, 400.0);
    let mut harness = started(size, Theme::Dark, Some(cache.clone()));
    wait_until(&mut harness, "a thumbnail", |window| rendered(window) > 0);
    // It shows the preset.
    let image = haze_core::assets::image::read_png(&std::fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path());
    let image = image.unwrap().into_rgb8();
    assert_eq!(image.dimensions(), (SIZE.x, SIZE.y));
    let brightest = image.as_raw().iter().max().copied();
    assert!(brightest > Some(100), "{brightest:?}");
    drop(harness);
    let count = std::fs::read_dir(&cache).unwrap().count();
    let mut harness = started(size, Theme::Dark, Some(cache.clone()));
    wait_until(&mut harness, "the kept thumbnails", |window| {
        assert!(!window.thumbnails.is_rendering() || rendered(window) > 0);
        rendered(window) >= count
    });
    // That of another text is replaced.
    let kept = ThumbnailCache { folder: Some(cache.clone()) };
    let name = Path::new(builtin::PRESETS[0].name);
    kept.write(name, "{}", &image);
    assert!(kept.read(name, "{}").is_some() && kept.read(name, "{ }").is_none());
    let of_name = |file: &std::fs::DirEntry| file.file_name().to_string_lossy().starts_with(builtin::PRESETS[0].name);
    assert_eq!(std::fs::read_dir(&cache).unwrap().filter(|file| of_name(file.as_ref().unwrap())).count(), 1);
}

#[test]
fn files_that_were_open_are_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine.json");
    std::fs::write(&mine, Preset::load("fence").unwrap().to_json("")).unwrap();
    let gone = folder.path().join("gone.json");
    // A window records the file.
    let session = Session::open(&mine, None).unwrap();
    let mut layout = crate::files::persistence::Layout { recent: vec![gone], ..Default::default() };
    let harness = open(Start { layout, ..start_of(session) }, Vec2::new(800.0, 500.0), Theme::Dark);
    layout = harness.state().layout().clone();
    drop(harness);
    assert_eq!(layout.recent.first(), Some(&mine));
    let session = Session::open(Path::new("column"), None).unwrap();
    let start = Start { layout, has_start_view: true, ..start_of(session) };
    let mut harness = open(start, Vec2::new(800.0, 500.0), Theme::Dark);
    assert!(harness.query_by_label("gone").is_none());
    harness.get_by_label("mine").click();
    harness.run_steps(3);
    wait_until(&mut harness, "the file", |window| window.session.document.path() == mine);
}

/// Sizes of windows in points, and pixels per point.
const WINDOWS: [(Vec2, f32); 5] = [
    (Vec2::new(390.0, 700.0), 1.0),
    (Vec2::new(640.0, 400.0), 1.0),
    (Vec2::new(1280.0, 800.0), 1.0),
    (Vec2::new(1920.0, 1080.0), 1.0),
    (Vec2::new(1280.0, 800.0), 2.0),
];

#[test]
fn images_are_the_largest_part_of_their_cards_and_nothing_leaves_the_window() {
    for (size, scale) in WINDOWS {
        let mut harness = started(size, Theme::Light, None);
        zoom(&mut harness, size, scale);
        let list = AreaState::load(&harness.ctx, Id::unique("start")).unwrap().rect();
        assert!(Rect::from_min_size(Pos2::ZERO, size).shrink(8.0).contains_rect(list), "{size} {scale}: {list}");
        for name in ["Close", "Open…"] {
            let rect = harness.get_all_by_label_contains(name).last().unwrap().rect();
            assert!(list.contains_rect(rect), "{size} {scale}: {name} {rect}");
        }
        for entry in &harness.state().thumbnails.entries {
            let card = harness.get_by_label(&entry.about.as_ref().unwrap().name).rect();
            let image = card.width() * SIZE.y as f32 / SIZE.x as f32;
            assert!(image > 0.6 * card.height() && card.width() >= 240.0, "{size} {scale}: {card}");
            assert!(list.x_range().contains(card.left()) && list.x_range().contains(card.right()), "{size}: {card}");
        }
    }
}

/// Shows a window with more pixels per point.
fn zoom(harness: &mut Harness<'_, Window>, size: Vec2, scale: f32) {
    harness.set_pixels_per_point(scale);
    harness.set_size(size);
    harness.run_steps(4);
}

/// Writes images of the start view in several sizes and both themes to the folder that HAZE_LOOK names. Its thumbnails are
/// kept there.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_the_start_view() {
    let Some(folder) = std::env::var_os("HAZE_LOOK").map(PathBuf::from) else { return };
    for (index, (size, scale)) in WINDOWS.into_iter().enumerate() {
        let theme = if index % 2 == 0 { Theme::Dark } else { Theme::Light };
        let mut harness = started(size, theme, Some(folder.join("thumbnails")));
        zoom(&mut harness, size, scale);
        let name = format!("start_{}x{}_{scale}", size.x, size.y);
        screenshot(&mut harness).save(folder.join(format!("{name}_first.png"))).unwrap();
        wait_until(&mut harness, "all thumbnails", |window| rendered(window) == builtin::PRESETS.len());
        let card = harness.get_by_label("Campfire").rect().center();
        harness.hover_at(card);
        screenshot(&mut harness).save(folder.join(format!("{name}.png"))).unwrap();
    }
}
