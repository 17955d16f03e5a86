//! Editor of a curve: points that are dragged, added by a click and removed by a right-click.

use std::ops::RangeInclusive;

use eframe::egui::{self, Pos2, Response, Sense, Stroke, Ui, Vec2, pos2};
use haze_core::settings::{Curve, MAX_CURVE_POINTS};

const HEIGHT: f32 = 64.0;
/// Distance at which the pointer is on a point, points of the screen.
const REACH: f32 = 10.0;
const RADIUS: f32 = 4.0;
/// Least distance between two points, as a fraction of the width.
const GAP: f32 = 0.005;
/// Highest values of the plot.
const TOPS: [f32; 5] = [1.0, 2.0, 4.0, 8.0, f32::INFINITY];

const HINT: &str = "Drag a point, click to add one, right-click to remove one. Left: the beginning. Right: the end.";

/// Draws the curve and changes it.
pub fn curve(ui: &mut Ui, value: &mut Curve, range: &RangeInclusive<f32>, name: &Response) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), HEIGHT), Sense::click_and_drag());
    let mut response = response.labelled_by(name.id);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, value.to_string()));
    let highest = value.max_value();
    let dragged_id = response.id.with("dragged");
    // The scale stays while a point is dragged, or the point would run away.
    let dragged: Option<(usize, f32)> = ui.data(|data| data.get_temp(dragged_id));
    let fitting = TOPS.into_iter().find(|top| highest < *top).unwrap_or(highest).min(*range.end());
    let plot = Plot { rect: rect.shrink(RADIUS + 1.0), top: dragged.map_or(fitting, |(_, top)| top) };

    let (pointer, is_pressed) = ui.input(|input| (input.pointer.interact_pos(), input.pointer.primary_down()));
    let mut points = value.points().to_vec();
    if let Some(at) = pointer.filter(|_| response.secondary_clicked()) {
        if let Some(index) = plot.nearest(&points, at).filter(|_| points.len() > 1) {
            points.remove(index);
        }
    } else if let Some(at) = pointer.filter(|_| is_pressed && response.is_pointer_button_down_on()) {
        let index = dragged.map(|(index, _)| index).or_else(|| plot.nearest(&points, at));
        let index = index.or_else(|| insert(&mut points, plot.point(at, range)));
        if let Some(index) = index.filter(|index| *index < points.len()) {
            let low = if index > 0 { points[index - 1].x + GAP } else { 0.0 };
            let high = points.get(index + 1).map_or(1.0, |next| next.x - GAP);
            let point = plot.point(at, range);
            points[index] = glam::Vec2::new(point.x.min(high).max(low), point.y);
            ui.data_mut(|data| data.insert_temp(dragged_id, (index, plot.top)));
        }
    } else {
        ui.data_mut(|data| data.remove::<(usize, f32)>(dragged_id));
    }
    // Points that are too close to each other leave the curve as it is.
    if let Ok(changed) = Curve::new(&points)
        && changed != *value
    {
        *value = changed;
        response.mark_changed();
    }
    paint(ui, &plot, value, response.hover_pos());
    response.on_hover_text(format!("{HINT}\n{value}"))
}

/// Adds a point where there is room for one. Returns its index.
fn insert(points: &mut Vec<glam::Vec2>, point: glam::Vec2) -> Option<usize> {
    let index = points.partition_point(|other| other.x < point.x);
    let is_free = points.iter().all(|other| (other.x - point.x).abs() >= GAP);
    (points.len() < MAX_CURVE_POINTS && is_free).then(|| {
        points.insert(index, point);
        index
    })
}

/// Place of the curve on the screen.
struct Plot {
    rect: egui::Rect,
    /// Value at the upper side.
    top: f32,
}

impl Plot {
    fn position(&self, point: glam::Vec2) -> Pos2 {
        let height = (point.y / self.top.max(1.0e-6)).min(1.0);
        pos2(self.rect.left() + point.x * self.rect.width(), self.rect.bottom() - height * self.rect.height())
    }

    fn point(&self, at: Pos2, range: &RangeInclusive<f32>) -> glam::Vec2 {
        let age = (at.x - self.rect.left()) / self.rect.width().max(1.0);
        let value = (self.rect.bottom() - at.y) / self.rect.height() * self.top;
        // Two digits are as fine as a pixel.
        let value = (value * 100.0).round() / 100.0;
        glam::Vec2::new((age.clamp(0.0, 1.0) * 1000.0).round() / 1000.0, value.clamp(*range.start(), *range.end()))
    }

    fn nearest(&self, points: &[glam::Vec2], at: Pos2) -> Option<usize> {
        let distance = |index: &usize| self.position(points[*index]).distance(at);
        (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|index| distance(index) <= REACH)
    }
}

fn paint(ui: &Ui, plot: &Plot, value: &Curve, hover: Option<Pos2>) {
    let visuals = ui.visuals();
    let faint = visuals.weak_text_color();
    let ink = visuals.text_color();
    let painter = ui.painter();
    let frame = plot.rect.expand(RADIUS + 1.0);
    painter.rect_filled(frame, 2.0, visuals.extreme_bg_color);
    let line = |value: f32| plot.position(glam::Vec2::new(0.0, value)).y;
    painter.hline(plot.rect.x_range(), line(1.0), Stroke::new(1.0, faint.gamma_multiply(0.4)));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let top = format!("{}", plot.top);
    painter.text(frame.right_top() + Vec2::new(-3.0, 2.0), egui::Align2::RIGHT_TOP, top, font, faint);
    let positions: Vec<Pos2> = value.points().iter().map(|point| plot.position(*point)).collect();
    let (Some(first), Some(last)) = (positions.first(), positions.last()) else { return };
    let ends = [pos2(plot.rect.left(), first.y), pos2(plot.rect.right(), last.y)];
    let along = [&ends[..1], &positions, &ends[1..]].concat();
    painter.add(egui::Shape::line(along, Stroke::new(1.5, ink)));
    for position in positions {
        let is_near = hover.is_some_and(|at| at.distance(position) <= REACH);
        let color = if is_near { visuals.selection.bg_fill } else { ink };
        painter.circle_filled(position, if is_near { RADIUS + 1.0 } else { RADIUS }, color);
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;

    use super::*;

    fn harness(value: Curve) -> Harness<'static, Curve> {
        Harness::builder().with_size(Vec2::new(220.0, 120.0)).build_ui_state(
            |ui, value: &mut Curve| {
                let name = ui.label("Size curve");
                curve(ui, value, &(0.0..=10.0), &name);
            },
            value,
        )
    }

    fn press(harness: &mut Harness<'_, Curve>, at: Pos2, button: egui::PointerButton, pressed: bool) {
        let modifiers = egui::Modifiers::NONE;
        harness.event(egui::Event::PointerMoved(at));
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        // A longer press is no click.
        harness.step();
    }

    #[test]
    fn points_are_dragged_added_and_removed() {
        let mut harness = harness("0:1,1:1".parse().unwrap());
        let image = harness.get_by_role(egui::Role::Image).rect();
        let middle = image.center();
        // A click adds a point, and a drag in one go moves it.
        press(&mut harness, middle, egui::PointerButton::Primary, true);
        harness.event(egui::Event::PointerMoved(middle + Vec2::new(0.0, image.height())));
        harness.run();
        press(&mut harness, middle + Vec2::new(0.0, image.height()), egui::PointerButton::Primary, false);
        assert_eq!(harness.state().to_string(), "0:1,0.5:0,1:1");
        // The first point cannot pass the second.
        press(&mut harness, pos2(image.left() + RADIUS + 1.0, middle.y), egui::PointerButton::Primary, true);
        harness.event(egui::Event::PointerMoved(pos2(image.right(), middle.y)));
        harness.run();
        press(&mut harness, pos2(image.right(), middle.y), egui::PointerButton::Primary, false);
        assert_eq!(harness.state().to_string(), "0.495:1,0.5:0,1:1");
        let second = pos2(middle.x, image.bottom() - RADIUS - 1.0);
        press(&mut harness, second, egui::PointerButton::Secondary, true);
        press(&mut harness, second, egui::PointerButton::Secondary, false);
        assert_eq!(harness.state().points().len(), 2);
    }
}
