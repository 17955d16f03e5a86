//! Extent of the smoke at the shown time.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze::{Bounds, Light, LightKind, Particle};
use haze_author::particle_files::{self, ParticleFrames};
use haze_core::frame::{SpriteExtent, particle_bounds};
use haze_preset::{Camera, Preset, PresetSystem};

/// Particles and bounds of a preset's systems, cached until the systems or the time change.
#[derive(Default)]
pub struct SmokeGeometry {
    /// Key of the cache: systems, particle files, and the bits of the time.
    of: Option<(Vec<PresetSystem>, Vec<Option<ParticleFrames>>, u64)>,
    pub systems: Vec<Vec<Particle>>,
    /// Bounds of each system, sprites included.
    pub bounds: Vec<Bounds>,
}

impl SmokeGeometry {
    /// Returns the smoke of a preset at a time. `caches`: particles of the systems that have particle files.
    pub fn at(&mut self, preset: &Preset, caches: Vec<Option<ParticleFrames>>, time: f64) -> &Self {
        let is_same = self.of.as_ref().is_some_and(|(systems, its, at)| {
            *at == time.to_bits() && *systems == preset.systems && ParticleFrames::share_all_memory(its, &caches)
        });
        // An invalid preset might have too many particles, so the last valid ones stay.
        if !is_same && preset.validate().is_ok() {
            self.systems.resize_with(preset.systems.len(), Vec::new);
            for ((system, cache), particles) in preset.systems.iter().zip(&caches).zip(&mut self.systems) {
                particle_files::particles(system, cache.as_ref(), time, particles);
            }
            self.of = Some((preset.systems.clone(), caches, time.to_bits()));
            let all = preset.systems.iter().zip(&self.systems);
            self.bounds = all
                .map(|(system, particles)| particle_bounds(particles, SpriteExtent::from_settings(&system.settings)))
                .collect();
        }
        self
    }

    /// Returns the box around all systems, or around a single puff if there are no particles.
    pub fn bounds(&self) -> Bounds {
        let mut all = Bounds::EMPTY;
        for bounds in self.bounds.iter().filter(|bounds| !bounds.is_empty()) {
            all.include(bounds.min, 0.0);
            all.include(bounds.max, 0.0);
        }
        if all.is_empty() {
            all.include(Vec3::Y, 1.0);
        }
        all
    }

    /// Returns the center of the smoke that is inside an image of this size, weighted by coverage. If there is none,
    /// returns the center of all smoke.
    pub fn visible_center(&self, camera: &Camera, size: UVec2) -> Vec3 {
        let view = camera.view(size);
        let clip_from_world = view.clip_from_view * view.view_from_world;
        let is_seen = |particle: &&Particle| {
            let clip = clip_from_world * particle.position.extend(1.0);
            clip.w > camera.near && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w
        };
        mean_position(self.systems.iter().flatten().filter(is_seen)).unwrap_or_else(|| self.bounds().center())
    }

    /// Returns the point on a ray where the smoke that it crosses has its center. `way` has unit length.
    pub fn center_on_ray(&self, eye: Vec3, way: Vec3) -> Option<Vec3> {
        let is_met = |particle: &&Particle| {
            let far = (particle.position - eye).dot(way);
            far > 0.0 && particle.position.distance(eye + way * far) < particle.radius
        };
        let middle = mean_position(self.systems.iter().flatten().filter(is_met))?;
        Some(eye + way * (middle - eye).dot(way))
    }
}

/// Returns the mean position of particles weighted by coverage; `None` if they cover nothing.
fn mean_position<'a>(particles: impl Iterator<Item = &'a Particle>) -> Option<Vec3> {
    let mut sum = Vec4::ZERO;
    for particle in particles {
        sum += particle.position.extend(1.0) * (particle.amount * particle.radius * particle.radius);
    }
    (sum.w > 0.0).then(|| sum.xyz() / sum.w)
}

/// Lowest height of a light that is placed automatically, metres above the ground.
const MIN_HEIGHT: f32 = 0.2;

/// Puts a light behind a point of the smoke as seen from `eye`, slightly outside all boxes there. A spot or sun points
/// at it.
pub fn place_behind(light: &mut Light, eye: Vec3, point: Vec3, boxes: &[Bounds]) {
    let away = (point - eye).normalize_or(Vec3::NEG_Z);
    if light.kind == LightKind::Directional {
        light.direction = -away;
        return;
    }
    light.position = point_behind(boxes, point, away);
    if light.position.y < MIN_HEIGHT {
        // The ray ends in the ground, so the light is placed along the horizontal direction.
        light.position = point_behind(boxes, point, away.with_y(0.0).normalize_or(Vec3::NEG_Z)).with_y(MIN_HEIGHT);
    }
    if light.kind == LightKind::Spot {
        light.direction = (point - light.position).normalize_or(-away);
    }
}

/// Returns a point slightly beyond the last of the boxes that a ray crosses.
fn point_behind(boxes: &[Bounds], point: Vec3, way: Vec3) -> Vec3 {
    let left = boxes.iter().filter_map(|bounds| exit_distance(bounds, point, way)).fold(0.0, f32::max);
    point + way * (1.1 * left + 0.2)
}

/// Returns the distance along a ray at which it leaves a box, metres; `None` if it misses the box.
fn exit_distance(bounds: &Bounds, point: Vec3, way: Vec3) -> Option<f32> {
    let mut from = 0.0_f32;
    let mut to = f32::INFINITY;
    for axis in 0..3 {
        // Avoids a division by 0 for a ray parallel to a side.
        let slope = if way[axis].abs() < 1.0e-6 { 1.0e-6 } else { way[axis] };
        let ends = [bounds.min[axis], bounds.max[axis]].map(|end| (end - point[axis]) / slope);
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from <= to).then_some(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: Vec3::new(-1.0, 0.0, -2.0), max: Vec3::new(1.5, 5.0, 1.0) };

    #[test]
    fn a_light_behind_a_point_is_occluded_and_outside_the_box() {
        let eye = Vec3::new(4.0, 1.0, 6.0);
        for &kind in LightKind::ALL {
            for point in [BOX.center(), Vec3::new(0.9, 4.5, 0.8), Vec3::new(-0.8, 2.0, -1.0)] {
                let mut light = Light { kind, ..Light::default() };
                place_behind(&mut light, eye, point, &[BOX]);
                let away = (point - eye).normalize();
                if kind != LightKind::Directional {
                    let seen = light.position - eye;
                    assert!(seen.normalize().distance(away) < 1e-5 && seen.length() > point.distance(eye));
                    let is_inside = light.position.cmpge(BOX.min) & light.position.cmple(BOX.max);
                    assert!(!is_inside.all(), "{}", light.position);
                }
                if kind != LightKind::Point {
                    assert!(light.direction.distance(-away) < 1e-5);
                }
            }
        }
        // Beyond another box behind it, but not beyond one beside it.
        let mut light = Light::default();
        let moved = |by: Vec3| Bounds { min: BOX.min + by, max: BOX.max + by };
        let eye = Vec3::new(0.0, 2.0, 9.0);
        let point = Vec3::new(0.0, 2.0, 0.0);
        let mut put = |by: Vec3| {
            place_behind(&mut light, eye, point, &[BOX, moved(by)]);
            light.position.z
        };
        assert!(put(Vec3::NEG_Z * 10.0) < -12.0 && (-3.0..-2.0).contains(&put(Vec3::X * 10.0)));
    }

    #[test]
    fn a_light_put_behind_smoke_seen_from_above_stays_above_the_ground() {
        for eye in [Vec3::new(4.0, 9.0, 6.0), Vec3::new(0.25, 20.0, -0.5), Vec3::new(0.3, 6.0, 0.0)] {
            let mut light = Light { kind: LightKind::Spot, ..Light::default() };
            place_behind(&mut light, eye, BOX.center(), &[BOX]);
            assert!(light.position.y >= MIN_HEIGHT, "{}", light.position);
            // Outside the box, on its far side, and pointing at its center.
            assert!(light.position.x < BOX.min.x || light.position.z < BOX.min.z, "{}", light.position);
            let to_middle = (BOX.center() - light.position).normalize();
            assert!(light.direction.distance(to_middle) < 1e-5, "{}", light.direction);
        }
    }

    #[test]
    fn the_visible_center_ignores_smoke_outside_the_image_and_a_ray_finds_only_smoke_on_it() {
        let at = |x, y, z| Particle { position: Vec3::new(x, y, z), radius: 0.5, ..Particle::default() };
        let near = [at(0.5, 2.0, 0.0), at(-0.5, 2.0, 0.0)];
        // Above the upper edge, and behind the camera.
        let far = [at(0.0, 40.0, 0.0), at(0.0, 2.0, 20.0)];
        let smoke = |systems: [&[Particle]; 2]| SmokeGeometry {
            systems: systems.map(<[_]>::to_vec).into(),
            ..SmokeGeometry::default()
        };
        let camera = Camera::default();
        let size = UVec2::new(160, 90);
        assert!(smoke([&near, &far]).visible_center(&camera, size).distance(Vec3::new(0.0, 2.0, 0.0)) < 1e-4);
        let none = smoke([&far, &[]]);
        assert_eq!(none.visible_center(&camera, size), none.bounds().center());
        let eye = Vec3::new(0.5, 2.0, 8.0);
        let behind = [at(0.6, 2.0, -4.0)];
        let met = smoke([&near, &behind]).center_on_ray(eye, Vec3::NEG_Z).unwrap();
        assert!(met.distance(Vec3::new(0.5, 2.0, -2.0)) < 1e-4, "{met}");
        assert_eq!(smoke([&near, &far]).center_on_ray(eye, Vec3::X), None);
    }
}
