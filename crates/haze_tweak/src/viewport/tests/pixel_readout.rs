use std::time::Duration;

use eframe::egui::{self, Key, Pos2, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::session::comparison::CompareWith;
use crate::session::ramp_survey::{self, TwoAxisRamp};
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window};

const SIZE: Vec2 = Vec2::new(1000.0, 640.0);

/// Returns a position in the smoke of `column`.
fn smoke(harness: &Harness<'_, Window>) -> Pos2 {
    harness.get_by_label("viewport").rect().center()
}

/// Steps until a condition holds: texels are read back and analysed on a worker thread.
fn wait_for(harness: &mut Harness<'_, Window>, is_there: impl Fn(&Harness<'_, Window>) -> bool) {
    for _ in 0..300 {
        // Only an image that is drawn is read back.
        screenshot(harness);
        if is_there(harness) {
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!("nothing came");
}

fn shows(harness: &Harness<'_, Window>, text: &str) -> bool {
    harness.query_all_by_label_contains(text).next().is_some()
}

/// Writes an image of the window to the folder that HAZE_LOOK names, for visual inspection.
fn look(harness: &mut Harness<'_, Window>, name: &str) {
    if let Some(folder) = std::env::var_os("HAZE_LOOK").map(std::path::PathBuf::from) {
        screenshot(harness).save(folder.join(format!("{name}.png"))).unwrap();
    }
}

#[test]
fn values_of_the_pixel_under_the_pointer_are_shown_and_a_click_pins_it() {
    let mut harness = window("column", SIZE, Theme::Dark);
    harness.key_press(Key::I);
    let position = smoke(&harness);
    harness.hover_at(position);
    wait_for(&mut harness, |harness| shows(harness, "Coverage"));
    assert!(shows(&harness, "Point 1") && shows(&harness, "Soft scatter") && shows(&harness, "Displayed, sRGB"));
    assert!(shows(&harness, "Click to pin") && shows(&harness, " % left"));
    harness.drag_at(position);
    harness.step();
    harness.drop_at(position);
    harness.run_steps(3);
    harness.remove_cursor();
    harness.run_steps(3);
    assert!(shows(&harness, "Pinned") && shows(&harness, "Coverage"));
    // Docked, the values cover nothing; the next pixel is shown there too.
    let image = |harness: &Harness<'_, Window>| harness.get_by_label("viewport").rect();
    let whole = image(&harness);
    harness.get_by_label("Dock").click();
    harness.run_steps(3);
    let beside = image(&harness);
    assert!(beside.left() > whole.left() + 100.0 && (beside.right() - whole.right()).abs() < 0.5, "{whole} {beside}");
    wait_for(&mut harness, |harness| shows(harness, "Coverage"));
    assert!(harness.get_by_label_contains("Coverage").rect().left() < beside.left());
    look(&mut harness, "docked inspector");
    harness.get_by_label("Undock").click();
    harness.run_steps(3);
    assert_eq!(image(&harness), whole);
    harness.key_press(Key::I);
    harness.run_steps(3);
    assert!(!shows(&harness, "Coverage"));
}

#[test]
fn values_from_before_the_inspector_was_off_are_not_shown() {
    let mut harness = window("column", SIZE, Theme::Dark);
    let pixel = |harness: &Harness<'_, Window>| {
        harness.state().session.inspect.pixel_values.as_ref().map(|values| values.pixel)
    };
    let position = smoke(&harness);
    harness.hover_at(position);
    harness.key_press(Key::I);
    wait_for(&mut harness, |harness| pixel(harness).is_some());
    let inspected = pixel(&harness);
    // Values of another pixel are requested, and come while the inspector is off.
    harness.hover_at(position - Vec2::new(0.0, 60.0));
    harness.step();
    harness.key_press(Key::I);
    harness.step();
    std::thread::sleep(Duration::from_millis(300));
    harness.hover_at(position);
    harness.key_press(Key::I);
    wait_for(&mut harness, |harness| pixel(harness).is_some());
    assert_eq!(pixel(&harness), inspected);
}

#[test]
fn the_inspector_reads_the_compared_image_under_the_pointer() {
    let mut harness = window("column", SIZE, Theme::Dark);
    harness.key_press(Key::I);
    let mut show = |against: CompareWith, x: f32, text: &str| {
        harness.state_mut().session.compare.against = Some(against);
        let position = smoke(&harness) + Vec2::new(x, 0.0);
        harness.hover_at(position);
        wait_for(&mut harness, |harness| shows(harness, text));
        [shows(&harness, "Coverage"), shows(&harness, "Image B: ")]
    };
    assert_eq!(show(CompareWith::FullResolution, -20.0, "Coverage"), [true, false]);
    assert_eq!(show(CompareWith::FullResolution, 20.0, "Image B: Full resolution"), [true, true]);
    assert_eq!(show(CompareWith::Forward, 20.0, "lights each sprite"), [false, true]);
    assert_eq!(show(CompareWith::Reference, 20.0, "The CPU image cannot"), [false, false]);
    assert_eq!(show(CompareWith::Reference, -20.0, "Coverage"), [true, false]);
}

#[test]
fn all_values_fit_on_the_image() {
    // The smallest window; one that shows the colors of lights without numbers; one that shows them with numbers.
    for size in [Vec2::new(640.0, 400.0), SIZE, Vec2::new(1100.0, 640.0)] {
        let mut harness = window("column", size, Theme::Dark);
        // A tab that shows no colors as numbers.
        harness.get_by_label("Cost").click();
        harness.key_press(Key::I);
        let viewport = harness.get_by_label("viewport").rect();
        for side in [-10.0, 10.0] {
            let position = smoke(&harness) + Vec2::new(side, 0.0);
            harness.hover_at(position);
            wait_for(&mut harness, |harness| shows(harness, "Coverage"));
            harness.run_steps(3);
            let is_color = |node: &egui_kittest::Node<'_>| {
                let text = node.accesskit_node().value().unwrap_or_default();
                text.split(' ').filter(|number| number.parse::<f32>().is_ok()).count() == 3
            };
            let of_text = |text| harness.query_all_by_label_contains(text);
            let said: Vec<_> = harness.query_all_by_label_contains(".").filter(is_color).collect();
            assert!(said.len() >= 6, "{}", said.len());
            for node in
                said.into_iter().chain(["Pixel", "Displayed, sRGB", "% left", "None"].into_iter().flat_map(of_text))
            {
                let rect = node.rect();
                let label = node.accesskit_node().value();
                assert!(viewport.contains_rect(rect), "{label:?} at {rect} of {viewport}");
            }
            look(&mut harness, &format!("inspector_{}_{side}", size.x));
        }
    }
}

#[test]
fn pointing_at_a_ramp_highlights_the_smoke_that_samples_it() {
    let mut harness = window("column", SIZE, Theme::Dark);
    harness.get_by_label("Ramps").click();
    wait_for(&mut harness, |harness| shows(harness, "Point 1"));
    let viewport = harness.get_by_label("viewport").rect();
    let before = brightness(&screenshot(&mut harness), viewport);
    // The middle of the diffuse ramp, which most of the lit smoke samples.
    let ramp = harness.get_by_label("Diffuse ramp").rect();
    harness.hover_at(egui::pos2(ramp.center().x, ramp.center().y));
    harness.step();
    let flash = brightness(&screenshot(&mut harness), viewport);
    harness.run_steps(10);
    let lit = brightness(&screenshot(&mut harness), viewport);
    assert!(lit > before + 0.5 && flash > lit + 0.3, "{before} {flash} {lit}");
    harness.hover_at(egui::pos2(5.0, 5.0));
    harness.run_steps(3);
    assert!((brightness(&screenshot(&mut harness), viewport) - before).abs() < 0.1);
}

#[test]
fn pointing_at_a_ramp_with_two_axes_highlights_the_smoke_that_samples_it() {
    for (preset, name, ramp) in
        [("column", "Shadow ramp", TwoAxisRamp::Shadow), ("oil_fire", "Fire ramp", TwoAxisRamp::Fire)]
    {
        let mut harness = window(preset, SIZE, Theme::Dark);
        harness.get_by_label("Ramps").click();
        wait_for(&mut harness, |harness| harness.state().session.inspect.survey.is_some());
        // The lookups of the image have arrived after the tab was drawn; their legend comes in the next frame.
        harness.run_steps(2);
        harness.get_by_label(name).scroll_to_me();
        harness.run_steps(20);
        let viewport = harness.get_by_label("viewport").rect();
        let before = brightness(&screenshot(&mut harness), viewport);
        let Some(survey) = harness.state().session.inspect.survey.clone() else { panic!("no survey of {preset}") };
        let density = survey.over_both_axes(ramp, 0);
        let most = (0..density.len()).max_by(|a, b| density[*a].total_cmp(&density[*b])).unwrap();
        let position =
            Vec2::new((most % ramp_survey::SIDE) as f32, (most / ramp_survey::SIDE) as f32) + Vec2::splat(0.5);
        let position = position / ramp_survey::SIDE as f32;
        let rect = harness.get_by_label(name).rect();
        harness
            .hover_at(egui::pos2(rect.left() + position.x * rect.width(), rect.bottom() - position.y * rect.height()));
        harness.run_steps(3);
        let image = screenshot(&mut harness);
        let lit = brightness(&image, viewport);
        assert!(lit > before + 0.2, "{preset}: {before} {lit}");
        look(&mut harness, &format!("ramp_{preset}"));
        // Values of the pixel under the pointer, and its marks on the ramps.
        harness.key_press(Key::I);
        let position = smoke(&harness);
        harness.hover_at(position);
        wait_for(&mut harness, |harness| shows(harness, "Click to pin"));
        assert_eq!([shows(&harness, " % left"), shows(&harness, "heat 0.")], [true, ramp == TwoAxisRamp::Fire]);
        look(&mut harness, &format!("inspector_{preset}"));
    }
}

#[test]
fn the_fire_ramp_is_shown_as_painted_or_as_exposed() {
    let mut harness = window("oil_fire", SIZE, Theme::Dark);
    harness.get_by_label("Ramps").click();
    // Until the samples of the image are drawn over the ramp.
    wait_for(&mut harness, |harness| harness.state().session.inspect.survey.is_some());
    harness.get_by_label("Fire ramp").scroll_to_me();
    harness.run_steps(20);
    let ramp_brightness = |harness: &mut Harness<'_, Window>, exposure: f32| {
        harness.state_mut().session.document.preset.camera.exposure = exposure;
        harness.run_steps(4);
        let rect = harness.get_by_label("Fire ramp").rect();
        brightness(&screenshot(harness), rect)
    };
    let painted = ramp_brightness(&mut harness, 0.0);
    let at_any_exposure = ramp_brightness(&mut harness, -4.0);
    assert!((painted - at_any_exposure).abs() < 1.0, "{painted} {at_any_exposure}");
    harness.get_by_label("As exposed").click();
    let dark = ramp_brightness(&mut harness, -4.0);
    let bright = ramp_brightness(&mut harness, 0.0);
    assert!(dark < bright - 10.0 && bright > painted + 10.0, "{painted} {dark} {bright}");
    look(&mut harness, "fire_as_exposed");
}

#[test]
fn the_highlight_is_painted_below_the_toolbar() {
    let mut harness = window("column", SIZE, Theme::Dark);
    // Fills the image with smoke.
    let camera = &mut harness.state_mut().session.document.preset.camera;
    camera.position = camera.target.lerp(camera.position, 0.2);
    harness.get_by_label("Ramps").click();
    wait_for(&mut harness, |harness| shows(harness, "Point 1"));
    let ramp = harness.get_by_label("Diffuse ramp").rect();
    let viewport = harness.get_by_label("viewport").rect();
    let tool = harness.get_by_label("Lit plane").rect();
    let beside = egui::Rect::from_min_size(tool.left_bottom() + Vec2::new(0.0, 12.0), tool.size());
    let mut parts = |fraction: f32| {
        harness.hover_at(egui::pos2(ramp.left() + fraction * ramp.width(), ramp.center().y));
        harness.run_steps(3);
        let image = screenshot(&mut harness);
        [brightness(&image, tool), brightness(&image, beside), brightness(&image, viewport)]
    };
    let all: Vec<_> = (0..12).map(|step| parts(0.04 + 0.08 * step as f32)).collect();
    let spread = |part: usize| {
        let values = || all.iter().map(|parts| parts[part]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    assert!(spread(1) > 1.0, "nothing is lit beside the tools: {all:?}");
    assert!(spread(0) < 0.01, "{all:?}");
}

#[test]
fn a_still_image_is_not_drawn_again() {
    let mut harness = window("column", SIZE, Theme::Dark);
    harness.key_press(Key::I);
    harness.get_by_label("Ramps").click();
    wait_for(&mut harness, |harness| shows(harness, "Point 1"));
    // At most the pending copy, its analysis, and the end of its interval.
    for _ in 0..5 {
        screenshot(&mut harness);
        std::thread::sleep(Duration::from_millis(300));
    }
    harness.run_steps(4);
    let delay = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(delay > Duration::from_secs(10), "{delay:?}");
}
