//! The camera by pointer and keys, as Maya and Blender have it: Alt and a button, or the middle button with Shift or Ctrl; the right
//! button and WASD fly.

use eframe::egui::{Key, PointerButton, Response, Ui};
use glam::{Quat, Vec3};
use haze::preset::Camera;

/// Radians of orbit for a drag over the height of the picture.
const ORBIT: f32 = 3.5;
/// Radians of looking round for the same.
const LOOK: f32 = 1.6;
/// Times nearer for a drag over the height of the picture, or for so many points of the wheel.
const DOLLY: f32 = 4.0;
const WHEEL: f32 = 600.0;
/// Closest that the camera comes to what it looks at, metres.
const NEAREST: f32 = 0.05;
/// Share of straight up or down that it may look.
const STEEPEST: f32 = 0.995;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gesture {
    Orbit,
    Pan,
    Dolly,
    Look,
}

/// Moves the camera by what the pointer does over the picture.
pub fn steer(ui: &Ui, response: &Response, camera: &mut Camera) {
    let height = response.rect.height().max(1.0);
    let (modifiers, seconds) = ui.input(|input| (input.modifiers, input.stable_dt.min(0.1)));
    let drag = response.drag_delta() / height;
    let drag = glam::Vec2::new(drag.x, drag.y);
    let is_dragged = |button| response.dragged_by(button);
    let gesture = if is_dragged(PointerButton::Middle) {
        Some(match (modifiers.shift, modifiers.command) {
            (true, _) => Gesture::Pan,
            (_, true) => Gesture::Dolly,
            _ => {
                if modifiers.alt {
                    Gesture::Pan
                } else {
                    Gesture::Orbit
                }
            }
        })
    } else if modifiers.alt && is_dragged(PointerButton::Secondary) {
        Some(Gesture::Dolly)
    } else if is_dragged(PointerButton::Secondary) {
        Some(Gesture::Look)
    } else if is_dragged(PointerButton::Primary) {
        Some(if modifiers.shift { Gesture::Pan } else { Gesture::Orbit })
    } else {
        None
    };
    match gesture {
        Some(Gesture::Orbit) => orbit(camera, drag * ORBIT),
        Some(Gesture::Pan) => pan(camera, drag),
        Some(Gesture::Dolly) => dolly(camera, DOLLY.powf(drag.y - drag.x)),
        Some(Gesture::Look) => look(camera, drag * LOOK),
        None => {}
    }
    if response.hovered() {
        let wheel = ui.input(|input| input.smooth_scroll_delta().y);
        if wheel != 0.0 {
            dolly(camera, DOLLY.powf(-wheel / WHEEL));
        }
    }
    if gesture == Some(Gesture::Look) {
        let axis = |plus, minus| {
            ui.input(|input| f32::from(u8::from(input.key_down(plus))) - f32::from(u8::from(input.key_down(minus))))
        };
        let way = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
        if way != Vec3::ZERO {
            fly(camera, way * seconds * if modifiers.shift { 8.0 } else { 2.0 });
            ui.ctx().request_repaint();
        }
    }
}

/// Round what it looks at.
pub fn orbit(camera: &mut Camera, angle: glam::Vec2) {
    camera.position = camera.target + turned(camera.position - camera.target, angle);
}

/// Round where it stands.
fn look(camera: &mut Camera, angle: glam::Vec2) {
    camera.target = camera.position + turned(camera.target - camera.position, angle);
}

/// A vector turned about the vertical by x, and up or down by y, never over the top.
fn turned(v: Vec3, angle: glam::Vec2) -> Vec3 {
    let level = Quat::from_rotation_y(-angle.x) * v;
    let side = level.cross(Vec3::Y).normalize_or(Vec3::X);
    let steep = Quat::from_axis_angle(side, -angle.y) * level;
    if steep.normalize_or_zero().y.abs() < STEEPEST { steep } else { level }
}

/// Sideways, so that what it looks at stays under the pointer.
pub fn pan(camera: &mut Camera, share: glam::Vec2) {
    let away = camera.target - camera.position;
    let (right, up) = sides(away);
    let reach = 2.0 * away.length() * (0.5 * camera.fov.to_radians()).tan();
    let by = (up * share.y - right * share.x) * reach;
    camera.position += by;
    camera.target += by;
}

/// Nearer to what it looks at, or away from it.
pub fn dolly(camera: &mut Camera, factor: f32) {
    let away = camera.position - camera.target;
    let distance = (away.length() * factor).clamp(NEAREST, 0.5 * camera.far);
    camera.position = camera.target + away.normalize_or(Vec3::Z) * distance;
}

/// Metres to the right, up and ahead.
fn fly(camera: &mut Camera, way: Vec3) {
    let ahead = (camera.target - camera.position).normalize_or(Vec3::NEG_Z);
    let (right, _) = sides(ahead);
    let by = right * way.x + Vec3::Y * way.y + ahead * way.z;
    camera.position += by;
    camera.target += by;
}

/// Right and up of who looks that way.
fn sides(ahead: Vec3) -> (Vec3, Vec3) {
    let right = ahead.cross(Vec3::Y).normalize_or(Vec3::X);
    (right, right.cross(ahead).normalize_or(Vec3::Y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn an_orbit_keeps_its_distance_and_never_turns_over() {
        let mut camera = Camera::default();
        let distance = camera.position.distance(camera.target);
        for _ in 0..200 {
            orbit(&mut camera, Vec2::new(0.13, 0.11));
            assert!((camera.position.distance(camera.target) - distance).abs() < 1e-3);
            let up = (camera.position - camera.target).normalize().y.abs();
            assert!(up <= STEEPEST);
        }
    }

    #[test]
    fn a_pan_moves_both_and_a_dolly_only_the_camera() {
        let (mut camera, before) = (Camera::default(), Camera::default());
        pan(&mut camera, Vec2::new(0.25, 0.0));
        // The picture goes right with the pointer: the camera left.
        assert!(camera.position.x < before.position.x && camera.target.x < before.target.x);
        assert_eq!(camera.position - camera.target, before.position - before.target);
        dolly(&mut camera, 0.5);
        assert!((camera.position.distance(camera.target) - 0.5 * before.position.distance(before.target)).abs() < 1e-3);
        dolly(&mut camera, 0.0);
        assert!(camera.position.distance(camera.target) >= 0.9 * NEAREST);
    }
}
