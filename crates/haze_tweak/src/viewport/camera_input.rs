//! Camera control by pointer and wheel, as in Maya and Blender: Alt and a button, or the middle button with Shift or
//! Ctrl. The right button with WASD flies. On a touch screen one finger orbits, two pan and pinch.

use eframe::egui::{self, Key, Modifiers, PointerButton, Response, Ui};
use glam::Vec3;
use haze_preset::Camera;

use super::camera_moves::{dolly, fly, look, orbit, pan};
use super::screen_projection::ScreenProjection;

/// Orbit angle of a drag over the height of the image, radians.
const ORBIT: f32 = 3.5;
/// Look angle of the same drag, radians.
const LOOK: f32 = 1.6;
/// Dolly factor of a drag over the height of the image, or of `WHEEL` points of the wheel.
const DOLLY: f32 = 4.0;
const WHEEL: f32 = 600.0;
/// Speed factor with Shift, and of `WHEEL` points of the wheel.
const FASTER: f32 = 4.0;
/// Range of flight speeds, m/s.
const SPEEDS: std::ops::RangeInclusive<f32> = 0.05..=200.0;
/// Pause after which the wheel begins a new gesture, seconds.
const PAUSE: f64 = 0.5;
/// Largest coordinate that a preset may have, metres.
const MAX_COORDINATE: f32 = 1.0e5;

/// Camera gesture in progress.
pub struct CameraInput {
    gesture: Option<Gesture>,
    /// Flight speed, m/s.
    pub speed: f32,
    /// Time when the wheel was last turned, seconds.
    wheeled: f64,
    /// The right button was used for a flight, so it opens no menu.
    pub has_flown: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gesture {
    Orbit,
    Pan,
    Dolly,
    Fly,
}

impl Default for CameraInput {
    fn default() -> Self {
        Self { gesture: None, speed: 2.0, wheeled: f64::NEG_INFINITY, has_flown: false }
    }
}

impl CameraInput {
    /// Moves the camera as the pointer over the image asks for. Returns true if the flight speed was changed.
    pub fn steer(&mut self, ui: &Ui, response: &Response, projection: &ScreenProjection, camera: &mut Camera) -> bool {
        let before = *camera;
        if !self.touch(ui, response, camera) {
            self.drag(ui, response, camera);
        }
        self.fly(ui, response, camera);
        let is_faster = self.wheel(ui, response, projection, camera);
        let positions = [camera.position, camera.target];
        if !positions.iter().all(|position| position.is_finite() && position.abs().max_element() <= MAX_COORDINATE) {
            *camera = before;
        }
        is_faster
    }

    /// Returns true during a wheel gesture. The wheel has no button, so its steps within a short time are one gesture.
    pub fn is_wheeling(&self, ui: &Ui) -> bool {
        ui.input(|input| input.time) < self.wheeled + PAUSE
    }

    /// Ends the gesture of the wheel.
    pub fn forget_wheel(&mut self) {
        self.wheeled = f64::NEG_INFINITY;
    }

    fn drag(&mut self, ui: &Ui, response: &Response, camera: &mut Camera) {
        let buttons = [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary];
        if let Some(button) = buttons.into_iter().find(|&button| response.drag_started_by(button)) {
            self.gesture = gesture(button, ui.input(|input| input.modifiers));
        }
        if !response.dragged() {
            self.gesture = None;
        }
        // A drag that has just begun has moved since the press.
        let is_new = self.gesture.is_some() && response.drag_started();
        let moved = if is_new { response.total_drag_delta().unwrap_or_default() } else { response.drag_delta() };
        let drag = moved / response.rect.height().max(1.0);
        let drag = glam::Vec2::new(drag.x, drag.y);
        match self.gesture {
            Some(Gesture::Orbit) => orbit(camera, drag * ORBIT),
            Some(Gesture::Pan) => pan(camera, drag),
            Some(Gesture::Dolly) => dolly(camera, camera.target, DOLLY.powf(drag.y - drag.x)),
            Some(Gesture::Fly) => look(camera, drag * LOOK),
            None => {}
        }
    }

    /// Pans and dollies with two fingers that began on the image. Returns true meanwhile.
    fn touch(&mut self, ui: &Ui, response: &Response, camera: &mut Camera) -> bool {
        let Some(touch) = ui.input(egui::InputState::multi_touch) else { return false };
        if !response.rect.contains(touch.start_pos) {
            return false;
        }
        // The finger that stays moves nothing more until it is lifted.
        self.gesture = None;
        let by = touch.translation_delta / response.rect.height().max(1.0);
        pan(camera, glam::Vec2::new(by.x, by.y));
        dolly(camera, camera.target, 1.0 / touch.zoom_delta.max(0.01));
        true
    }

    fn fly(&mut self, ui: &Ui, response: &Response, camera: &mut Camera) {
        let (is_down, is_new) = ui.input(|input| {
            let pointer = &input.pointer;
            (pointer.secondary_down(), pointer.button_pressed(PointerButton::Secondary))
        });
        self.has_flown &= !is_new;
        if !is_down || !response.is_pointer_button_down_on() || ui.ctx().text_edit_focused() {
            return;
        }
        let (way, speed, seconds) = ui.input(|input| {
            let key = |key| f32::from(u8::from(input.key_down(key)));
            let way = Vec3::new(key(Key::D) - key(Key::A), key(Key::E) - key(Key::Q), key(Key::W) - key(Key::S));
            let speed = self.speed * if input.modifiers.shift { FASTER } else { 1.0 };
            (way, speed, input.stable_dt.min(0.1))
        });
        if way != Vec3::ZERO {
            self.has_flown = true;
            fly(camera, way * speed * seconds);
            ui.ctx().request_repaint();
        }
    }

    fn wheel(&mut self, ui: &Ui, response: &Response, projection: &ScreenProjection, camera: &mut Camera) -> bool {
        let (turned, is_flying, time) =
            ui.input(|input| (input.smooth_scroll_delta().y, input.pointer.secondary_down(), input.time));
        let Some(at) = response.hover_pos().filter(|_| turned != 0.0) else { return false };
        if is_flying {
            self.speed = (self.speed * FASTER.powf(turned / WHEEL)).clamp(*SPEEDS.start(), *SPEEDS.end());
            self.has_flown = true;
        } else {
            dolly(camera, projection.unproject_to_facing_plane(at, camera.target), DOLLY.powf(-turned / WHEEL));
            self.wheeled = time;
            // A later frame closes the undo step if the wheel has stopped.
            ui.ctx().request_repaint_after_secs(PAUSE as f32 + 0.01);
        }
        is_flying
    }
}

fn gesture(button: PointerButton, held: Modifiers) -> Option<Gesture> {
    Some(match button {
        PointerButton::Middle if held.alt || held.shift => Gesture::Pan,
        PointerButton::Middle if held.command => Gesture::Dolly,
        // Reserved for painting on the smoke, while the inspector is on.
        PointerButton::Primary if held.command => return None,
        PointerButton::Primary | PointerButton::Middle => Gesture::Orbit,
        PointerButton::Secondary if held.alt => Gesture::Dolly,
        PointerButton::Secondary => Gesture::Fly,
        _ => return None,
    })
}
