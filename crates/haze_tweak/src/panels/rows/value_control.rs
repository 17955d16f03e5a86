//! Controls of a row: slider with number, color, choice.

use std::fmt::Display;
use std::ops::RangeInclusive;

use eframe::egui::{self, Response, Ui};
use glam::Vec3;
use haze_core::settings::Choice;

use super::color_popup::swatch;
use super::value_text::{parse, shown, suffix};
use crate::document::display_names::display_name;
use crate::session::slider_range::{UsualRange, needs_log_slider, slider_range};

/// Least width of the number field, points.
const VALUE: f32 = 84.0;

/// Reason why typed text was refused.
pub type Refused = Option<String>;

/// Draws a slider and a number field. `refused` is set if typed text is not valid. Returns true if the value was
/// changed.
pub fn number(
    ui: &mut Ui,
    name: &Response,
    value: &mut f32,
    range: &RangeInclusive<f32>,
    usual: UsualRange,
    unit: &str,
    refused: &mut Refused,
) -> bool {
    let low = *range.start();
    let high = *range.end();
    let (shown, needs_log_slider) =
        usual.map_or_else(|| slider_range(range, unit, *value), |(low, high)| (low..=high, false));
    let slider = ValueSlider {
        name,
        unit,
        shown: f64::from(*shown.start())..=f64::from(*shown.end()),
        range: f64::from(low)..=f64::from(high),
        is_logarithmic: needs_log_slider,
        smallest: f64::from(low.max(0.001)),
        decimals: 4,
    };
    let mut edited = f64::from(*value);
    let is_changed = slider.show(ui, &mut edited, refused) && edited.is_finite();
    if is_changed {
        *value = (edited as f32).clamp(low, high);
    }
    is_changed
}

/// Draws a slider and a number field for an integer, like [`number`].
pub fn integer(
    ui: &mut Ui,
    name: &Response,
    value: &mut u32,
    whole: &RangeInclusive<u32>,
    unit: &str,
    refused: &mut Refused,
) -> bool {
    let low = *whole.start();
    let high = *whole.end();
    let range = f64::from(low)..=f64::from(high);
    let slider = ValueSlider {
        name,
        unit,
        shown: range.clone(),
        is_logarithmic: needs_log_slider(whole),
        range,
        smallest: 1.0,
        decimals: 0,
    };
    let mut edited = f64::from(*value);
    let is_changed = slider.show(ui, &mut edited, refused);
    if is_changed {
        *value = (edited.round() as u32).clamp(low, high);
    }
    is_changed
}

/// Slider with a number field.
struct ValueSlider<'a> {
    name: &'a Response,
    unit: &'a str,
    /// Range of the slider.
    shown: RangeInclusive<f64>,
    /// Valid range; also applies to typed numbers.
    range: RangeInclusive<f64>,
    is_logarithmic: bool,
    /// Smallest value that a logarithmic slider distinguishes from 0.
    smallest: f64,
    decimals: usize,
}

impl ValueSlider<'_> {
    /// Returns true if the value was changed.
    fn show(&self, ui: &mut Ui, value: &mut f64, refused: &mut Refused) -> bool {
        let height = ui.spacing().interact_size.y;
        // A wider row would widen the panel in every frame.
        let font = egui::TextStyle::Button.resolve(ui.style());
        let text = shown(*value) + &suffix(self.unit);
        let text = ui.painter().layout_no_wrap(text, font, egui::Color32::WHITE).size().x;
        let width = VALUE.max(text + 2.0 * ui.spacing().button_padding.x);
        ui.spacing_mut().slider_width = (ui.available_width() - width - ui.spacing().item_spacing.x).max(16.0);
        let before = *value;
        let slider = egui::Slider::new(value, self.shown.clone())
            .logarithmic(self.is_logarithmic)
            .smallest_positive(self.smallest)
            .clamping(egui::SliderClamping::Never)
            .show_value(false);
        let slider = if self.decimals == 0 { slider.integer() } else { slider };
        let is_slid = ui.add(slider).labelled_by(self.name.id).changed();
        let typed = std::cell::RefCell::new(None);
        let number = egui::DragValue::new(value)
            .speed(if self.decimals == 0 { 0.1 } else { before.abs().max(0.1) * 0.005 })
            .max_decimals(self.decimals)
            .suffix(suffix(self.unit))
            .update_while_editing(false)
            .custom_formatter(|value, _| shown(value))
            .custom_parser(|text| {
                let number = parse(text, self.unit).filter(|number| self.range.contains(number));
                if number.is_none() {
                    *typed.borrow_mut() = Some(text.to_owned());
                }
                number
            });
        let is_typed =
            ui.add_sized([width.min(ui.available_width()), height], number).labelled_by(self.name.id).changed();
        if let Some(text) = typed.into_inner() {
            *refused = Some(refusal(&text, *self.range.start(), *self.range.end(), self.unit));
            *value = before;
            return false;
        }
        is_slid || is_typed
    }
}

/// Returns the message for text that is no number in the range.
fn refusal(text: &str, low: impl Display, high: impl Display, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    format!("{text:?} is not valid; expected {low} to {high}{space}{unit}")
}

/// Draws three number fields side by side. `refused` is set if typed text is not valid.
pub fn vector(
    ui: &mut Ui,
    value: &mut Vec3,
    range: &RangeInclusive<f32>,
    unit: &str,
    name: &Response,
    refused: &mut Refused,
) {
    let low = *range.start();
    let high = *range.end();
    let width = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
    if width < ui.spacing().interact_size.x {
        ui.spacing_mut().interact_size.x = width;
        ui.spacing_mut().button_padding.x = 2.0;
    }
    let mut axes = value.to_array();
    let decimals = decimals_that_fit(ui, &axes, width);
    for (axis, label) in axes.iter_mut().zip(["x", "y", "z"]) {
        let before = *axis;
        let typed = std::cell::RefCell::new(None);
        let drag = egui::DragValue::new(axis)
            .speed(0.02)
            .range(low..=high)
            .max_decimals(decimals)
            .update_while_editing(false)
            .custom_parser(|text| {
                let number = parse(text, unit).filter(|number| range.contains(&(*number as f32)));
                if number.is_none() {
                    *typed.borrow_mut() = Some(text.to_owned());
                }
                number
            });
        let drag =
            ui.add_sized([width, ui.spacing().interact_size.y], drag).on_hover_text(format!("{label}{}", suffix(unit)));
        drag.labelled_by(name.id);
        if let Some(text) = typed.into_inner() {
            *refused = Some(refusal(&text, low, high, unit));
            *axis = before;
        }
    }
    let edited = Vec3::from(axes);
    if edited.is_finite() {
        *value = edited;
    }
}

/// Returns the number of decimals, at most three, with which numbers fit into fields of a width. A wider row would widen the
/// panel. Narrows the padding of the fields if it must.
fn decimals_that_fit(ui: &mut Ui, numbers: &[f32], width: f32) -> usize {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let widest = |decimals: usize| {
        let text = |number: &f32| {
            ui.painter().layout_no_wrap(format!("{number:.decimals$}"), font.clone(), egui::Color32::WHITE)
        };
        numbers.iter().map(|number| text(number).size().x).fold(0.0, f32::max)
    };
    let widths = [0, 1, 2, 3].map(widest);
    let fits = |padding: f32| (0..=3).rev().find(|&decimals| widths[decimals] + 2.0 * padding <= width);
    if let Some(3) = fits(ui.spacing().button_padding.x) {
        return 3;
    }
    ui.spacing_mut().button_padding.x = 2.0;
    fits(2.0).unwrap_or(0)
}

/// Draws a linear RGB color as a swatch and as numbers.
pub fn color(ui: &mut Ui, value: &mut Vec3, range: &RangeInclusive<f32>, name: &Response) {
    swatch(ui, value, range).labelled_by(name.id);
    let [r, g, b] = value.to_array();
    ui.add(egui::Label::new(egui::RichText::new(format!("{r:.3} {g:.3} {b:.3}")).weak()).truncate());
}

/// Draws the field of a file path. The path is used when the field loses focus, not after each letter; Escape discards
/// it.
pub fn path(ui: &mut Ui, value: &mut String, salt: &str, hint: &str) -> Response {
    let id = ui.make_persistent_id(salt);
    let mut typed = ui.data(|data| data.get_temp(id)).unwrap_or_else(|| value.clone());
    let edit = egui::TextEdit::singleline(&mut typed).id(id).hint_text(hint).desired_width(f32::INFINITY);
    let response = ui.add(edit);
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, typed));
        return response;
    }
    if response.lost_focus() && !ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        typed.trim().clone_into(value);
    }
    ui.data_mut(|data| data.remove::<String>(id));
    response
}

/// Draws a choice. `tooltip` returns the description of a choice.
pub fn choice<'t>(
    ui: &mut Ui,
    value: &mut dyn Choice,
    salt: &str,
    tooltip: impl Fn(&str) -> Option<&'t str>,
) -> Response {
    let names = value.names();
    let mut index = value.index();
    let selected = display_name(names.get(index).copied().unwrap_or_default());
    let combo = egui::ComboBox::from_id_salt(salt).selected_text(selected).width(ui.available_width() - 8.0);
    let response = combo
        .show_ui(ui, |ui| {
            for (position, name) in names.iter().enumerate() {
                let entry = ui.selectable_value(&mut index, position, display_name(name));
                if let Some(tooltip) = tooltip(name) {
                    entry.on_hover_text(tooltip);
                }
            }
        })
        .response;
    value.set_index(index);
    response
}

#[cfg(test)]
mod tests {
    use egui_kittest::kittest::Queryable as _;

    use super::*;

    #[test]
    fn a_path_is_used_when_its_field_loses_focus() {
        let row = |ui: &mut Ui, value: &mut String| {
            let name = ui.label("path");
            path(ui, value, "row", "").labelled_by(name.id);
        };
        let mut harness = egui_kittest::Harness::new_ui_state(row, String::new());
        for (key, expected) in
            [(egui::Key::Enter, "s.ply"), (egui::Key::Escape, "s.ply"), (egui::Key::Enter, "s.plys.ply")]
        {
            let before = harness.state().clone();
            harness.get_by_role(egui::Role::TextInput).click();
            harness.run();
            harness.event(egui::Event::Text("s.ply".into()));
            harness.run();
            assert_eq!(*harness.state(), before);
            harness.key_press(key);
            harness.run();
            assert_eq!(*harness.state(), expected);
        }
    }

    #[test]
    fn invalid_text_in_a_vector_field_is_reported_and_changes_nothing() {
        let row = |ui: &mut Ui, (value, refused): &mut (Vec3, Refused)| {
            let name = ui.label("wind");
            vector(ui, value, &(-10.0..=10.0), "m/s", &name, refused);
        };
        let mut harness = egui_kittest::Harness::new_ui_state(row, (Vec3::ONE, None));
        for (text, expected) in
            [("two", Vec3::ONE), ("nan", Vec3::ONE), ("11", Vec3::ONE), ("2 m/s", Vec3::new(2.0, 1.0, 1.0))]
        {
            harness.get_all_by_role(egui::Role::SpinButton).next().unwrap().click();
            harness.run();
            harness.event(egui::Event::Text(text.into()));
            harness.run();
            harness.key_press(egui::Key::Enter);
            harness.run();
            let (value, refused) = harness.state_mut();
            let said = refused.take().unwrap_or_default();
            assert_eq!(*value, expected);
            let wanted = format!("{text:?} is not valid; expected -10 to 10 m/s");
            assert_eq!(said, if expected == Vec3::ONE { wanted } else { String::new() });
        }
    }
}
