//! One row of a panel: mark, name, control.

pub mod color_popup;
pub mod copy_icon;
mod curve_editor;
pub mod icon_button;
pub mod image_gallery;
pub mod key_mark;
pub mod setting_rows;
pub mod soft_fade_plot;
pub mod value_control;
pub mod value_text;

use eframe::egui::{self, Response, Ui};

use haze_core::settings::BackdropKind;

use crate::document::display_names::display_name;
use icon_button::Icon;
use key_mark::{KeyMark, KeyState};

/// Width of the names, points, and their largest fraction of a row.
const NAME: f32 = 118.0;
const NAME_FRACTION: f32 = 0.36;
/// Width of the mark before a name, points.
const MARK: f32 = 12.0;

/// Texts and marks of a row.
pub struct Row<'a> {
    pub name: &'a str,
    pub tooltip: &'a str,
    /// The value differs from the preset on disk.
    pub is_changed: bool,
    /// Second image's value as text, if it differs; the outer `None` means that it has no settings of its own.
    pub second: Option<Option<&'a str>>,
    /// Label of the button that makes a sheet of values, if one can be made.
    pub sheet: Option<&'a str>,
    /// Mark of the setting's keyframes, if it can have any.
    pub key: Option<KeyMark>,
    /// Reason why the setting has no effect.
    pub reason_without_effect: Option<&'a str>,
}

/// Request made on a row, beside its control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowRequest {
    Reset,
    /// Copy the second image's value.
    CopySecond,
    /// Make a sheet of its values.
    Sheet,
    /// Add a keyframe at the time of the playback, or delete the one that is there.
    Key,
    /// Delete all keyframes.
    RemoveKeys,
    /// Ask for a scene or a sky.
    ChooseBackdrop(BackdropKind),
}

impl Row<'_> {
    /// Draws the row and returns a request. `control` receives the response of the name, as its accessible label.
    pub fn show(&self, ui: &mut Ui, control: impl FnOnce(&mut Ui, &Response)) -> Option<RowRequest> {
        let mut request = None;
        let has_keys = self.key.is_some_and(|key| key.state != KeyState::None);
        let background = ui.painter().add(egui::Shape::Noop);
        let row = ui.horizontal(|ui| {
            let width = name_width(ui);
            let height = ui.spacing().interact_size.y;
            let tooltip = "Differs from the saved preset. Click to reset.";
            if mark(ui, self.is_changed.then_some(("•", tooltip)), || format!("Reset {}", display_name(self.name))) {
                request = Some(RowRequest::Reset);
            }
            if let Some(second) = self.second {
                let tooltip = second.map(|value| format!("Image B has {value}. Click to copy it."));
                let sign = tooltip.as_deref().map(|tooltip| ("≠", tooltip));
                if mark(ui, sign, || format!("Copy {} from image B", display_name(self.name))) {
                    request = Some(RowRequest::CopySecond);
                }
            }
            let label = ui.allocate_ui_with_layout(
                egui::vec2(width, height),
                egui::Layout::left_to_right(egui::Align::Center),
                |ui| {
                    ui.set_min_size(egui::vec2(width, height));
                    let text = egui::RichText::new(display_name(self.name));
                    let text = if self.reason_without_effect.is_some() { text.weak() } else { text };
                    ui.add(egui::Label::new(text).truncate().sense(egui::Sense::click()))
                },
            );
            let name = label.inner.on_hover_text(self.hint());
            let label = label.response.rect;
            if name.double_clicked() {
                request = Some(RowRequest::Reset);
            }
            name.context_menu(|ui| request = self.menu(ui).or(request));
            let is_hovered = ui.rect_contains_pointer(label);
            let mut corner = label.with_min_x(label.right() - height);
            if let Some(key) = self.key.filter(|_| has_keys || is_hovered && self.reason_without_effect.is_none()) {
                if key_mark::button(ui, corner, name.id.with("key"), key, &display_name(self.name)) {
                    request = Some(RowRequest::Key);
                }
                corner = corner.translate(egui::vec2(-height, 0.0));
            }
            if let Some(sheet) = self.sheet.filter(|_| self.reason_without_effect.is_none() && is_hovered) {
                let what = format!("{sheet}: {}", display_name(self.name));
                if icon_button::button_over(ui, corner, name.id.with(sheet), Icon::Sheet, &what).clicked() {
                    request = Some(RowRequest::Sheet);
                }
            }
            ui.add_enabled_ui(self.reason_without_effect.is_none(), |ui| control(ui, &name));
        });
        if has_keys {
            let tint = key_mark::color().gamma_multiply(0.14);
            ui.painter().set(background, egui::Shape::rect_filled(row.response.rect.expand(1.0), 2.0, tint));
        }
        request
    }

    fn menu(&self, ui: &mut Ui) -> Option<RowRequest> {
        let mut request = None;
        let mut entry = |is_on, name: &str, what| {
            if ui.add_enabled(is_on, egui::Button::new(name)).clicked() {
                request = Some(what);
                ui.close();
            }
        };
        entry(self.is_changed, "Reset", RowRequest::Reset);
        if let Some(key) = self.key {
            entry(true, &key.action(), RowRequest::Key);
            if key.state != KeyState::None {
                entry(true, "Delete All Keyframes", RowRequest::RemoveKeys);
            }
        }
        if let Some(Some(value)) = self.second {
            entry(true, &format!("Copy {value} from image B"), RowRequest::CopySecond);
        }
        if let Some(sheet) = self.sheet {
            entry(true, sheet, RowRequest::Sheet);
        }
        request
    }

    fn hint(&self) -> String {
        match self.reason_without_effect {
            Some(reason) => format!("{}\n\nNo effect now: {reason}.", self.tooltip),
            None => self.tooltip.to_owned(),
        }
    }
}

/// Draws a mark if there is one, or the empty space for it. Returns true if it was clicked. `name` is the accessible
/// name.
fn mark(ui: &mut Ui, sign: Option<(&str, &str)>, name: impl Fn() -> String) -> bool {
    let size = egui::vec2(MARK, ui.spacing().interact_size.y);
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    let label = ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        let (sign, tooltip) = sign?;
        let mark = egui::Button::new(egui::RichText::new(sign).strong()).frame(false).small();
        let mark = ui.add(mark).on_hover_text(tooltip);
        mark.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name()));
        Some(mark.clicked())
    });
    label.inner == Some(true)
}

fn name_width(ui: &Ui) -> f32 {
    NAME.min(NAME_FRACTION * ui.available_width())
}

/// Draws a note below a control. `marks`: number of marks that rows have before their names.
pub fn note(ui: &mut Ui, marks: f32, content: impl FnOnce(&mut Ui)) {
    // A line that is too long would widen a narrow panel.
    ui.horizontal_wrapped(|ui| {
        ui.add_space(marks * MARK + name_width(ui) + (marks + 1.0) * ui.spacing().item_spacing.x);
        content(ui);
    });
}
