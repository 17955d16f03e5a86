//! Choice of the second image, and controls of the comparison.

use eframe::egui::{self, Button, Ui};

use crate::session::Session;
use crate::session::action::{Action, keys_of};
use crate::session::comparison::{COMPARE_OPTIONS, CompareOption, CompareWith};

/// Gap between buttons of one choice, points.
const GAP: f32 = 2.0;

/// Draws buttons if they fit into `room`, points. With less room, some buttons are in the menu only.
pub fn panel(ui: &mut Ui, session: &mut Session, room: f32) {
    let row: f32 = COMPARE_OPTIONS.iter().map(|offer| width(ui, offer.short) + GAP).sum();
    let row = row + width(ui, "Compare") + ui.spacing().item_spacing.x;
    let beside = ["Difference", "256.0×", "Use B", "Swap"].map(|name| width(ui, name) + ui.spacing().item_spacing.x);
    let beside: f32 = beside.iter().sum();
    // The layout does not depend on whether a comparison is on, so that buttons do not move.
    let has_row = row + beside <= room;
    let has_tools = has_row || width(ui, "Full resolution") + beside <= room;
    let against = session.compare.against.as_ref();
    let is_in_row =
        has_row && against.is_some_and(|against| COMPARE_OPTIONS.iter().any(|offer| offer.against == *against));
    let name = against.filter(|_| !is_in_row).map_or("Compare", CompareWith::name);
    ui.menu_button(name, |ui| {
        menu(ui, session);
        if !has_tools && session.compare.against.is_some() {
            ui.separator();
            tools(ui, session);
        }
    })
    .response
    .on_hover_text("Compares the image (A) with a second one (B)");
    if has_row {
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            for CompareOption { against, short, tooltip, .. } in &COMPARE_OPTIONS {
                let button = ui.selectable_label(session.compare.against.as_ref() == Some(against), *short);
                let button = button.on_hover_text(format!("{tooltip} ({})", keys(ui, against)));
                if button.clicked() {
                    session.compare.toggle(against);
                }
            }
        });
    }
    if has_tools && session.compare.against.is_some() {
        tools(ui, session);
    }
}

fn keys(ui: &Ui, against: &'static CompareWith) -> String {
    keys_of(Action::Compare(against)).map_or(String::new(), |keys| ui.ctx().format_shortcut(&keys))
}

/// Draws the menu of all comparisons.
fn menu(ui: &mut Ui, session: &mut Session) {
    let kept = CompareWith::Kept(Box::new(session.document.preset.clone()));
    let compare = &mut session.compare;
    let mut entry = |ui: &mut Ui, against: Option<CompareWith>, name: &str, tooltip: &str, keys: String| {
        let kind = |against: &Option<CompareWith>| against.as_ref().map(std::mem::discriminant);
        let button = Button::selectable(kind(&compare.against) == kind(&against), name);
        let button = if keys.is_empty() { button } else { button.shortcut_text(keys) };
        if ui.add(button).on_hover_text(tooltip).clicked() {
            compare.against = against;
            ui.close();
        }
    };
    entry(ui, None, "Off", "Shows one image", String::new());
    let tooltip = "Copies the current settings to image B. Later changes show in image A only.";
    entry(ui, Some(kept), "Current settings", tooltip, String::new());
    for CompareOption { against, name, tooltip, .. } in &COMPARE_OPTIONS {
        entry(ui, Some(against.clone()), name, tooltip, keys(ui, against));
    }
}

/// Draws the controls of a comparison, and the buttons that copy from the second image.
fn tools(ui: &mut Ui, session: &mut Session) {
    let compare = &mut session.compare;
    let mut is_difference = compare.difference > 0.0;
    let difference = ui.toggle_value(&mut is_difference, "Difference");
    if difference.on_hover_text("Shows the amplified difference of the two images").changed() {
        compare.difference = if is_difference { 8.0 } else { 0.0 };
    }
    if is_difference {
        let times = egui::DragValue::new(&mut compare.difference).range(1.0..=256.0).speed(0.2).suffix("×");
        ui.add(times).on_hover_text("Amplification of the difference");
    }
    let Some(against) = compare.against.clone() else { return };
    let Some(second) = against.settings(session.saved()).cloned() else { return };
    if ui.button("Use B").on_hover_text("Replaces the settings by those of image B. Undo restores them.").clicked() {
        session.document.preset = second.clone();
    }
    if ui.button("Swap").on_hover_text("Swaps the settings of the two images").clicked() {
        session.compare.against =
            Some(CompareWith::Kept(Box::new(std::mem::replace(&mut session.document.preset, second))));
    }
}

/// Returns the width of a button, points.
pub fn width(ui: &Ui, name: &str) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.into(), font, egui::Color32::WHITE);
    text.size().x + 2.0 * ui.spacing().button_padding.x
}

#[cfg(test)]
mod tests {
    use eframe::egui::{Key, Rect, Theme, Vec2};
    use egui_kittest::kittest::{NodeT as _, Queryable as _};

    use super::*;
    use crate::window::testing::window;

    #[test]
    fn no_buttons_at_the_top_overlap_in_any_comparison() {
        for width in [640.0, 800.0, 1000.0, 1280.0] {
            let mut harness = window("column", Vec2::new(width, 500.0), Theme::Dark);
            for (key, offer) in [Key::F5, Key::F6, Key::F7, Key::F8].into_iter().zip(&COMPARE_OPTIONS) {
                harness.key_press(key);
                harness.run_steps(3);
                assert_eq!(harness.state().session.compare.against.as_ref(), Some(&offer.against));
                let is_on_top = |node: &egui_kittest::Node<'_>| {
                    node.accesskit_node().role() == egui::Role::Button && node.rect().bottom() < 26.0
                };
                let buttons: Vec<Rect> =
                    harness.query_all_by(|_| true).filter(is_on_top).map(|node| node.rect()).collect();
                let row = Rect::from_min_size(Default::default(), Vec2::new(width, 26.0));
                for (index, button) in buttons.iter().enumerate() {
                    let is_free = buttons[..index].iter().all(|other| !other.shrink(0.5).intersects(*button));
                    assert!(is_free && row.contains_rect(*button), "{width}: {buttons:?}");
                }
                assert!(buttons.len() >= 8, "{buttons:?}");
            }
            harness.key_press(Key::F8);
            harness.run_steps(3);
            assert_eq!(harness.state().session.compare.against, None);
        }
    }
}
