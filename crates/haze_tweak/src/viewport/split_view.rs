//! Second image of a comparison: the divider and the labels.

use eframe::egui::{self, Sense, Ui};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::display_transform;

use crate::session::Session;
use crate::session::comparison::CompareWith;
use crate::session::messages::truncate_middle;
use crate::viewport_renderer::comparison_image::ComparisonImage;
use crate::viewport_renderer::cpu_render_job::CpuRenderState;

/// Returns the second image, once it is available.
pub fn comparison_image(ui: &Ui, session: &mut Session, shot: &Shot) -> Option<ComparisonImage> {
    let against = session.compare.against.clone()?;
    if against != CompareWith::Reference {
        return Some(ComparisonImage::Shot(Box::new(against.shot(shot, session.saved(), &session.view))));
    }
    let wake = session.repaint.clone();
    match session.cpu_render_job.poll_or_start(shot, move || wake.call()) {
        CpuRenderState::Ready(image) => {
            session.messages.clear("reference");
            return Some(ComparisonImage::Image(image, display_transform(shot)));
        }
        CpuRenderState::Later(wait) => ui.ctx().request_repaint_after(wait),
        CpuRenderState::Failed(error) => session.messages.error("reference", error),
        CpuRenderState::Soon => {}
    }
    None
}

/// Fraction of the width by which an arrow key moves the divider.
const STEP: f32 = 0.02;

/// Draws the divider between two images and moves it by drag or arrow keys.
pub fn divider(ui: &Ui, rect: egui::Rect, split: &mut f32) {
    let x = rect.left() + *split * rect.width();
    let grip = egui::Rect::from_x_y_ranges(x - 5.0..=x + 5.0, rect.y_range());
    let response = ui
        .interact(grip, ui.scope_id().with("divider"), Sense::drag() | Sense::focusable_noninteractive())
        .on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(*split), "divider"));
    let mut moved = response.drag_delta().x / rect.width();
    if response.has_focus() {
        let arrows = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let presses = |key| ui.input(|input| input.num_presses(key)) as f32;
        moved += STEP * (presses(egui::Key::ArrowRight) - presses(egui::Key::ArrowLeft));
    }
    if moved != 0.0 {
        *split = (*split + moved).clamp(0.02, 0.98);
    }
    let x = (rect.left() + *split * rect.width()).round() + 0.5;
    let color = if response.hovered() || response.dragged() || response.has_focus() {
        egui::Color32::WHITE
    } else {
        egui::Color32::from_white_alpha(160)
    };
    ui.painter().vline(x - 1.0, rect.y_range(), egui::Stroke::new(1.0, egui::Color32::from_black_alpha(160)));
    ui.painter().vline(x, rect.y_range(), egui::Stroke::new(1.0, color));
    ui.painter().circle(
        egui::pos2(x, rect.center().y),
        5.0,
        egui::Color32::from_black_alpha(120),
        egui::Stroke::new(1.0, color),
    );
}

/// Draws labels in the lower corners that name each image and its cost, and the PSNR above that of the second.
pub fn labels(ui: &Ui, rect: egui::Rect, session: &Session) {
    let Some(against) = &session.compare.against else { return };
    let edited = if session.document.is_dirty() { ", edited" } else { "" };
    let first = format!("A  {}{edited}", truncate_middle(&session.document.title(), 24));
    let [of_first, of_second] = session.timings.stats.smoke_ms_of_pair.map(|ms| ms.map(|ms| format!("   {ms:.2} ms")));
    let took = session.cpu_render_job.took.filter(|_| *against == CompareWith::Reference);
    let took = took.map(|took| format!("   {:.0} ms on the CPU", 1.0e3 * took.as_secs_f32()));
    let of_second = if *against == CompareWith::Reference { took } else { of_second };
    let second = format!("B  {}", against.name());
    let what = "Time of the smoke, if the device can measure it";
    text_plate(ui, rect, egui::Align2::LEFT_BOTTOM, &(first + &of_first.unwrap_or_default())).on_hover_text(what);
    let plate = text_plate(ui, rect, egui::Align2::RIGHT_BOTTOM, &(second + &of_second.unwrap_or_default()));
    let above = rect.with_max_y(plate.rect.top());
    plate.on_hover_text(what);
    if let Some(text) = session.psnr_job.text() {
        text_plate(ui, above, egui::Align2::RIGHT_BOTTOM, &text).on_hover_text(
            "Peak signal-to-noise ratio of the two images, over all pixels and at depth edges. Higher is more alike.",
        );
    }
}

/// Draws text on a dark background in a corner of a part of the image.
fn text_plate(ui: &Ui, rect: egui::Rect, corner: egui::Align2, text: &str) -> egui::Response {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE);
    let inside = corner.align_size_within_rect(galley.size(), rect.shrink2(egui::vec2(12.0, 10.0)));
    let text_plate = inside.expand2(egui::vec2(6.0, 3.0));
    let response = ui.interact(text_plate, ui.scope_id().with((corner, text_plate.top() as i32)), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Status, true, text));
    ui.painter().rect_filled(text_plate, 3.0, egui::Color32::from_black_alpha(170));
    ui.painter().galley(inside.min, galley, egui::Color32::WHITE);
    response
}

#[cfg(test)]
mod tests {
    use eframe::egui::Vec2;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};

    use super::*;
    use crate::window::testing::{measured, screenshot, window};

    #[test]
    fn the_divider_can_be_moved_by_keys() {
        let mut harness = window("column", Vec2::new(640.0, 400.0), egui::Theme::Dark);
        harness.key_press(egui::Key::F6);
        harness.run_steps(2);
        harness.get_by_label("divider").focus();
        harness.run_steps(2);
        for (key, expected) in [(egui::Key::ArrowRight, 0.5 + STEP), (egui::Key::ArrowLeft, 0.5)] {
            harness.key_press(key);
            harness.run_steps(2);
            assert!((harness.state().session.compare.split - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn both_images_show_their_names_and_their_cost() {
        let mut harness = measured("column", Vec2::new(1000.0, 640.0));
        harness.state_mut().session.document.preset.camera.exposure = 1.0;
        let mut label = |against: CompareWith, sign: &str, unit: &str| {
            harness.state_mut().session.compare.against = Some(against);
            for _ in 0..300 {
                screenshot(&mut harness);
                let label = harness.query_by_label_contains(sign).and_then(|node| node.accesskit_node().label());
                if let Some(label) = label.filter(|label| label.ends_with(unit)) {
                    return label;
                }
                std::thread::sleep(std::time::Duration::from_millis(20));
            }
            panic!("nothing is said of {sign}");
        };
        let ms = |label: &str| label.split_whitespace().rev().nth(1).unwrap().parse::<f32>().unwrap();
        let first = label(CompareWith::FullResolution, "A  ", " ms");
        assert!(first.starts_with("A  column, edited   ") && ms(&first) > 0.0, "{first}");
        // Other programs may slow down either.
        let is_dearer = (0..5).any(|_| {
            let whole = label(CompareWith::FullResolution, "B  Full resolution   ", " ms");
            label(CompareWith::Forward, "B  Forward   ", " ms");
            ms(&whole) > ms(&label(CompareWith::FullResolution, "A  ", " ms"))
        });
        assert!(is_dearer, "{first}");
        let judged = label(CompareWith::Reference, "B  CPU reference   ", " ms on the CPU");
        assert!(judged.ends_with(" ms on the CPU"), "{judged}");
    }
}
