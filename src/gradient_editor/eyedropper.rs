//! Takes colours from anywhere in the window: one by a click, a gradient along a stroke. The window stands still meanwhile: what
//! is seen is what is taken.

use std::sync::{Arc, OnceLock};

use eframe::egui::{
    self, Area, Color32, ColorImage, CursorIcon, EventFilter, Id, Key, Modifiers, Order, Pos2, Rect, Sense, Stroke,
    TextureOptions, Ui, Vec2, vec2,
};
use glam::Vec3;

use super::paint;
use crate::assets::ramp::bake::HexColour;

/// Shorter than this, points, a stroke is a click.
const CLICK: f32 = 6.0;
/// Colours of a stroke, each the mean of its part: what is finer is grain.
const PARTS: usize = 32;

/// How many pixels, across and down, a colour is the mean of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    #[default]
    One = 1,
    Three = 3,
    Five = 5,
}

impl Across {
    const ALL: [(Self, Key); 3] = [(Self::One, Key::Num1), (Self::Three, Key::Num3), (Self::Five, Key::Num5)];

    /// Pixels on either side of the middle.
    fn reach(self) -> i32 {
        self as i32 / 2
    }

    /// The next for some more or fewer.
    fn stepped(self, by: isize) -> Self {
        let at = Self::ALL.iter().position(|(across, _)| *across == self).unwrap_or(0);
        Self::ALL[at.saturating_add_signed(by).min(Self::ALL.len() - 1)].0
    }
}

/// It waits for what the window shows, and for a click or a stroke by pointer or keys.
#[derive(Clone, Debug, Default)]
pub struct Eyedropper {
    /// The window as it was when this began.
    shown: Arc<OnceLock<Arc<ColorImage>>>,
    /// Frames since.
    frames: u32,
    /// Where the pointer was last, and where colours are taken, which keys move too; points.
    pointer: Option<Pos2>,
    at: Pos2,
    /// Where it has been while it was held.
    stroke: Vec<Pos2>,
    /// The stroke was begun by a key.
    is_by_key: bool,
    is_let_go: bool,
}

/// Colours, steps of 255: one, those along a stroke, or none.
pub enum Taken {
    /// They would be taken now.
    Pointed(Vec<Vec3>),
    /// They are. None where Escape put it away.
    Done(Vec<Vec3>),
}

impl Eyedropper {
    /// Gives it pointer and keys.
    pub fn take(&mut self, ui: &Ui, across: &mut Across) -> Taken {
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            return Taken::Done(Vec::new());
        }
        self.ask(ui);
        self.cover(ui);
        self.follow(ui);
        self.keys(ui, across);
        let here = [self.at];
        let stroke = if self.stroke.is_empty() { &here[..] } else { &self.stroke };
        let colours = self.shown.get().map(|shown| colours(shown, stroke, ui.pixels_per_point(), *across));
        match colours {
            Some(colours) if self.is_let_go => Taken::Done(colours),
            colours => Taken::Pointed(colours.unwrap_or_default()),
        }
    }

    /// Asks for what the window shows, once nothing under the pointer says so any more.
    fn ask(&mut self, ui: &Ui) {
        /// Covered in the first, nothing is hovered in the next, and drawn so in the one after.
        const COVERED: u32 = 3;
        self.frames = self.frames.saturating_add(1);
        if self.frames == 1 {
            self.pointer = ui.input(|input| input.pointer.latest_pos());
            self.at = self.pointer.unwrap_or(ui.ctx().viewport_rect().center());
        }
        if self.frames < COVERED {
            ui.ctx().request_repaint();
        }
        if self.frames != COVERED {
            return;
        }
        let (shown, context) = (Arc::clone(&self.shown), ui.ctx().clone());
        ui.ctx().request_screenshot(move |image| {
            // There is one.
            let _ = shown.set(image);
            context.request_repaint();
        });
    }

    /// Lies over the whole window, so that nothing else is clicked on, and shows it as it was.
    fn cover(&self, ui: &Ui) {
        let window = ui.ctx().viewport_rect();
        let id: Id = ui.scope_id().with("eyedropper");
        let cover = Area::new(id).order(Order::Foreground).fixed_pos(window.min).constrain(false);
        let response = cover.show(ui.ctx(), |ui| ui.allocate_response(window.size(), Sense::click_and_drag())).inner;
        let response = response.on_hover_cursor(CursorIcon::Crosshair);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "take a colour"));
        // Its keys are for it.
        response.request_focus();
        let filter = EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let Some(shown) = self.shown.get() else { return };
        let painter = ui.ctx().layer_painter(response.layer_id);
        let [width, height] = shown.size;
        if width.max(height) <= ui.input(|input| input.max_texture_side) {
            let picture = ui.ctx().load_texture_cached("eyedropper", id, Arc::clone(shown), TextureOptions::NEAREST);
            let size = vec2(width as f32, height as f32) / ui.pixels_per_point();
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(picture.id(), Rect::from_min_size(Pos2::ZERO, size), all, Color32::WHITE);
        }
        for (width, colour) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
            painter.line(self.stroke.clone(), Stroke::new(width, colour));
        }
    }

    /// What the pointer does.
    fn follow(&mut self, ui: &Ui) {
        let (pointer, is_pressed, is_down) = ui
            .input(|input| (input.pointer.latest_pos(), input.pointer.primary_pressed(), input.pointer.primary_down()));
        let has_moved = pointer.is_some() && pointer != self.pointer;
        self.pointer = pointer;
        if let Some(pointer) = pointer.filter(|_| has_moved || is_pressed) {
            self.at = pointer;
        }
        if is_pressed {
            (self.stroke, self.is_by_key) = (vec![self.at], false);
        } else if is_down || self.is_by_key {
            self.draw_on();
        }
        self.is_let_go |= !is_down && !self.is_by_key && !self.stroke.is_empty();
    }

    fn draw_on(&mut self) {
        if self.stroke.last().is_some_and(|last| *last != self.at) {
            self.stroke.push(self.at);
        }
    }

    /// Arrows go by pixels, Shift ten times as far; Enter takes; Space begins a stroke; digits and the wheel say how many pixels.
    fn keys(&mut self, ui: &Ui, across: &mut Across) {
        let mut pressed = Vec::new();
        let wheel = ui.input_mut(|input| {
            input.events.retain(|event| {
                let egui::Event::Key { key, pressed: true, repeat, modifiers, .. } = event else { return true };
                pressed.push((*key, *repeat, *modifiers));
                false
            });
            std::mem::take(&mut input.smooth_scroll_delta).y
        });
        if wheel.abs() > 1.0 {
            *across = across.stepped(if wheel > 0.0 { 1 } else { -1 });
        }
        let pixel = ui.pixels_per_point().recip();
        for (key, is_repeat, modifiers) in pressed {
            let step = match key {
                Key::ArrowLeft => Vec2::LEFT,
                Key::ArrowRight => Vec2::RIGHT,
                Key::ArrowUp => Vec2::UP,
                Key::ArrowDown => Vec2::DOWN,
                Key::Space if !is_repeat && self.stroke.is_empty() => {
                    (self.stroke, self.is_by_key) = (vec![self.at], true);
                    continue;
                }
                Key::Enter | Key::Space if !is_repeat => {
                    if self.stroke.is_empty() {
                        self.stroke.push(self.at);
                    }
                    (self.is_by_key, self.is_let_go) = (false, true);
                    continue;
                }
                key => {
                    *across = Across::ALL.iter().find(|(_, of)| *of == key).map_or(*across, |(across, _)| *across);
                    continue;
                }
            };
            let window = ui.ctx().viewport_rect();
            self.at = window.clamp(self.at + step * pixel * if modifiers.shift { 10.0 } else { 1.0 });
            if self.is_by_key {
                self.draw_on();
            }
        }
    }

    /// What it is over, magnified, with the colour that would be taken, and below that what `gradient` would be, by place.
    pub fn magnifier(&self, ui: &Ui, across: Across, colours: &[Vec3], gradient: impl Fn(f32) -> Color32) {
        /// Pixels across, and how large they are.
        const SEEN: i32 = 11;
        const CELL: f32 = 8.0;
        let (Some(shown), Some(colour)) = (self.shown.get(), colours.last()) else { return };
        // On the side where there is room for it.
        let (x, y) = (self.at.x > ui.ctx().viewport_rect().center().x, self.at.y > ui.ctx().viewport_rect().center().y);
        let side = |is_far: bool| if is_far { egui::Align::Max } else { egui::Align::Min };
        let away = |is_far: bool| if is_far { -20.0 } else { 20.0 };
        let area = Area::new(ui.scope_id().with("magnifier")).order(Order::Tooltip).interactable(false);
        let area = area.pivot(egui::Align2([side(x), side(y)])).fixed_pos(self.at + vec2(away(x), away(y)));
        let centre = place(shown, self.at, ui.pixels_per_point());
        area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).inner_margin(4.0).show(ui, |ui| {
                let (_, seen) = ui.allocate_space(Vec2::splat(SEEN as f32 * CELL));
                let mut mesh = egui::Mesh::default();
                let cell =
                    |x: i32, y: i32| Rect::from_min_size(seen.min + vec2(x as f32, y as f32) * CELL, Vec2::splat(CELL));
                for (x, y) in (0..SEEN).flat_map(|y| (0..SEEN).map(move |x| (x, y))) {
                    let pixel = pixel(shown, [centre[0] + x - SEEN / 2, centre[1] + y - SEEN / 2]);
                    mesh.add_colored_rect(cell(x, y), colour32(pixel));
                }
                ui.painter().add(mesh);
                let (first, last) = (SEEN / 2 - across.reach(), SEEN / 2 + across.reach());
                let taken = cell(first, first).union(cell(last, last));
                for (grown, ink) in [(1.0, Color32::BLACK), (0.0, Color32::WHITE)] {
                    ui.painter().rect_stroke(
                        taken.expand(grown),
                        0.0,
                        Stroke::new(1.0, ink),
                        egui::StrokeKind::Outside,
                    );
                }
                let (_, swatch) = ui.allocate_space(vec2(seen.width(), 12.0));
                ui.painter().rect_filled(swatch, 0.0, colour32(*colour));
                let (_, strip) = ui.allocate_space(vec2(seen.width(), 12.0));
                paint::gradient(ui, strip, gradient);
                let hex = String::from(HexColour::from_srgb(*colour / 255.0));
                ui.label(format!("{hex}  {0}×{0}", across as i32));
            });
        });
    }
}

fn colour32(colour: Vec3) -> Color32 {
    paint::colour32(HexColour::from_srgb(colour / 255.0))
}

/// The pixel at a place, points.
fn place(shown: &ColorImage, at: Pos2, pixels_per_point: f32) -> [i32; 2] {
    let at = (at.to_vec2() * pixels_per_point).floor();
    let [width, height] = shown.size.map(|side| side as f32 - 1.0);
    [at.x.min(width).max(0.0) as i32, at.y.min(height).max(0.0) as i32]
}

/// A pixel, or the one at the border beside it.
fn pixel(shown: &ColorImage, [x, y]: [i32; 2]) -> Vec3 {
    let [width, height] = shown.size;
    let inside = |at: i32, side: usize| usize::try_from(at).unwrap_or(0).min(side.saturating_sub(1));
    let pixel = shown.pixels.get(inside(y, height) * width + inside(x, width)).copied().unwrap_or_default();
    let [r, g, b, _] = pixel.to_array();
    Vec3::from([r, g, b].map(f32::from))
}

/// The mean of the pixels round one, as they are coded: what a blurred picture would have there.
fn mean(shown: &ColorImage, [x, y]: [i32; 2], across: Across) -> Vec3 {
    let reach = across.reach();
    let around = (-reach..=reach).flat_map(|down| (-reach..=reach).map(move |right| [x + right, y + down]));
    around.map(|at| pixel(shown, at)).sum::<Vec3>() / (across as i32 * across as i32) as f32
}

/// The colours along a stroke, steps of 255: one of a click.
fn colours(shown: &ColorImage, stroke: &[Pos2], pixels_per_point: f32, across: Across) -> Vec<Vec3> {
    let pixel = |at: Pos2| mean(shown, place(shown, at, pixels_per_point), across);
    let Some(first) = stroke.first().filter(|_| !shown.pixels.is_empty()) else { return Vec::new() };
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
            let colours = colours(&picture(), &[at, at + vec2(1.0, 1.0)], scale, Across::One);
            assert_eq!(colours, [Vec3::new(expected[0], expected[1], 9.0)]);
        }
        assert!(colours(&ColorImage::default(), &[pos2(1.0, 1.0)], 1.0, Across::One).is_empty());
        assert!(colours(&picture(), &[], 1.0, Across::One).is_empty());
    }

    #[test]
    fn the_mean_of_some_pixels_is_taken() {
        let at = [pos2(20.5, 30.5)];
        let mut noisy = picture();
        noisy.pixels[30 * 200 + 20] = Color32::from_rgb(245, 30, 9);
        for (across, expected) in [(Across::One, 245.0), (Across::Three, 45.0), (Across::Five, 29.0)] {
            let taken = colours(&noisy, &at, 1.0, across)[0];
            assert!(taken.abs_diff_eq(Vec3::new(expected, 30.0, 9.0), 1.0e-3), "{across:?}: {taken}");
        }
        // At a corner the border goes on.
        let corner = colours(&picture(), &[pos2(0.0, 0.0)], 1.0, Across::Three)[0];
        assert!(corner.abs_diff_eq(Vec3::new(1.0 / 3.0, 1.0 / 3.0, 9.0), 1.0e-3), "{corner}");
        let sizes = [-1, 1, 1, 1].map(|by| Across::Three.stepped(by));
        assert_eq!(sizes, [Across::One, Across::Five, Across::Five, Across::Five]);
        assert_eq!((Across::One.stepped(-1), Across::Five.stepped(1)), (Across::One, Across::Five));
    }

    #[test]
    fn a_stroke_takes_what_lies_along_it() {
        // There, and half way back: what counts is the way that the pointer went.
        let there = [pos2(0.0, 50.5), pos2(100.0, 50.5), pos2(180.0, 50.5)];
        let row = colours(&picture(), &there, 1.0, Across::One);
        assert_eq!(row.len(), PARTS);
        for (index, colour) in row.iter().enumerate() {
            let expected = (index as f32 + 0.5) / PARTS as f32 * 180.0 - 0.5;
            assert!((colour.x - expected).abs() < 1.0 && (colour.y - 50.0).abs() < 1.0e-3, "{index}: {colour}");
        }
        let back = colours(&picture(), &[there[0], there[1], there[0]], 1.0, Across::One);
        assert!((back[PARTS - 1].x - back[0].x).abs() < 1.0 && (back[PARTS / 2].x - 98.0).abs() < 3.0, "{back:?}");
    }
}
