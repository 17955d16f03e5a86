//! Takes colours from anywhere in the window: one by a click, a gradient along a stroke.

use std::sync::{Arc, OnceLock};

use eframe::egui::{
    self, Area, Color32, ColorImage, CursorIcon, EventFilter, Id, Key, Modifiers, Order, Pos2, Sense, Ui,
};
use glam::Vec3;

/// Shorter than this, points, a stroke is a click.
const CLICK: f32 = 6.0;
/// Colours of a stroke, each the mean of its part: what is finer is grain.
const PARTS: usize = 32;

/// It waits for the pointer, and then for what the window shows.
#[derive(Clone, Debug, Default)]
pub struct Eyedropper {
    /// Where the pointer has been while it was held, points.
    stroke: Vec<Pos2>,
    is_let_go: bool,
    shown: Arc<OnceLock<Arc<ColorImage>>>,
}

impl Eyedropper {
    /// Gives it the pointer, and once it is done the colours that it took, steps of 255: one, those of a stroke, or none where
    /// Escape put it away.
    pub fn take(&mut self, ui: &Ui) -> Option<Vec<Vec3>> {
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            return Some(Vec::new());
        }
        self.follow(ui);
        let shown = self.shown.get().filter(|_| self.is_let_go)?;
        Some(colours(shown, &self.stroke, ui.pixels_per_point()))
    }

    /// Lies over the whole window, so that nothing else is clicked on.
    fn follow(&mut self, ui: &Ui) {
        let window = ui.ctx().viewport_rect();
        let id: Id = ui.scope_id().with("eyedropper");
        let cover = Area::new(id).order(Order::Foreground).fixed_pos(window.min).constrain(false);
        let response = cover.show(ui.ctx(), |ui| ui.allocate_response(window.size(), Sense::click_and_drag())).inner;
        let response = response.on_hover_cursor(CursorIcon::Crosshair);
        // Escape is for it, too.
        response.request_focus();
        let filter = EventFilter { escape: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let (at, is_pressed, is_down) = ui
            .input(|input| (input.pointer.latest_pos(), input.pointer.primary_pressed(), input.pointer.primary_down()));
        let Some(at) = at else { return };
        if is_pressed {
            *self = Self { stroke: vec![at], ..Self::default() };
            let (shown, context) = (Arc::clone(&self.shown), ui.ctx().clone());
            ui.ctx().request_screenshot(move |image| {
                // There is one for each stroke.
                let _ = shown.set(image);
                context.request_repaint();
            });
        } else if is_down && self.stroke.last().is_some_and(|last| *last != at) {
            self.stroke.push(at);
        }
        self.is_let_go = !is_down && !self.stroke.is_empty();
        // Not before: it would be taken too.
        if self.shown.get().is_some() {
            let painter = ui.ctx().layer_painter(response.layer_id);
            for (width, colour) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
                painter.line(self.stroke.clone(), egui::Stroke::new(width, colour));
            }
        }
    }
}

/// The colours along a stroke, steps of 255: one of a click.
fn colours(shown: &ColorImage, stroke: &[Pos2], pixels_per_point: f32) -> Vec<Vec3> {
    let [width, height] = shown.size;
    let pixel = |at: Pos2| {
        let at = (at.to_vec2() * pixels_per_point).floor();
        let (x, y) = ((at.x as usize).min(width - 1), (at.y as usize).min(height - 1));
        let [r, g, b, _] = shown.pixels[y * width + x].to_array();
        Vec3::from([r, g, b].map(f32::from))
    };
    let Some(first) = stroke.first().filter(|_| width * height > 0) else { return Vec::new() };
    let length: f32 = stroke.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if length < CLICK {
        return vec![pixel(*first)];
    }
    let mut parts = vec![(Vec3::ZERO, 0.0); PARTS];
    let mut before = 0.0;
    for pair in stroke.windows(2) {
        let part = pair[0].distance(pair[1]);
        let steps = (part * pixels_per_point * 2.0).ceil().max(1.0);
        for step in 0..steps as usize {
            let share = (step as f32 + 0.5) / steps;
            let along = (before + part * share) / length;
            let (sum, weight) = &mut parts[((along * PARTS as f32) as usize).min(PARTS - 1)];
            *sum += pixel(pair[0].lerp(pair[1], share)) * part / steps;
            *weight += part / steps;
        }
        before += part;
    }
    parts.into_iter().filter(|(_, weight)| *weight > 0.0).map(|(sum, weight)| sum / weight).collect()
}

#[cfg(test)]
mod tests {
    use eframe::egui::pos2;

    use super::*;

    /// Red across, green down.
    fn picture() -> ColorImage {
        let pixel = |index: usize| Color32::from_rgb((index % 200) as u8, (index / 200) as u8, 9);
        ColorImage::new([200, 100], (0..20_000).map(pixel).collect())
    }

    #[test]
    fn a_click_takes_the_pixel_that_is_pointed_at() {
        for (at, scale, expected) in [
            (pos2(20.7, 30.2), 1.0, [20.0, 30.0]),
            (pos2(20.7, 30.2), 2.0, [41.0, 60.0]),
            (pos2(900.0, -5.0), 1.0, [199.0, 0.0]),
        ] {
            let colours = colours(&picture(), &[at, at + egui::vec2(1.0, 1.0)], scale);
            assert_eq!(colours, [Vec3::new(expected[0], expected[1], 9.0)]);
        }
        assert!(colours(&ColorImage::default(), &[pos2(1.0, 1.0)], 1.0).is_empty());
        assert!(colours(&picture(), &[], 1.0).is_empty());
    }

    #[test]
    fn a_stroke_takes_what_lies_along_it() {
        // There, and half way back: what counts is the way that the pointer went.
        let there = [pos2(0.0, 50.5), pos2(100.0, 50.5), pos2(180.0, 50.5)];
        let row = colours(&picture(), &there, 1.0);
        assert_eq!(row.len(), PARTS);
        for (index, colour) in row.iter().enumerate() {
            let expected = (index as f32 + 0.5) / PARTS as f32 * 180.0 - 0.5;
            assert!((colour.x - expected).abs() < 1.0 && (colour.y - 50.0).abs() < 1.0e-3, "{index}: {colour}");
        }
        let back = colours(&picture(), &[there[0], there[1], there[0]], 1.0);
        assert!((back[PARTS - 1].x - back[0].x).abs() < 1.0 && (back[PARTS / 2].x - 98.0).abs() < 3.0, "{back:?}");
    }
}
