//! The present smoke with every ramp of a role, side by side. A click takes one.

use eframe::egui::{self, Sense, Ui, Vec2};
use haze_core::assets::ramp::RampRole;
use haze_core::settings::{ImageRole, set_field};

use crate::document::display_names::display_name;
use crate::document::ramp_edits::ramp_name;
use crate::session::Session;
use crate::session::look_thumbnails::{LookEntry, WIDTH, thumbnail_size};

/// Margin around an image, and height of a name, points.
const MARGIN: f32 = 4.0;
const NAME: f32 = 18.0;

/// Draws the button that shows all looks of a field.
pub fn button(ui: &mut Ui, session: &mut Session, system: usize, field: &'static str) {
    let name = format!("Looks: {}", display_name(field));
    let button = ui.button("Looks…");
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if button.on_hover_text("Shows this smoke with every ramp that fits here").clicked() {
        let wanted = RampRole::from_field(field);
        let fits = |name: &String| RampRole::from_name(name).is_none_or(|role| wanted == Some(role));
        let names = session.thumbnails.names(ui.ctx(), ImageRole::Ramp).into_iter().filter(fits).collect();
        session.looks.open(system, field, names);
    }
}

/// Draws the list over the image while it is open.
pub fn panel(ui: &Ui, session: &mut Session, image: egui::Rect) {
    if session.looks.shown().is_none() {
        return;
    }
    let shot = session.shot(session.view.size);
    let folders = session.folders();
    session.looks.advance(ui.ctx(), &shot, &folders);
    let Some(shown) = session.looks.shown() else { return };
    let system = shown.system;
    let field = shown.field;
    let path = format!("systems[{system}].material.{field}");
    let now = ramp_name(&session.document.preset, system, field);
    let mut is_open = true;
    let mut chosen = None;
    let most = image.size() - Vec2::new(24.0, 64.0);
    let title = format!("Looks: {}", display_name(field));
    let window = egui::Window::new(title).id(egui::Id::unique("looks")).open(&mut is_open).collapsible(false);
    let window = window.constrain_to(image).default_pos(image.min + Vec2::splat(8.0)).max_size(most);
    window.default_size(Vec2::new(most.x.min(4.0 * (WIDTH as f32 + 18.0)), most.y.min(760.0))).show(ui.ctx(), |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for entry in &shown.entries {
                    if cell(ui, entry, now.as_ref() == Some(&entry.name), shot.size) {
                        chosen = Some(entry.name.clone());
                    }
                }
            });
        });
    });
    if let Some(name) = chosen
        && let Err(error) = set_field(&mut session.document.preset, &path, &name)
    {
        session.messages.error("ramp", error);
    }
    if !is_open {
        session.looks.close();
    }
}

/// Draws a look with its name. Returns true if it was clicked.
fn cell(ui: &mut Ui, entry: &LookEntry, is_chosen: bool, view: glam::UVec2) -> bool {
    let size = Vec2::from(thumbnail_size(view).as_vec2().to_array());
    let (rect, response) = ui.allocate_exact_size(size + Vec2::new(2.0 * MARGIN, NAME + 2.0 * MARGIN), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, format!("Look {}", entry.name))
    });
    let visuals = ui.style().interact_selectable(&response, is_chosen);
    if is_chosen || response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 3.0, visuals.bg_fill);
    }
    let image_rect = egui::Rect::from_min_size(rect.min + Vec2::splat(MARGIN), size);
    match &entry.image {
        Some(image) => egui::Image::new(image).paint_at(ui, image_rect),
        None => _ = ui.painter().rect_filled(image_rect, 0.0, ui.visuals().extreme_bg_color),
    }
    let text = egui::WidgetText::from(entry.name.as_str());
    let text = text.into_galley(ui, Some(egui::TextWrapMode::Truncate), size.x, egui::TextStyle::Small);
    ui.painter().galley(image_rect.left_bottom() + Vec2::new(0.0, 2.0), text, visuals.text_color());
    response.on_hover_text(&entry.name).clicked()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use eframe::egui::{Key, Modifiers, Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;

    use crate::window::Window;
    use crate::window::testing::window;

    fn rendered(harness: &Harness<'_, Window>) -> usize {
        let looks = harness.state().session.looks.shown();
        looks.map_or(0, |looks| looks.entries.iter().filter(|entry| entry.image.is_some()).count())
    }

    fn wait_for(harness: &mut Harness<'_, Window>, count: usize) {
        for _ in 0..600 {
            harness.step();
            if rendered(harness) >= count {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("{} of {count} looks", rendered(harness));
    }

    #[test]
    fn this_smoke_is_shown_under_every_ramp_of_the_role_and_a_click_takes_one() {
        let mut harness = window("column", Vec2::new(1000.0, 640.0), Theme::Dark);
        harness.get_by_label("Ramps").click();
        harness.run_steps(3);
        harness.get_by_label("Looks: Diffuse ramp").click();
        harness.run_steps(3);
        let names: Vec<_> =
            harness.state().session.looks.shown().unwrap().entries.iter().map(|entry| entry.name.clone()).collect();
        assert!(names.len() > 10 && names.iter().all(|name| name.starts_with("diffuse_")), "{names:?}");
        // The window is usable meanwhile.
        wait_for(&mut harness, 3);
        let before = harness.state().session.document.preset.clone();
        harness.get_by_label("Look diffuse_dusk").click();
        harness.run_steps(3);
        let after = &harness.state().session.document.preset;
        assert_eq!(after.systems[0].material.diffuse_ramp, "diffuse_dusk");
        // It stays open, and no thumbnail is rendered again: they do not depend on the choice.
        let count = rendered(&harness);
        harness.run_steps(3);
        assert!(count >= 3 && rendered(&harness) >= count);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(3);
        assert_eq!(harness.state().session.document.preset, before);
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        assert!(harness.state().session.looks.shown().is_none());
    }
}
