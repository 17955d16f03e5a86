//! One row of a panel: a mark, a name, a control.

use std::fmt::Display;
use std::ops::RangeInclusive;

use eframe::egui::{self, Response, Ui};
use glam::Vec3;
use haze::settings::Choice;

/// Width of the names.
const NAME: f32 = 118.0;
/// Width of the mark before them.
const MARK: f32 = 12.0;

/// What a row says and does beside its control.
pub struct Row<'a> {
    pub name: &'a str,
    pub tooltip: &'a str,
    /// It differs from the preset on disk.
    pub is_changed: bool,
    /// Why it does nothing here.
    pub inert: Option<&'a str>,
}

impl Row<'_> {
    /// Draws the row; true if it is to be set back. `control` is handed the response of the name, for who cannot see it.
    pub fn show(&self, ui: &mut Ui, control: impl FnOnce(&mut Ui, &Response)) -> bool {
        let mut reset = false;
        ui.horizontal(|ui| {
            let height = ui.spacing().interact_size.y;
            ui.allocate_ui_with_layout(
                egui::vec2(MARK, height),
                egui::Layout::left_to_right(egui::Align::Center),
                |ui| {
                    ui.set_min_size(egui::vec2(MARK, height));
                    if self.is_changed {
                        let mark = egui::Button::new(egui::RichText::new("•").strong()).frame(false).small();
                        let mark = ui.add(mark).on_hover_text("Differs from the preset. Click to set it back.");
                        mark.widget_info(|| {
                            egui::WidgetInfo::labeled(egui::Role::Button, true, format!("set back {}", self.name))
                        });
                        reset |= mark.clicked();
                    }
                },
            );
            let name = ui
                .allocate_ui_with_layout(
                    egui::vec2(NAME, height),
                    egui::Layout::left_to_right(egui::Align::Center),
                    |ui| {
                        ui.set_min_size(egui::vec2(NAME, height));
                        let text = egui::RichText::new(spaced(self.name));
                        let text = if self.inert.is_some() { text.weak() } else { text };
                        ui.add(egui::Label::new(text).truncate().sense(egui::Sense::click()))
                    },
                )
                .inner
                .on_hover_text(self.hint());
            reset |= name.double_clicked();
            name.context_menu(|ui| {
                if ui.add_enabled(self.is_changed, egui::Button::new("Set back")).clicked() {
                    reset = true;
                    ui.close();
                }
            });
            ui.add_enabled_ui(self.inert.is_none(), |ui| control(ui, &name));
        });
        reset
    }

    fn hint(&self) -> String {
        match self.inert {
            Some(reason) => format!("{}\n\nNo effect here: {reason}.", self.tooltip),
            None => self.tooltip.to_owned(),
        }
    }
}

/// A name as it is read.
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// Widest range that a linear slider can be aimed in, and how many times its low end the high end may be.
const WIDEST_LINEAR: f32 = 40.0;
const MOST_LINEAR: f32 = 100.0;
/// Where sliders of endless ranges end; more can be typed.
const FAR: f32 = 1000.0;

/// Width of what is typed.
const VALUE: f32 = 84.0;

/// What cannot be typed is told once.
pub type Refused = Option<String>;

/// A slider for a number, and the number, which can be typed; `refused` is told what was typed in vain. True if it was changed.
pub fn number(
    ui: &mut Ui,
    name: &Response,
    value: &mut f32,
    range: &RangeInclusive<f32>,
    unit: &str,
    refused: &mut Refused,
) -> bool {
    let (low, high) = (*range.start(), *range.end());
    let shown_high = if high > FAR { FAR.max(value.abs() * 2.0).min(high) } else { high };
    let shown_low = if low < -FAR { -FAR.max(value.abs() * 2.0) } else { low };
    let is_wide = shown_high - shown_low > WIDEST_LINEAR || low > 0.0 && high > MOST_LINEAR * low;
    let control = Control {
        name,
        unit,
        shown: f64::from(shown_low)..=f64::from(shown_high),
        range: f64::from(low)..=f64::from(high),
        is_logarithmic: is_wide,
        smallest: f64::from(low.max(0.001)),
        decimals: 4,
    };
    let mut edited = f64::from(*value);
    let is_changed = control.show(ui, &mut edited, refused) && edited.is_finite();
    if is_changed {
        *value = (edited as f32).clamp(low, high);
    }
    is_changed
}

/// The same for a whole number.
pub fn integer(
    ui: &mut Ui,
    name: &Response,
    value: &mut u32,
    range: &RangeInclusive<u32>,
    unit: &str,
    refused: &mut Refused,
) -> bool {
    let (low, high) = (*range.start(), *range.end());
    let range = f64::from(low)..=f64::from(high);
    let control = Control {
        name,
        unit,
        shown: range.clone(),
        is_logarithmic: range.end() / range.start().max(1.0) > 100.0,
        range,
        smallest: 1.0,
        decimals: 0,
    };
    let mut edited = f64::from(*value);
    let is_changed = control.show(ui, &mut edited, refused);
    if is_changed {
        *value = (edited.round() as u32).clamp(low, high);
    }
    is_changed
}

/// A slider with its number beside it.
struct Control<'a> {
    name: &'a Response,
    unit: &'a str,
    /// What the slider reaches.
    shown: RangeInclusive<f64>,
    /// What may be typed.
    range: RangeInclusive<f64>,
    is_logarithmic: bool,
    /// The smallest that a logarithmic slider tells from 0.
    smallest: f64,
    decimals: usize,
}

impl Control<'_> {
    /// True if the value was changed.
    fn show(&self, ui: &mut Ui, value: &mut f64, refused: &mut Refused) -> bool {
        let height = ui.spacing().interact_size.y;
        ui.spacing_mut().slider_width = (ui.available_width() - VALUE - ui.spacing().item_spacing.x).max(16.0);
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
            ui.add_sized([VALUE.min(ui.available_width()), height], number).labelled_by(self.name.id).changed();
        if let Some(text) = typed.into_inner() {
            *refused = Some(refusal(&text, *self.range.start(), *self.range.end(), self.unit));
            *value = before;
            return false;
        }
        is_slid || is_typed
    }
}

/// What is said of a text that is no number of a range.
fn refusal(text: &str, low: impl Display, high: impl Display, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    format!("{text:?} is not valid; expected {low} to {high}{space}{unit}")
}

/// Three numbers beside each other; `refused` is told what was typed in vain.
pub fn vector(
    ui: &mut Ui,
    value: &mut Vec3,
    range: &RangeInclusive<f32>,
    unit: &str,
    name: &Response,
    refused: &mut Refused,
) {
    let (low, high) = (*range.start(), *range.end());
    let width = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
    let mut axes = value.to_array();
    for (axis, label) in axes.iter_mut().zip(["x", "y", "z"]) {
        let (before, typed) = (*axis, std::cell::RefCell::new(None));
        let drag = egui::DragValue::new(axis)
            .speed(0.02)
            .range(low..=high)
            .max_decimals(3)
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

/// Linear RGB and its numbers.
pub fn colour(ui: &mut Ui, value: &mut Vec3, name: &Response) {
    swatch(ui, value).labelled_by(name.id);
    let [r, g, b] = value.to_array();
    ui.add(egui::Label::new(egui::RichText::new(format!("{r:.3} {g:.3} {b:.3}")).weak()).truncate());
}

/// Linear RGB, which may be brighter than 1: the button shows its hue.
pub fn swatch(ui: &mut Ui, value: &mut Vec3) -> Response {
    let peak = value.max_element().max(1.0);
    let mut shown = (*value / peak).to_array();
    let button = ui.color_edit_button_rgb(&mut shown);
    if button.changed() {
        *value = Vec3::from(shown) * peak;
    }
    button
}

/// One of a few; `tooltip` tells what each means.
pub fn choice<'t>(
    ui: &mut Ui,
    value: &mut dyn Choice,
    salt: &str,
    tooltip: impl Fn(&str) -> Option<&'t str>,
) -> Response {
    let names = value.names();
    let mut index = value.index();
    let selected = spaced(names.get(index).copied().unwrap_or_default());
    let combo = egui::ComboBox::from_id_salt(salt).selected_text(selected).width(ui.available_width() - 8.0);
    let response = combo
        .show_ui(ui, |ui| {
            for (place, name) in names.iter().enumerate() {
                let entry = ui.selectable_value(&mut index, place, spaced(name));
                if let Some(tooltip) = tooltip(name) {
                    entry.on_hover_text(tooltip);
                }
            }
        })
        .response;
    value.set_index(index);
    response
}

/// A number as it is read: four digits that count, no zeros after them.
fn shown(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 4) as usize };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

fn suffix(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "degrees" => "°".into(),
        unit => format!(" {unit}"),
    }
}

/// A number as it is typed, with its unit or without; never infinite, never NaN.
fn parse(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit).or(text.strip_suffix('°')).unwrap_or(text).trim();
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use egui_kittest::kittest::Queryable as _;

    use super::*;

    #[test]
    fn numbers_are_shown_without_noise() {
        for (value, text) in [
            (0.0, "0"),
            (34.0, "34"),
            (0.05, "0.05"),
            (1.0 / 3.0, "0.3333"),
            (-2.5, "-2.5"),
            (12345.6, "12346"),
            (-1.0e-6, "0"),
        ] {
            assert_eq!(shown(value), text);
        }
    }

    #[test]
    fn numbers_are_typed_with_their_unit_or_without() {
        assert_eq!(parse(" 2.5 m/s ", "m/s"), Some(2.5));
        assert_eq!(parse("1e-3", ""), Some(0.001));
        assert_eq!((parse("35°", "degrees"), parse("35 degrees", "degrees")), (Some(35.0), Some(35.0)));
        for wrong in ["nan", "inf", "2,5", "", "m/s", "two"] {
            assert_eq!(parse(wrong, "m/s"), None, "{wrong}");
        }
    }

    #[test]
    fn what_is_typed_in_vain_into_three_numbers_is_said_and_changes_nothing() {
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
