//! Tests of lights that rotate about the smoke.

use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use haze::Light;

use super::lit;
use crate::window::Window;
use crate::window::testing::screenshot;

#[test]
fn the_turntable_rotates_lights_and_does_not_change_the_preset() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    let before = harness.state().session.document.preset.clone();
    let shown = |harness: &Harness<'_, Window>| harness.state().session.shot(glam::UVec2::splat(8)).preset.lights[0];
    harness.key_press(Key::T);
    harness.run_steps(8);
    assert!(shown(&harness).position.distance(before.lights[0].position) > 0.2);
    harness.key_press(Key::T);
    harness.run();
    assert_eq!((shown(&harness), &harness.state().session.document.preset), (before.lights[0], &before));
}

#[test]
fn a_path_traced_puff_is_compared_with_the_ramps_while_lights_rotate() {
    let mut harness = lit(Light { intensity: 30.0, ..Light::default() });
    harness.key_press(Key::T);
    // Returns the figures below the puffs once they differ from `before`; the medium is traced and compared in the
    // background.
    let figures = |harness: &mut Harness<'_, Window>, before: &str| {
        let begun = std::time::Instant::now();
        loop {
            if let Some(node) = harness.query_by_label_contains("All lights: ") {
                let node = node.accesskit_node();
                let text = node.label().filter(|label| !label.is_empty()).or(node.value()).unwrap_or_default();
                if text != before {
                    return text;
                }
            }
            assert!(begun.elapsed().as_secs() < 120, "nothing but {before:?}");
            std::thread::sleep(std::time::Duration::from_millis(20));
            harness.run_steps(1);
        }
    };
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Path tracing").is_some());
    let of_painted = figures(&mut harness, "");
    if let Some(folder) = std::env::var_os("HAZE_LOOK") {
        screenshot(&mut harness).save(std::path::Path::new(&folder).join("puff.png")).unwrap();
    }
    // The ramps that were fitted to this medium.
    let material = &mut harness.state_mut().session.document.preset.systems[0].material;
    material.diffuse_ramp = "diffuse_traced_ash".into();
    let of_other = figures(&mut harness, &of_painted);
    let error = |text: &str| text.split([' ', '%']).find_map(|word| word.parse::<f32>().ok()).unwrap();
    assert!(error(&of_painted) > 10.0 && error(&of_other) > 1.0, "{of_painted} {of_other}");
    harness.key_press(Key::T);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("All lights: ").is_none());
}
