//! Curve of a track: its values over time, with keyframes that are dragged.

use std::ops::RangeInclusive;

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, pos2};
use haze_core::settings::{FieldValue, field_values};
use haze_preset::{KeyValue, Track};

use super::time_axis::TimeAxis;
use crate::document::keyframes::{self, clamped, move_key, track_mut};
use crate::panels::rows::key_mark::color;
use crate::panels::rows::value_text::shown_value;
use crate::session::Session;

/// Distance at which the pointer is on a point, points.
const REACH: f32 = 10.0;
const RADIUS: f32 = 3.5;
/// Width of a straight piece of the curve.
const STEP: f32 = 3.0;
/// Colors of the components of vectors and colors.
const COMPONENTS: [Color32; 3] =
    [Color32::from_rgb(226, 82, 82), Color32::from_rgb(104, 178, 62), Color32::from_rgb(86, 140, 236)];

/// Point that is pressed or dragged.
#[derive(Clone)]
struct Dragged {
    key: usize,
    component: usize,
    /// Scale of the plot, which stays meanwhile.
    span: RangeInclusive<f32>,
    /// From the pointer to the point, when it was pressed.
    offset: Vec2,
}

/// Draws the curve of a track and changes it.
pub fn curve(ui: &mut Ui, session: &mut Session, setting: &str, axis: &TimeAxis, height: f32) {
    let Some(track) = keyframes::track(&session.document.preset, setting).cloned() else { return };
    let (rect, response) = ui.allocate_exact_size(egui::vec2(axis.width, height), Sense::click_and_drag());
    let name = format!("Curve of {setting}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let count = (axis.width / STEP).ceil().max(2.0) as usize;
    let times: Vec<_> =
        (0..=count).map(|index| axis.time(axis.left + index as f32 * axis.width / count as f32)).collect();
    let values = |has_flicker| session.document.preset.track_values(&track, has_flicker, &times);
    let steady = values(false);
    let flickering = if track.flicker.amount > 0.0 { values(true) } else { Vec::new() };
    let of_choices = choices(&session.document.preset, setting);
    let numbers = |value: &KeyValue| components(value, &of_choices);
    let dragged_id = response.id.with("dragged");
    let dragged: Option<Dragged> = ui.data(|data| data.get_temp(dragged_id));
    let all = steady.iter().chain(&flickering).chain(track.keys.iter().map(|key| &key.value));
    let span = dragged.as_ref().map_or_else(|| span(all.flat_map(&numbers)), |dragged| dragged.span.clone());
    let plot = Plot { rect, axis, span };
    let (pointer, is_pressed) = ui.input(|input| (input.pointer.interact_pos(), input.pointer.primary_down()));
    let begun = pointer.filter(|_| is_pressed && response.is_pointer_button_down_on());
    match begun.and_then(|at| dragged.or_else(|| plot.nearest(&track, at, &numbers))) {
        Some(dragged) => {
            // A press alone moves nothing.
            let is_moved = ui.input(|input| {
                let origin = input.pointer.press_origin();
                input.pointer.is_decidedly_dragging() && origin != input.pointer.interact_pos()
            });
            if let Some(at) = begun.filter(|_| is_moved).map(|at| at + dragged.offset) {
                drag(session, setting, &dragged, axis.time(at.x), plot.value(at.y));
            }
            ui.data_mut(|data| data.insert_temp(dragged_id, dragged));
        }
        None => ui.data_mut(|data| data.remove::<Dragged>(dragged_id)),
    }
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    plot.paint(ui, &times, &flickering, 0.35, &numbers);
    plot.paint(ui, &times, &steady, 1.0, &numbers);
    plot.marks(ui, &track, response.hover_pos(), &numbers);
    let here = session.document.preset.track_values(&track, false, &[axis.now]);
    let here = here.first().map(|value| shown(value, &of_choices)).unwrap_or_default();
    response.on_hover_text(format!("{here} at {:.2} s\n\nDrag a point to change its value and its time.", axis.now));
}

/// Moves a keyframe, and sets one component of its value.
fn drag(session: &mut Session, setting: &str, dragged: &Dragged, time: f32, number: f32) {
    let index = dragged.key;
    let preset = &mut session.document.preset;
    let Some(key) = keyframes::track(preset, setting).and_then(|track| track.keys.get(index)) else { return };
    let wanted = match &key.value {
        KeyValue::Number(_) => Some(KeyValue::Number(number)),
        KeyValue::Vector(vector) => {
            let mut vector = *vector;
            vector[dragged.component.min(2)] = number;
            Some(KeyValue::Vector(vector))
        }
        // Switches and choices move in time only.
        _ => None,
    };
    let value = wanted.map(|value| clamped(preset, setting, value));
    if let Some(track) = track_mut(preset, setting) {
        move_key(track, index, time);
        track.keys[index].value = value.unwrap_or_else(|| track.keys[index].value.clone());
    }
}

/// Names of the choices of a setting; empty for other settings.
fn choices(preset: &haze_preset::Preset, setting: &str) -> Vec<String> {
    let value = field_values(preset).into_iter().find(|(path, _)| path == setting);
    let Some((_, FieldValue::Choice(_))) = value else { return Vec::new() };
    let track = keyframes::track(preset, setting);
    let mut names: Vec<String> = Vec::new();
    for key in track.into_iter().flat_map(|track| &track.keys) {
        match &key.value {
            KeyValue::Choice(name) if !names.contains(name) => names.push(name.clone()),
            _ => {}
        }
    }
    names
}

/// Numbers of a value: its components, 0 and 1 of a switch, the index of a choice.
fn components(value: &KeyValue, choices: &[String]) -> Vec<f32> {
    match value {
        KeyValue::Number(number) => vec![*number],
        KeyValue::Vector(vector) => vector.to_array().into(),
        KeyValue::Flag(flag) => vec![if *flag { 1.0 } else { 0.0 }],
        KeyValue::Choice(name) => vec![choices.iter().position(|other| other == name).unwrap_or_default() as f32],
    }
}

fn shown(value: &KeyValue, choices: &[String]) -> String {
    match value {
        KeyValue::Number(number) => shown_value(&FieldValue::Number(*number), ""),
        KeyValue::Vector(vector) => shown_value(&FieldValue::Vector(*vector), ""),
        KeyValue::Flag(flag) => shown_value(&FieldValue::Flag(*flag), ""),
        _ => components(value, choices)
            .first()
            .and_then(|index| choices.get(*index as usize))
            .cloned()
            .unwrap_or_default(),
    }
}

/// Range of the plot around all values.
fn span(values: impl Iterator<Item = f32>) -> RangeInclusive<f32> {
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return 0.0..=1.0;
    }
    let margin = if high - low > 1.0e-6 { 0.08 * (high - low) } else { 0.5 * low.abs().max(1.0) };
    low - margin..=high + margin
}

struct Plot<'a> {
    rect: Rect,
    axis: &'a TimeAxis,
    span: RangeInclusive<f32>,
}

impl Plot<'_> {
    fn position(&self, time: f32, value: f32) -> Pos2 {
        let fraction = (value - self.span.start()) / (self.span.end() - self.span.start()).max(1.0e-9);
        pos2(self.axis.x(time), self.rect.bottom() - fraction * self.rect.height())
    }

    /// Value at a height, rounded to a thousandth of the plot.
    fn value(&self, y: f32) -> f32 {
        let height = self.span.end() - self.span.start();
        let value = self.span.start() + (self.rect.bottom() - y) / self.rect.height() * height;
        let unit = 10.0_f32.powf((height.max(1.0e-6) / 1000.0).log10().floor());
        (value / unit).round() * unit
    }

    fn nearest(&self, track: &Track, at: Pos2, numbers: &dyn Fn(&KeyValue) -> Vec<f32>) -> Option<Dragged> {
        let points = track.keys.iter().enumerate().flat_map(|(index, key)| {
            let positions = numbers(&key.value).into_iter().map(|value| self.position(key.time, value));
            positions
                .enumerate()
                .map(move |(component, position)| (index, component, position - at))
                .collect::<Vec<_>>()
        });
        let nearest = points.min_by(|a, b| a.2.length().total_cmp(&b.2.length()));
        let (key, component, offset) = nearest.filter(|(.., offset)| offset.length() <= REACH)?;
        Some(Dragged { key, component, span: self.span.clone(), offset })
    }

    /// Draws a line for each component.
    fn paint(
        &self,
        ui: &Ui,
        times: &[f32],
        values: &[KeyValue],
        opacity: f32,
        numbers: &dyn Fn(&KeyValue) -> Vec<f32>,
    ) {
        let painter = ui.painter_at(self.rect);
        let values: Vec<_> = values.iter().map(numbers).collect();
        let count = values.first().map_or(0, Vec::len);
        for component in 0..count {
            let points = times.iter().zip(&values).map(|(time, value)| self.position(*time, value[component]));
            let stroke = Stroke::new(1.5, self.color(ui, component, count).gamma_multiply(opacity));
            painter.add(Shape::line(points.collect(), stroke));
        }
    }

    fn color(&self, ui: &Ui, component: usize, count: usize) -> Color32 {
        if count == 1 { ui.visuals().text_color() } else { COMPONENTS[component.min(2)] }
    }

    /// Draws the keyframes, the time of the playback, and the range of the values.
    fn marks(&self, ui: &Ui, track: &Track, hover: Option<Pos2>, numbers: &dyn Fn(&KeyValue) -> Vec<f32>) {
        let painter = ui.painter_at(self.rect);
        let now = self.axis.x(self.axis.now);
        painter.vline(now, self.rect.y_range(), Stroke::new(1.0, ui.visuals().selection.stroke.color));
        for key in &track.keys {
            for value in numbers(&key.value) {
                let position = self.position(key.time, value);
                let is_near = hover.is_some_and(|at| at.distance(position) <= REACH);
                painter.circle_filled(position, if is_near { RADIUS + 1.5 } else { RADIUS }, color());
            }
        }
        if track.keys.iter().any(|key| matches!(key.value, KeyValue::Number(_) | KeyValue::Vector(_))) {
            let font = egui::TextStyle::Small.resolve(ui.style());
            let faint = ui.visuals().weak_text_color();
            for (corner, align, value) in [
                (self.rect.left_top(), egui::Align2::LEFT_TOP, self.span.end()),
                (self.rect.left_bottom(), egui::Align2::LEFT_BOTTOM, self.span.start()),
            ] {
                let text = shown_value(&FieldValue::Number(*value), "");
                let inside = egui::vec2(3.0, if align == egui::Align2::LEFT_TOP { 1.0 } else { -1.0 });
                painter.text(corner + inside, align, text, font.clone(), faint);
            }
        }
    }
}
