//! Projection between world and window for the preset's camera.

use eframe::egui::{Pos2, Rect, Vec2, vec2};
use glam::Vec3;
use haze_preset::Camera;

use super::camera_moves::sides;
use super::ray::Ray;

/// Camera, and the rectangle of its image in the window.
#[derive(Clone, Copy, Debug)]
pub struct ScreenProjection {
    pub rect: Rect,
    pub eye: Vec3,
    pub right: Vec3,
    pub up: Vec3,
    pub ahead: Vec3,
    near: f32,
    /// Tangents of half the field of view, horizontal and vertical.
    reach: Vec2,
    /// Center and radius of the sphere on which suns are shown: around the camera's target, of constant size in the
    /// image.
    pub sun_sphere: (Vec3, f32),
}

/// Radius of the sun sphere relative to half the image's height at the target. Below 1, so that the camera is never inside
/// it.
const SUN_SPHERE_RADIUS: f32 = 0.7;

impl ScreenProjection {
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        let ahead = (camera.target - camera.position).normalize_or(Vec3::NEG_Z);
        let (right, up) = sides(ahead);
        let tangent = (0.5 * camera.fov.to_radians()).tan();
        let reach = vec2(tangent * rect.aspect_ratio(), tangent);
        let sun_sphere =
            (camera.target, SUN_SPHERE_RADIUS * tangent.min(1.0) * camera.position.distance(camera.target));
        Self { rect, eye: camera.position, right, up, ahead, near: camera.near, reach, sun_sphere }
    }

    /// Returns the distance in front of the camera along its axis, metres.
    pub fn depth(&self, point: Vec3) -> f32 {
        (point - self.eye).dot(self.ahead)
    }

    /// Returns the window position of a point; `None` in front of the near plane.
    pub fn project(&self, point: Vec3) -> Option<Pos2> {
        let depth = self.depth(point);
        (depth >= self.near).then(|| {
            let offset = (point - self.eye) / depth;
            let fraction = vec2(offset.dot(self.right) / self.reach.x, -offset.dot(self.up) / self.reach.y);
            self.rect.center() + 0.5 * self.rect.size() * fraction
        })
    }

    /// Returns the window positions of a line's ends, clipped at the near plane.
    pub fn segment(&self, from: Vec3, to: Vec3) -> Option<[Pos2; 2]> {
        // Slightly behind the near plane, so that rounding does not drop the end.
        let near = self.near * 1.001;
        let depths = [self.depth(from), self.depth(to)];
        let cut = |point: Vec3, depth: f32| {
            if depth >= near { point } else { from.lerp(to, (near - depths[0]) / (depths[1] - depths[0])) }
        };
        if depths[0].max(depths[1]) < near {
            return None;
        }
        Some([self.project(cut(from, depths[0]))?, self.project(cut(to, depths[1]))?])
    }

    /// Returns the ray through a position in the window.
    pub fn ray(&self, at: Pos2) -> Ray {
        let fraction = (at - self.rect.center()) / (0.5 * self.rect.size());
        let direction = self.ahead + self.right * (fraction.x * self.reach.x) - self.up * (fraction.y * self.reach.y);
        Ray { origin: self.eye, direction: direction.normalize_or(self.ahead) }
    }

    /// Returns the point under a position in the window, on the plane through `point` that faces the camera.
    pub fn unproject_to_facing_plane(&self, at: Pos2, point: Vec3) -> Vec3 {
        self.ray(at).on_plane(point, self.ahead).unwrap_or(point)
    }

    /// Returns the metres that one point of the window covers at the depth of `at`.
    pub fn metres_per_point(&self, at: Vec3) -> f32 {
        2.0 * self.depth(at).max(self.near) * self.reach.y / self.rect.height().max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;
    use glam::{UVec2, vec3};

    fn cameras() -> [Camera; 3] {
        let from = |position, target| Camera { position, target, ..Camera::default() };
        [
            Camera::default(),
            from(vec3(3.0e3, 12.0, -40.0), vec3(2.99e3, 11.0, -44.0)),
            from(vec3(1.0, 9.0, 0.0), vec3(1.0, 0.0, 0.0)),
        ]
    }

    #[test]
    fn a_projected_point_matches_the_image_and_can_be_unprojected() {
        let rect = Rect::from_min_size(pos2(37.0, 81.0), vec2(640.0, 360.0));
        for camera in cameras() {
            let projection = ScreenProjection::new(&camera, rect);
            let view = camera.view(UVec2::new(640, 360));
            for (x, y, depth) in [(0.0, 0.0, 3.0), (0.8, -0.3, 1.0), (-2.0, 0.9, 11.0)] {
                let point = projection.eye + projection.ahead * depth + projection.right * x + projection.up * y;
                let seen = projection.project(point).unwrap();
                let ndc = (view.clip_from_view * view.view_from_world).project_point3(point);
                let drawn = pos2(37.0 + 320.0 * (1.0 + ndc.x), 81.0 + 180.0 * (1.0 - ndc.y));
                assert!(seen.distance(drawn) < 1.0, "{seen} is drawn at {drawn}");
                assert!(projection.unproject_to_facing_plane(seen, point).distance(point) < depth * 1e-3);
            }
        }
    }

    #[test]
    fn lines_are_clipped_at_the_near_plane() {
        let projection = ScreenProjection::new(&Camera::default(), Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0)));
        let behind = projection.eye - projection.ahead + projection.right;
        let ahead = projection.eye + projection.ahead * 4.0;
        assert_eq!((projection.project(behind), projection.segment(behind, behind - projection.ahead)), (None, None));
        let [cut, end] = projection.segment(behind, ahead).unwrap();
        assert!(end.distance(projection.rect.center()) < 1e-3 && cut.x > end.x && cut.x.is_finite());
    }
}
