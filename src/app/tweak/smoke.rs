//! Where the smoke is at the time that is shown.

use glam::Vec3;
use haze::frame::bounds_of;
use haze::preset::{Camera, Preset, PresetSystem};
use haze::{Bounds, Light, LightKind, Particle};

/// The smoke of a preset; evaluated again when its systems or the time are others.
#[derive(Default)]
pub struct Smoke {
    /// And the bits of the time.
    of: Option<(Vec<PresetSystem>, u32)>,
    pub systems: Vec<Vec<Particle>>,
    /// Of each system, sprites included.
    pub bounds: Vec<Bounds>,
}

impl Smoke {
    pub fn at(&mut self, preset: &Preset, time: f32) -> &Self {
        let is_same = self.of.as_ref().is_some_and(|(systems, at)| *at == time.to_bits() && *systems == preset.systems);
        // What cannot be drawn might have too many particles; the last good ones stay.
        if !is_same && preset.validate().is_ok() {
            self.of = Some((preset.systems.clone(), time.to_bits()));
            self.systems.resize_with(preset.systems.len(), Vec::new);
            for (system, particles) in preset.systems.iter().zip(&mut self.systems) {
                particles.clear();
                system.particles(time, particles);
            }
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

/// Puts a light behind the middle of the smoke, as a camera sees it, a bit outside the box; a spot or sun shines at the smoke.
pub fn put_behind(light: &mut Light, camera: &Camera, bounds: &Bounds) {
    let (centre, half) = (bounds.centre(), 0.5 * (bounds.max - bounds.min));
    let away = (centre - camera.position).normalize_or(Vec3::NEG_Z);
    // To where the line leaves the box.
    let leaves = (0..3).map(|axis| half[axis] / away[axis].abs().max(1.0e-6)).fold(f32::INFINITY, f32::min);
    if light.kind != LightKind::Directional {
        light.position = centre + away * (1.1 * leaves + 0.2);
    }
    if light.kind != LightKind::Point {
        light.direction = -away;
    }
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
}
