//! What the picture is compared with, and how.

use eframe::egui::{self, Ui};

use crate::app::tweak::compare::{Against, Compare};
use crate::app::tweak::session::Session;

pub fn panel(ui: &mut Ui, session: &mut Session) {
    let compare = &mut session.compare;
    let name = compare.against.as_ref().map_or("Compare", Against::name);
    ui.menu_button(name, |ui| {
        let kept = Against::Kept(Box::new(session.document.preset.clone()));
        let entries = [
            ("Nothing", None, "One picture"),
            ("As saved", Some(Against::Saved), "The preset as it is on disk"),
            ("As it is now", Some(kept), "Keeps these settings, and shows beside them what is changed from here on"),
            ("Full resolution", Some(Against::FullResolution), "The same smoke without a reduced target"),
            ("Forward", Some(Against::Forward), "The same smoke lit and blended sprite by sprite, the classic way"),
            (
                "CPU reference",
                Some(Against::Reference),
                "The same by the CPU renderer, which the specification is: takes a while",
            ),
        ];
        for (name, against, tooltip) in entries {
            let is_on =
                compare.against.as_ref().map(std::mem::discriminant) == against.as_ref().map(std::mem::discriminant);
            if ui.selectable_label(is_on, name).on_hover_text(tooltip).clicked() {
                *compare = Compare { against, ..compare.clone() };
                ui.close();
            }
        }
    })
    .response
    .on_hover_text("Shows a second picture at the right of a divider");
    let Some(against) = compare.against.clone() else { return };
    let mut is_difference = compare.difference > 0.0;
    if ui
        .toggle_value(&mut is_difference, "Difference")
        .on_hover_text("How far the two are apart, made brighter")
        .changed()
    {
        compare.difference = if is_difference { 8.0 } else { 0.0 };
    }
    if is_difference {
        let times = egui::DragValue::new(&mut compare.difference).range(1.0..=256.0).speed(0.2).prefix("x ");
        ui.add(times).on_hover_text("How much brighter");
    }
    let Some(second) = against.settings(session.saved()).cloned() else { return };
    if ui.button("Use").on_hover_text("Takes the second over; Undo brings this one back").clicked() {
        session.document.preset = second.clone();
    }
    if ui.button("Swap").on_hover_text("Edits the second, beside these settings").clicked() {
        session.compare.against =
            Some(Against::Kept(Box::new(std::mem::replace(&mut session.document.preset, second))));
    }
}
