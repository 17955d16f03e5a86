//! Camera moves: orbit, look, pan, dolly, fly, frame.

use glam::{Quat, Vec2, Vec3};
use haze::Bounds;
use haze_preset::Camera;

/// Least distance between the camera and its target, metres.
const MIN_DISTANCE: f32 = 0.05;
/// Largest absolute y of a unit view direction; 1 is straight up or down.
const MAX_ABS_Y: f32 = 0.9995;

/// Orbits about the target; angles in radians to the side and up.
pub fn orbit(camera: &mut Camera, angle: Vec2) {
    camera.position = camera.target + turned(camera.position - camera.target, angle);
}

/// Turns the view about the camera's position; angles in radians.
pub fn look(camera: &mut Camera, angle: Vec2) {
    camera.target = camera.position + turned(camera.target - camera.position, angle);
}

/// Returns a vector rotated about the vertical by x, and up or down by y, but never past the vertical.
fn turned(v: Vec3, angle: Vec2) -> Vec3 {
    let level = Quat::from_rotation_y(-angle.x) * v;
    let side = level.cross(Vec3::Y).normalize_or(Vec3::X);
    let steep = Quat::from_axis_angle(side, -angle.y) * level;
    let steepness = |v: Vec3| v.normalize_or_zero().y.abs();
    if steepness(steep) < steepness(level).max(MAX_ABS_Y) { steep } else { level }
}

/// Moves camera and target by fractions of the image height, so that the target stays under the pointer.
pub fn pan(camera: &mut Camera, fraction: Vec2) {
    let away = camera.target - camera.position;
    let (right, up) = sides(away.normalize_or(Vec3::NEG_Z));
    let reach = 2.0 * away.length() * (0.5 * camera.fov.to_radians()).tan();
    shift(camera, (up * fraction.y - right * fraction.x) * reach);
}

/// Scales the distances of camera and target to a point by a factor. The point stays at its position in the image.
pub fn dolly(camera: &mut Camera, point: Vec3, factor: f32) {
    let distance = camera.position.distance(camera.target).max(1.0e-6);
    let factor = factor.clamp(MIN_DISTANCE / distance, (0.5 * camera.far).max(MIN_DISTANCE) / distance);
    camera.position = point + (camera.position - point) * factor;
    camera.target = point + (camera.target - point) * factor;
}

/// Moves camera and target to the right, up and ahead, metres.
pub fn fly(camera: &mut Camera, way: Vec3) {
    let ahead = (camera.target - camera.position).normalize_or(Vec3::NEG_Z);
    let (right, _) = sides(ahead);
    shift(camera, right * way.x + Vec3::Y * way.y + ahead * way.z);
}

/// Frames a box in an image of an aspect ratio, without turning the camera.
pub fn frame(camera: &mut Camera, bounds: &Bounds, aspect: f32) {
    let tangent = (0.5 * camera.fov.to_radians()).tan();
    let center = bounds.center();
    let half = 0.5 * (bounds.max - bounds.min);
    let ahead = (camera.target - camera.position).normalize_or(Vec3::NEG_Z);
    let (right, up) = sides(ahead);
    // Distance from the box's center to the camera at which a corner is just in view.
    let distance = |corner: Vec3| {
        let side = corner.dot(right).abs() / (tangent * aspect.max(0.01));
        side.max(corner.dot(up).abs() / tangent).max(camera.near) - corner.dot(ahead)
    };
    let corners =
        (0..8).map(|corner| half * Vec3::from([1, 2, 4].map(|bit| if corner & bit == 0 { -1.0 } else { 1.0 })));
    let farthest = 1.08 * corners.map(distance).fold(MIN_DISTANCE, f32::max);
    camera.position = center - ahead * farthest.clamp(MIN_DISTANCE, (0.5 * camera.far).max(MIN_DISTANCE));
    camera.target = center;
}

/// Looks at the same target from another direction, at the same distance.
pub fn face(camera: &mut Camera, from: Vec3) {
    camera.position = camera.target + from * camera.position.distance(camera.target);
}

/// Returns the right and up vectors of a view direction, as in [`Camera::view`].
pub fn sides(ahead: Vec3) -> (Vec3, Vec3) {
    let right = ahead.cross(Vec3::Y).normalize_or(Vec3::X);
    (right, right.cross(ahead).normalize_or(Vec3::Y))
}

fn shift(camera: &mut Camera, by: Vec3) {
    camera.position += by;
    camera.target += by;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orbit_keeps_its_distance_and_never_passes_the_vertical() {
        let mut camera = Camera::default();
        let distance = camera.position.distance(camera.target);
        for _ in 0..200 {
            orbit(&mut camera, Vec2::new(0.13, 0.11));
            assert!((camera.position.distance(camera.target) - distance).abs() < 1e-3);
            let up = (camera.position - camera.target).normalize().y.abs();
            assert!(up <= MAX_ABS_Y);
        }
    }

    #[test]
    fn a_camera_straight_above_can_orbit_down() {
        let mut camera = Camera::default();
        face(&mut camera, Vec3::Y);
        let distance = camera.position.distance(camera.target);
        orbit(&mut camera, Vec2::new(0.0, -0.01));
        let back = (camera.position - camera.target) / distance;
        assert!(back.y < 1.0 && back.z > 0.0, "{back}");
    }

    #[test]
    fn a_pan_moves_camera_and_target_and_a_dolly_keeps_its_point_in_place() {
        let mut camera = Camera::default();
        let before = Camera::default();
        pan(&mut camera, Vec2::new(0.25, 0.0));
        // The image follows the pointer to the right, so the camera moves left.
        assert!(camera.position.x < before.position.x && camera.target.x < before.target.x);
        assert_eq!(camera.position - camera.target, before.position - before.target);
        let point = camera.target + Vec3::new(0.4, 0.3, 0.0);
        let seen = |camera: &Camera| (point - camera.position).normalize();
        let seen_before = seen(&camera);
        dolly(&mut camera, point, 0.5);
        assert!((camera.position.distance(camera.target) - 0.5 * before.position.distance(before.target)).abs() < 1e-3);
        assert!(seen(&camera).distance(seen_before) < 1e-5);
        dolly(&mut camera, before.target, 0.0);
        assert!(camera.position.distance(camera.target) >= 0.9 * MIN_DISTANCE);
    }

    #[test]
    fn a_framed_box_fits_the_narrower_side() {
        let bounds = Bounds { min: Vec3::new(2.0, 0.0, -3.0), max: Vec3::new(4.0, 6.0, -2.0) };
        for aspect in [0.2, 1.0, 2.0] {
            let mut camera = Camera::default();
            orbit(&mut camera, Vec2::new(0.4, 0.3));
            frame(&mut camera, &bounds, aspect);
            let view = camera.view(glam::UVec2::new((1000.0 * aspect) as u32, 1000));
            let clip_from_world = view.clip_from_view * view.view_from_world;
            let corners = (0..8).map(|i| {
                let pick = |bit: u32, axis: usize| if i & bit == 0 { bounds.min[axis] } else { bounds.max[axis] };
                clip_from_world.project_point3(Vec3::new(pick(1, 0), pick(2, 1), pick(4, 2)))
            });
            let outermost = corners.map(|ndc| ndc.x.abs().max(ndc.y.abs())).fold(0.0, f32::max);
            assert!((0.85..1.0).contains(&outermost), "{aspect}: {outermost}");
        }
    }
}
