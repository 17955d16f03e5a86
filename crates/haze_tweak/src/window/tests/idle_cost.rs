//! Cost of the window while it is used and while it is idle.

use std::time::{Duration, Instant};

use eframe::egui::{Pos2, Rect, Role, Theme, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze_export::debug_view_sheet::DEBUG_VIEWS;
use image::RgbaImage;

use crate::window::Window;
use crate::window::testing::{screenshot, window};

/// Opens a window whose viewport has this size.
fn window_around(size: Vec2) -> Harness<'static, Window> {
    let harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
    let room = Vec2::new(1000.0, 640.0) - harness.get_by_label("viewport").rect().size();
    drop(harness);
    window("column", size + room, Theme::Dark)
}

fn slider(harness: &Harness<'_, Window>, name: &str) -> Rect {
    let mut rows = harness.get_all_by_label(name);
    rows.find(|node| node.accesskit_node().role() == Role::Slider).unwrap().rect()
}

/// Returns the CPU time of this process over all threads, milliseconds. Other load on the machine does not change it.
fn worked() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit_once(')').map_or("", |(_, fields)| fields).split_whitespace().skip(11).take(2);
    fields.map(|ticks| 10.0 * ticks.parse::<f64>().unwrap()).sum()
}

/// Drags a slider back and forth. Returns the frames per second after ten frames of warm-up, and the largest divisor of
/// the resolution.
fn drag(harness: &mut Harness<'_, Window>, frames: usize) -> (f64, u32) {
    let rect = slider(harness, "Thickness");
    let at = |frame: usize| Pos2::new(rect.left() + 8.0 + (frame * 7 % 90) as f32, rect.center().y);
    harness.drag_at(at(0));
    let mut start = Instant::now();
    let mut before = worked();
    let mut coarsest = 1;
    for frame in 0..frames + 10 {
        if frame == 10 {
            start = Instant::now();
            before = worked();
        }
        harness.hover_at(at(frame));
        screenshot(harness);
        coarsest = coarsest.max(harness.state().renderer().divisor());
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("{:.0} ms of work a frame", (worked() - before) / frames as f64);
    harness.drop_at(at(0));
    harness.run_steps(2);
    (frames as f64 / seconds, coarsest)
}

/// The result depends on the machine, which may be busy.
#[test]
#[ignore = "measurement; run it alone"]
fn a_slider_is_dragged_at_15_frames_a_second() {
    for size in [vec2(640.0, 360.0), vec2(1280.0 - 330.0, 800.0 - 190.0)] {
        let mut harness = window_around(size);
        let (rate, coarsest) = drag(&mut harness, 80);
        println!("{size:?}: {rate:.1} frames a second, {coarsest} pixels each way");
        assert!(rate >= 15.0 || size.x > 640.0, "{rate}");
        assert_eq!(harness.state().renderer().divisor(), 1);
    }
}

/// Waits for the thumbnails of the systems.
fn wait_for_systems(harness: &mut Harness<'_, Window>) {
    let start = Instant::now();
    while !matches!(&harness.state().session.view.systems.images[..], [Some(_), ..]) {
        assert!(start.elapsed() < Duration::from_secs(60), "no thumbnail");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
}

#[test]
fn the_thumbnail_of_a_system_follows_its_settings_after_a_drag() {
    let mut harness = window("column", Vec2::new(700.0, 480.0), Theme::Dark);
    wait_for_systems(&mut harness);
    let image = |harness: &Harness<'_, Window>| harness.state().session.view.systems.images[0];
    let before = image(&harness);
    // A turn of the camera, and time, renew nothing.
    harness.state_mut().session_mut().document.preset.camera.position.x += 1.0;
    harness.state_mut().session_mut().playback.time += 1.0;
    let rest = |harness: &mut Harness<'_, Window>| {
        for _ in 0..60 {
            std::thread::sleep(Duration::from_millis(20));
            harness.step();
        }
    };
    rest(&mut harness);
    assert_eq!(image(&harness), before);
    let rect = slider(&harness, "Thickness");
    harness.drag_at(rect.center());
    harness.step();
    harness.hover_at(rect.right_center());
    rest(&mut harness);
    assert_eq!(image(&harness), before, "not while it is dragged");
    harness.drop_at(rect.right_center());
    let start = Instant::now();
    while image(&harness) == before {
        assert!(start.elapsed() < Duration::from_secs(60), "not renewed");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
}

#[test]
fn stages_that_are_drawn_one_by_one_end_as_those_drawn_at_once() {
    let mut harness = window("column", Vec2::new(700.0, 480.0), Theme::Dark);
    let at_once = screenshot(&mut harness);
    harness.state().renderer().draw_stages_one_by_one();
    harness.state_mut().session_mut().playback.time += 1.0;
    for _ in 0..DEBUG_VIEWS.len() {
        screenshot(&mut harness);
    }
    harness.state_mut().session_mut().playback.time -= 1.0;
    // The first stage alone is of this time.
    let strip = Rect::from_min_max(harness.get_by_label("Reduced depth").rect().min, pos2(700.0, 480.0));
    let count = |a: &RgbaImage, b: &RgbaImage| {
        let pixels = (strip.top() as u32..strip.bottom() as u32).flat_map(|y| (0..700).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| a.get_pixel(x, y) != b.get_pixel(x, y)).count()
    };
    let one = screenshot(&mut harness);
    assert!(count(&one, &at_once) > 100);
    for _ in 0..DEBUG_VIEWS.len() {
        screenshot(&mut harness);
    }
    assert_eq!(count(&screenshot(&mut harness), &at_once), 0);
}

#[test]
fn an_idle_window_draws_nothing_and_requests_no_repaint() {
    let mut harness = window("column", Vec2::new(700.0, 480.0), Theme::Dark);
    wait_for_systems(&mut harness);
    let drawn = |harness: &mut Harness<'_, Window>| {
        screenshot(harness);
        harness.state().renderer().render_stats().renders
    };
    drawn(&mut harness);
    harness.run_steps(10);
    let before = drawn(&mut harness);
    assert!(!harness.ctx.has_requested_repaint());
    // Widgets under a moving pointer are highlighted, but no smoke is drawn.
    let rect = slider(&harness, "Exposure");
    for step in 0..6 {
        harness.hover_at(rect.left_top() + vec2(8.0 * step as f32, -6.0 * step as f32));
        assert_eq!(drawn(&mut harness), before);
    }
    harness.state_mut().session_mut().document.preset.camera.fov += 5.0;
    assert!(drawn(&mut harness) > before);
}

#[test]
fn the_full_resolution_returns_when_everything_is_released() {
    let mut harness = window("column", Vec2::new(700.0, 480.0), Theme::Dark);
    let whole = screenshot(&mut harness);
    // The status bar, where a drag changes nothing.
    let at = Pos2::new(350.0, 476.0);
    harness.drag_at(at);
    harness.step();
    harness.state().renderer().simulate_slow_frame();
    let coarse = screenshot(&mut harness);
    assert!(harness.state().renderer().divisor() > 1);
    harness.drop_at(at);
    harness.run_steps(3);
    let again = screenshot(&mut harness);
    let part = harness.get_by_label("viewport").rect().shrink(8.0);
    let apart = |a: &RgbaImage, b: &RgbaImage| {
        let pixels = (part.top() as u32..part.bottom() as u32)
            .flat_map(|y| (part.left() as u32..part.right() as u32).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| a.get_pixel(x, y) != b.get_pixel(x, y)).count()
    };
    assert!(apart(&whole, &coarse) > 1000);
    assert_eq!((harness.state().renderer().divisor(), apart(&whole, &again)), (1, 0));
}
