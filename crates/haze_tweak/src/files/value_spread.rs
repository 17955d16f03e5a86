//! Values of a field for a sheet of variations.

use std::ops::RangeInclusive;

use glam::Vec3;
use haze_core::settings::{Choice, FieldVisitor, Fields, field_path};
use haze_preset::Preset;

use crate::session::macro_param::MacroParam;
use crate::session::slider_range::{needs_log_slider, slider_range};

/// Name on the path to a field, with an index if it is in a list.
type Step = (&'static str, Option<usize>);

/// Returns values of a field as texts. For a number, five values over the range of its slider, or from a quarter to
/// four times its value if that range is too wide. For a choice, all choices; for a flag, both states. Empty for other
/// fields.
pub fn spread_values(preset: &Preset, path: &str) -> Vec<String> {
    if let Some((_, made)) = MacroParam::find(path) {
        let (low, high) = made.usual;
        return five_values(low, low, high, false).map(text).into();
    }
    let mut visitor = ValueSpread { wanted: path, path: Vec::new(), texts: Vec::new() };
    preset.clone().visit(&mut visitor);
    visitor.texts
}

struct ValueSpread<'a> {
    wanted: &'a str,
    path: Vec<Step>,
    texts: Vec<String>,
}

impl ValueSpread<'_> {
    fn offer(&mut self, name: &'static str, texts: impl IntoIterator<Item = String>) {
        self.path.push((name, None));
        if field_path(&self.path) == self.wanted {
            self.texts = texts.into_iter().collect();
            self.texts.dedup();
        }
        self.path.pop();
    }

    fn enter(&mut self, step: Step, fields: &mut dyn Fields) {
        self.path.push(step);
        fields.visit(self);
        self.path.pop();
    }
}

/// Positions of the five values in the range, 0 to 1.
const PLACES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

fn five_values(value: f32, low: f32, high: f32, needs_log_slider: bool) -> [f32; 5] {
    /// Values for a field that is 0.
    const STEPS: [f32; 5] = [0.0, 0.25, 0.5, 1.0, 2.0];
    if !needs_log_slider {
        return PLACES.map(|position| low + position * (high - low));
    }
    let size = value.abs();
    if size < 1.0e-6 {
        return STEPS.map(|step| step.clamp(low, high));
    }
    let (low, high) = if value < 0.0 { (-high, -low) } else { (low, high) };
    let least = (0.25 * size).max(low);
    let most = (4.0 * size).min(high);
    PLACES.map(|position| (least * (most / least).powf(position)).copysign(value))
}

/// Formats a number with four significant digits.
fn text(number: f32) -> String {
    format!("{number:.3e}").parse::<f32>().unwrap_or(number).to_string()
}

impl FieldVisitor for ValueSpread<'_> {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, unit: &'static str) {
        let (shown, needs_log_slider) = slider_range(&range, unit, *value);
        let (low, high) = if needs_log_slider { range.into_inner() } else { shown.into_inner() };
        self.offer(name, five_values(*value, low, high, needs_log_slider).map(text));
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        let low = *range.start() as f32;
        let high = *range.end() as f32;
        self.offer(
            name,
            five_values(*value as f32, low, high, needs_log_slider(&range)).map(|number| number.round().to_string()),
        );
    }

    fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}

    fn flag(&mut self, name: &'static str, _: &mut bool) {
        self.offer(name, ["false".into(), "true".into()]);
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        self.offer(name, value.names().iter().map(|name| (*name).to_owned()));
    }

    fn seed(&mut self, name: &'static str, value: &mut u32) {
        self.offer(name, (0..5).map(|more| value.wrapping_add(more).to_string()));
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.enter((name, None), fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.enter((name, Some(index)), fields);
    }
}
