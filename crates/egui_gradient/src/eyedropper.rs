//! Eyedropper: picks colors from anywhere in the window, one by a click or a gradient along a stroke. While it is
//! active, the window shows a screenshot of itself, so the picked colors are exactly the visible ones.

use std::sync::{Arc, OnceLock};

use egui::{
    self, Area, Color32, ColorImage, CursorIcon, EventFilter, Id, Key, Modifiers, Order, Pos2, Rect, Sense, Stroke,
    TextureOptions, Ui, Vec2, vec2,
};
use glam::Vec3;

use super::paint;
use super::screenshot_sampling::{SampleSize, pixel_at, pixel_color, sample_colors};
use haze_author::ramp::HexColor;

/// State of an active eyedropper: waits for a screenshot of the window, then for a click or a stroke by pointer or
/// keys.
#[derive(Clone, Debug, Default)]
pub struct Eyedropper {
    /// Screenshot of the window from when the eyedropper was activated.
    screenshot: Arc<OnceLock<Arc<ColorImage>>>,
    /// Frames since activation.
    frames: u32,
    /// Last pointer position, and the picked position, which keys move too; points.
    pointer: Option<Pos2>,
    at: Pos2,
    /// Picked positions since the button was pressed.
    stroke: Vec<Pos2>,
    /// True if a key began the stroke.
    is_keyboard_stroke: bool,
    is_released: bool,
}

/// Picked sRGB colors, 0 to 255: one, those along a stroke, or none.
pub enum EyedropperResult {
    /// Colors at the current position; the eyedropper stays active.
    Pointed(Vec<Vec3>),
    /// Final colors. Empty if Escape cancelled the eyedropper.
    Done(Vec<Vec3>),
}

impl Eyedropper {
    /// Handles pointer and keys for one frame.
    pub fn update(&mut self, ui: &Ui, sample_size: &mut SampleSize) -> EyedropperResult {
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            return EyedropperResult::Done(Vec::new());
        }
        self.request_screenshot(ui);
        self.cover_window(ui);
        self.follow_pointer(ui);
        self.keys(ui, sample_size);
        let here = [self.at];
        let stroke = if self.stroke.is_empty() { &here[..] } else { &self.stroke };
        let colors = self
            .screenshot
            .get()
            .map(|screenshot| sample_colors(screenshot, stroke, ui.pixels_per_point(), *sample_size));
        match colors {
            Some(colors) if self.is_released => EyedropperResult::Done(colors),
            colors => EyedropperResult::Pointed(colors.unwrap_or_default()),
        }
    }

    /// Requests a screenshot, once no widget is drawn as hovered any more.
    fn request_screenshot(&mut self, ui: &Ui) {
        /// The cover is added in frame 1, widgets lose their hover in frame 2 and are drawn without it in frame 3.
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
        let screenshot = Arc::clone(&self.screenshot);
        let context = ui.ctx().clone();
        ui.ctx().request_screenshot(move |image| {
            // Fails only if it is set already.
            let _ = screenshot.set(image);
            context.request_repaint();
        });
    }

    /// Covers the whole window, so that no other widget gets clicks, and draws the screenshot and the stroke.
    fn cover_window(&self, ui: &Ui) {
        let window = ui.ctx().viewport_rect();
        let id: Id = ui.scope_id().with("eyedropper");
        let cover = Area::new(id).order(Order::Foreground).fixed_pos(window.min).constrain(false);
        let response = cover.show(ui.ctx(), |ui| ui.allocate_response(window.size(), Sense::click_and_drag())).inner;
        let response = response.on_hover_cursor(CursorIcon::Crosshair);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "take a color"));
        // Takes all keys.
        response.request_focus();
        let filter = EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let Some(screenshot) = self.screenshot.get() else { return };
        let painter = ui.ctx().layer_painter(response.layer_id);
        let [width, height] = screenshot.size;
        if width.max(height) <= ui.input(|input| input.max_texture_side) {
            let image = ui.ctx().load_texture_cached("eyedropper", id, Arc::clone(screenshot), TextureOptions::NEAREST);
            let size = vec2(width as f32, height as f32) / ui.pixels_per_point();
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(image.id(), Rect::from_min_size(Pos2::ZERO, size), all, Color32::WHITE);
        }
        for (width, color) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
            painter.line(self.stroke.clone(), Stroke::new(width, color));
        }
    }

    /// Updates position and stroke by the pointer.
    fn follow_pointer(&mut self, ui: &Ui) {
        let (pointer, is_pressed, is_down) = ui
            .input(|input| (input.pointer.latest_pos(), input.pointer.primary_pressed(), input.pointer.primary_down()));
        let has_moved = pointer.is_some() && pointer != self.pointer;
        self.pointer = pointer;
        if let Some(pointer) = pointer.filter(|_| has_moved || is_pressed) {
            self.at = pointer;
        }
        if is_pressed {
            self.stroke = vec![self.at];
            self.is_keyboard_stroke = false;
        } else if is_down || self.is_keyboard_stroke {
            self.extend_stroke();
        }
        self.is_released |= !is_down && !self.is_keyboard_stroke && !self.stroke.is_empty();
    }

    fn extend_stroke(&mut self) {
        if self.stroke.last().is_some_and(|last| *last != self.at) {
            self.stroke.push(self.at);
        }
    }

    /// Handles keys and wheel. Arrows move by pixels, Shift ten times as far. Enter picks, Space begins a stroke.
    /// Digits and the wheel set the sample size.
    fn keys(&mut self, ui: &Ui, sample_size: &mut SampleSize) {
        let mut pressed = Vec::new();
        ui.input_mut(|input| {
            // Prevents scrolling of widgets below.
            input.smooth_scroll_delta = Vec2::ZERO;
            input.events.retain(|event| {
                match event {
                    egui::Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                        pressed.push((*key, *repeat, *modifiers));
                    }
                    egui::Event::MouseWheel { delta, .. } if delta.y != 0.0 => {
                        *sample_size = sample_size.stepped(if delta.y > 0.0 { 1 } else { -1 });
                    }
                    _ => return true,
                }
                false
            });
        });
        let pixel = ui.pixels_per_point().recip();
        for (key, is_repeat, modifiers) in pressed {
            let step = match key {
                Key::ArrowLeft => Vec2::LEFT,
                Key::ArrowRight => Vec2::RIGHT,
                Key::ArrowUp => Vec2::UP,
                Key::ArrowDown => Vec2::DOWN,
                Key::Space if !is_repeat && self.stroke.is_empty() => {
                    self.stroke = vec![self.at];
                    self.is_keyboard_stroke = true;
                    continue;
                }
                Key::Enter | Key::Space if !is_repeat => {
                    if self.stroke.is_empty() {
                        self.stroke.push(self.at);
                    }
                    self.is_keyboard_stroke = false;
                    self.is_released = true;
                    continue;
                }
                key => {
                    *sample_size = SampleSize::ALL
                        .iter()
                        .find(|(_, of)| *of == key)
                        .map_or(*sample_size, |(sample_size, _)| *sample_size);
                    continue;
                }
            };
            let window = ui.ctx().viewport_rect();
            self.at = window.clamp(self.at + step * pixel * if modifiers.shift { 10.0 } else { 1.0 });
            if self.is_keyboard_stroke {
                self.extend_stroke();
            }
        }
    }

    /// Draws a magnifier: pixels around the position, the color that would be picked, and below the resulting
    /// gradient, where `gradient` returns the color at a position.
    pub fn magnifier(&self, ui: &Ui, sample_size: SampleSize, colors: &[Vec3], gradient: impl Fn(f32) -> Color32) {
        /// Number of magnified pixels across, and the size of each in points.
        const SEEN: i32 = 11;
        const CELL: f32 = 8.0;
        let (Some(screenshot), Some(color)) = (self.screenshot.get(), colors.last()) else { return };
        // Placed on the side with more room.
        let x = self.at.x > ui.ctx().viewport_rect().center().x;
        let y = self.at.y > ui.ctx().viewport_rect().center().y;
        let side = |is_far: bool| if is_far { egui::Align::Max } else { egui::Align::Min };
        let away = |is_far: bool| if is_far { -20.0 } else { 20.0 };
        let area = Area::new(ui.scope_id().with("magnifier")).order(Order::Tooltip).interactable(false);
        let area = area.pivot(egui::Align2([side(x), side(y)])).fixed_pos(self.at + vec2(away(x), away(y)));
        let center = pixel_at(screenshot, self.at, ui.pixels_per_point());
        area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).inner_margin(4.0).show(ui, |ui| {
                let (_, seen) = ui.allocate_space(Vec2::splat(SEEN as f32 * CELL));
                let mut mesh = egui::Mesh::default();
                let cell =
                    |x: i32, y: i32| Rect::from_min_size(seen.min + vec2(x as f32, y as f32) * CELL, Vec2::splat(CELL));
                for (x, y) in (0..SEEN).flat_map(|y| (0..SEEN).map(move |x| (x, y))) {
                    let pixel = pixel_color(screenshot, [center[0] + x - SEEN / 2, center[1] + y - SEEN / 2]);
                    mesh.add_colored_rect(cell(x, y), color32(pixel));
                }
                ui.painter().add(mesh);
                let first = SEEN / 2 - sample_size.reach();
                let last = SEEN / 2 + sample_size.reach();
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
                ui.painter().rect_filled(swatch, 0.0, color32(*color));
                let (_, strip) = ui.allocate_space(vec2(seen.width(), 12.0));
                paint::gradient(ui, strip, gradient);
                let hex = String::from(HexColor::from_srgb(*color / 255.0));
                ui.label(format!("{hex}  {0}×{0}", sample_size as i32));
            });
        });
    }
}

/// Eyedropper for one color of a host's own. Keep it across frames while it is active.
#[derive(Clone, Debug, Default)]
pub struct ColorEyedropper {
    eyedropper: Eyedropper,
    sample_size: SampleSize,
}

impl ColorEyedropper {
    /// Handles pointer and keys for one frame. Returns the picked color, or `None` in it after Escape; `None` while the
    /// eyedropper stays active. A stroke picks the color of its end.
    pub fn update(&mut self, ui: &Ui) -> Option<Option<HexColor>> {
        let code = |colors: &[Vec3]| colors.last().map(|color| HexColor::from_srgb(*color / 255.0));
        match self.eyedropper.update(ui, &mut self.sample_size) {
            EyedropperResult::Done(colors) => Some(code(&colors)),
            EyedropperResult::Pointed(colors) => {
                let color = code(&colors).map_or(Color32::TRANSPARENT, paint::color32);
                self.eyedropper.magnifier(ui, self.sample_size, &colors, |_| color);
                None
            }
        }
    }
}

fn color32(color: Vec3) -> Color32 {
    paint::color32(HexColor::from_srgb(color / 255.0))
}
