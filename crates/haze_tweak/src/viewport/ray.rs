//! Ray from the camera, and its intersections with axes, planes and spheres.

use glam::Vec3;

/// Ray from the camera. `direction` has unit length.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
}

/// Sine of the angle below which a ray counts as parallel to an axis or a plane.
const PARALLEL: f32 = 0.02;

impl Ray {
    /// Returns the distance along an axis of unit length, from `origin`, to the point that is closest to the ray,
    /// metres; `None` if they are parallel.
    pub fn along_axis(&self, origin: Vec3, axis: Vec3) -> Option<f32> {
        let between = origin - self.origin;
        let cosine = axis.dot(self.direction);
        let squared_sine = 1.0 - cosine * cosine;
        (squared_sine > PARALLEL * PARALLEL)
            .then(|| (cosine * self.direction.dot(between) - axis.dot(between)) / squared_sine)
    }

    /// Returns the intersection with a plane through `point`; `None` if it is behind the camera, or the plane is
    /// parallel.
    pub fn on_plane(&self, point: Vec3, normal: Vec3) -> Option<Vec3> {
        let slope = normal.dot(self.direction);
        let metres = normal.dot(point - self.origin) / slope;
        (slope.abs() > PARALLEL && metres > 0.0).then(|| self.origin + self.direction * metres)
    }

    /// Returns true if the ray misses a sphere.
    pub fn passes(&self, center: Vec3, radius: f32) -> bool {
        let closest = self.origin + self.direction * (center - self.origin).dot(self.direction);
        closest.distance_squared(center) > radius * radius
    }

    /// Returns the intersection with a sphere, on its near or far side. A ray that misses gives the closest point of
    /// the rim.
    pub fn on_sphere(&self, center: Vec3, radius: f32, is_before: bool) -> Vec3 {
        let middle = (center - self.origin).dot(self.direction);
        let closest = self.origin + self.direction * middle;
        let half = (radius * radius - closest.distance_squared(center)).max(0.0).sqrt();
        let met = closest + self.direction * if is_before { -half } else { half };
        center + (met - center).normalize_or(Vec3::Y) * radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    fn towards(point: Vec3) -> Ray {
        let origin = vec3(3.0, 2.0, 7.0);
        Ray { origin, direction: (point - origin).normalize() }
    }

    #[test]
    fn a_ray_through_a_point_on_an_axis_finds_that_point() {
        let origin = vec3(0.5, -1.0, 0.25);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, vec3(1.0, -2.0, 0.5).normalize()] {
            for metres in [-3.0, 0.0, 0.7, 12.0] {
                let found = towards(origin + axis * metres).along_axis(origin, axis).unwrap();
                assert!((found - metres).abs() < 1e-3, "{axis}: {found} for {metres}");
            }
        }
        assert_eq!(Ray { origin: Vec3::ZERO, direction: Vec3::Y }.along_axis(vec3(1.0, 0.0, 0.0), Vec3::Y), None);
    }

    #[test]
    fn a_ray_meets_a_plane_unless_it_is_behind_the_camera() {
        let point = vec3(0.0, 1.0, 0.0);
        let normal = vec3(0.3, 1.0, -0.4).normalize();
        let met = point + normal.cross(vec3(0.2, 0.0, 1.0)) * 1.7;
        assert!(towards(met).on_plane(point, normal).unwrap().distance(met) < 1e-4);
        let away = Ray { origin: vec3(0.0, 3.0, 0.0), direction: Vec3::Y };
        assert_eq!(away.on_plane(Vec3::ZERO, Vec3::Y), None);
        assert_eq!(Ray { direction: Vec3::X, ..away }.on_plane(Vec3::ZERO, Vec3::Y), None);
    }

    #[test]
    fn a_ray_meets_either_side_of_a_sphere_and_a_miss_gives_its_rim() {
        let center = vec3(1.0, 1.0, 0.0);
        let radius = 2.0;
        let ray = towards(center + vec3(0.5, 0.2, 0.0));
        let front = ray.on_sphere(center, radius, true);
        let back = ray.on_sphere(center, radius, false);
        for met in [front, back] {
            assert!((met.distance(center) - radius).abs() < 1e-5);
            assert!((met - ray.origin).normalize().distance(ray.direction) < 1e-5);
        }
        assert!(front.distance(ray.origin) < back.distance(ray.origin));
        let beside = towards(center + vec3(9.0, 0.0, 0.0)).on_sphere(center, radius, true);
        assert!((beside.distance(center) - radius).abs() < 1e-5 && beside.x > center.x);
    }
}
