//! Where the smoke is at the time that is shown.

use glam::Vec3;
use haze::cache::Cache;
use haze::frame::bounds_of;
use haze::preset::{Camera, Preset, PresetSystem};
use haze::{Bounds, Light, LightKind, Particle};

use super::session::Session;

/// The smoke of a preset; evaluated again when its systems or the time are others.
#[derive(Default)]
pub struct Smoke {
    /// With the bits of the time.
    of: Option<(Vec<PresetSystem>, Vec<Option<Cache>>, u32)>,
    pub systems: Vec<Vec<Particle>>,
    /// Of each system, sprites included.
    pub bounds: Vec<Bounds>,
}

impl Smoke {
    /// What a session shows.
    pub fn of(&mut self, session: &Session) -> &Self {
        self.at(&session.document.preset, session.caches(), session.playback.time)
    }

    fn at(&mut self, preset: &Preset, caches: Vec<Option<Cache>>, time: f32) -> &Self {
        let is_same = self.of.as_ref().is_some_and(|(systems, its, at)| {
            *at == time.to_bits() && *systems == preset.systems && Cache::all_shared(its, &caches)
        });
        // What cannot be drawn might have too many particles; the last good ones stay.
        if !is_same && preset.validate().is_ok() {
            self.systems.resize_with(preset.systems.len(), Vec::new);
            for ((system, cache), particles) in preset.systems.iter().zip(&caches).zip(&mut self.systems) {
                system.particles(cache.as_ref(), time, particles);
            }
            self.of = Some((preset.systems.clone(), caches, time.to_bits()));
            let all = preset.systems.iter().zip(&self.systems);
            self.bounds = all.map(|(system, particles)| bounds_of(particles, system.settings.reach())).collect();
        }
        self
    }

    /// The box round all of it; a puff where there is none.
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
}

/// Lowest place of a light that is put somewhere, metres: above the ground.
const LOWEST: f32 = 0.2;

/// Puts a light behind the middle of the smoke, as a camera sees it, a bit outside the box; a spot or sun shines at the smoke.
pub fn put_behind(light: &mut Light, camera: &Camera, bounds: &Bounds) {
    let centre = bounds.centre();
    let away = (centre - camera.position).normalize_or(Vec3::NEG_Z);
    if light.kind == LightKind::Directional {
        light.direction = -away;
        return;
    }
    light.position = beyond(bounds, away);
    if light.position.y < LOWEST {
        // The way down ends in the ground: it goes on along that.
        light.position = beyond(bounds, away.with_y(0.0).normalize_or(Vec3::NEG_Z)).with_y(LOWEST);
    }
    if light.kind == LightKind::Spot {
        light.direction = (centre - light.position).normalize_or(-away);
    }
}

/// A bit outside a box, from its middle in a direction.
fn beyond(bounds: &Bounds, way: Vec3) -> Vec3 {
    let half = 0.5 * (bounds.max - bounds.min);
    let leaves = (0..3).map(|axis| half[axis] / way[axis].abs().max(1.0e-6)).fold(f32::INFINITY, f32::min);
    bounds.centre() + way * (1.1 * leaves + 0.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_behind_the_smoke_is_hidden_by_its_middle_and_outside_its_box() {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.0, -2.0), max: Vec3::new(1.5, 5.0, 1.0) };
        let camera = Camera { position: Vec3::new(4.0, 1.0, 6.0), ..Camera::default() };
        for &kind in LightKind::ALL {
            let mut light = Light { kind, ..Light::default() };
            put_behind(&mut light, &camera, &bounds);
            let away = (bounds.centre() - camera.position).normalize();
            if kind != LightKind::Directional {
                let seen = light.position - camera.position;
                assert!(seen.normalize().distance(away) < 1e-5 && seen.length() > 1.0);
                let is_inside = light.position.cmpge(bounds.min) & light.position.cmple(bounds.max);
                assert!(!is_inside.all(), "{}", light.position);
            }
            if kind != LightKind::Point {
                assert!(light.direction.distance(-away) < 1e-5);
            }
        }
    }

    #[test]
    fn seen_from_above_a_light_behind_the_smoke_stays_above_the_ground() {
        let bounds = Bounds { min: Vec3::new(-1.0, 0.0, -2.0), max: Vec3::new(1.5, 5.0, 1.0) };
        for position in [Vec3::new(4.0, 9.0, 6.0), Vec3::new(0.25, 20.0, -0.5), Vec3::new(0.3, 6.0, 0.0)] {
            let camera = Camera { position, ..Camera::default() };
            let mut light = Light { kind: LightKind::Spot, ..Light::default() };
            put_behind(&mut light, &camera, &bounds);
            assert!(light.position.y >= LOWEST, "{}", light.position);
            // Outside the box, at the far side of it, and shining at its middle.
            assert!(light.position.x < bounds.min.x || light.position.z < bounds.min.z, "{}", light.position);
            let to_middle = (bounds.centre() - light.position).normalize();
            assert!(light.direction.distance(to_middle) < 1e-5, "{}", light.direction);
        }
    }
}
