//! Shots that show one layer of the smoke of another: particles' numbers, or the light of fire alone.

use glam::Vec3;
use haze_core::settings::{Settings, SoftScatterMode};
use haze_preset::{Preset, SceneName};

use super::particle_scalar::{ParticleScalar, ShownScalar};
use super::shot::Shot;

impl Shot {
    /// Returns the shot without its scene, in even light. Its image is that of the light that its settings leave.
    pub fn without_light(&self) -> Self {
        let mut shot = self.clone();
        let Preset { environment, lights, systems, .. } = &mut shot.preset;
        environment.scene = SceneName::Empty;
        environment.zenith = Vec3::ZERO;
        environment.horizon = Vec3::ZERO;
        lights.clear();
        for Settings { diffuse, soft_scatter, specular_scatter, shadow, ambient, .. } in
            systems.iter_mut().map(|system| &mut system.settings)
        {
            diffuse.intensity = 0.0;
            ambient.intensity = 0.0;
            soft_scatter.intensity = 0.0;
            specular_scatter.intensity = 0.0;
            shadow.strength = 0.0;
        }
        shot
    }

    /// Returns a shot whose image shows a scalar, for [`ShownScalar::values`]; `None` if no particle is visible.
    pub fn showing(&self, scalar: ParticleScalar) -> Option<(Self, ShownScalar)> {
        let view = self.preset.camera.view(self.size);
        let mut values = Vec::new();
        for (index, ((particles, _), system)) in self.systems().iter().zip(&self.preset.systems).enumerate() {
            let cache = self.caches.get(index).and_then(Option::as_ref);
            let displacements = self.displacements(system, cache, particles, scalar.seconds());
            let visible = particles.iter().zip(displacements).filter(|(particle, _)| particle.is_visible());
            values.extend(visible.map(|(particle, displacement)| scalar.of(particle, displacement, &view)));
        }
        let finite = values.into_iter().filter(|value| value.is_finite());
        let (low, high) =
            finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            return None;
        }
        // Particles that pass close by the camera would take the precision of all others.
        let most = match scalar {
            ParticleScalar::ViewDepth => self.preset.camera.far,
            _ => self.size.max_element() as f32,
        };
        let low = low.clamp(-most, most);
        let high = high.clamp(-most, most);
        let shown = ShownScalar { scalar, low, high: high.max(low + 1.0e-3) };
        let mut shot = self.without_light();
        for settings in shot.preset.systems.iter_mut().map(|system| &mut system.settings) {
            settings.fire.intensity = 0.0;
            settings.sprite.tint = 1.0;
            settings.sprite.age_color = 0.0;
            let scatter = &mut settings.soft_scatter;
            scatter.mode = SoftScatterMode::Smoothstep;
            scatter.intensity = 1.0;
            scatter.scatter_color = Vec3::ONE;
            scatter.ambient_color = Vec3::ONE;
        }
        shot.shown_scalar = Some(shown);
        Some((shot, shown))
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use haze_core::frame::Particle;

    use super::*;

    /// The scalar of a particle from the camera's position, direction and field of view, without matrices.
    fn by_hand(shot: &Shot, scalar: ParticleScalar, position: Vec3, displacement: Vec3) -> f32 {
        let camera = &shot.preset.camera;
        let forward = (camera.target - camera.position).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let depth = |point: Vec3| (point - camera.position).dot(forward);
        // Square pixels: the height of the view is that of its field of view.
        let pixels = 0.5 * shot.size.y as f32 / (0.5 * camera.fov.to_radians()).tan();
        let along = |axis: Vec3| {
            let pixel = |point: Vec3| (point - camera.position).dot(axis) / depth(point) * pixels;
            pixel(position + displacement) - pixel(position)
        };
        match scalar {
            ParticleScalar::ViewDepth => depth(position),
            ParticleScalar::MotionRight(_) => along(right),
            ParticleScalar::MotionUp(_) => along(right.cross(forward)),
        }
    }

    /// A shot with one particle of a velocity.
    fn one_particle(velocity: Vec3) -> Shot {
        let mut shot = Shot::load("column", UVec2::new(64, 48)).unwrap();
        let system = &mut shot.preset.systems[0];
        let emitter = &mut system.emitter;
        *emitter = haze_core::emitter::Emitter::default();
        emitter.rate = 1.0;
        emitter.lifetime = 9.0;
        emitter.lifetime_spread = 0.0;
        emitter.duration = 1.0;
        emitter.velocity = velocity;
        emitter.velocity_spread = 0.0;
        emitter.wind = Vec3::ZERO;
        emitter.buoyancy = 0.0;
        emitter.turbulence = 0.0;
        emitter.drag = 0.0;
        shot.preset.time = 2.0;
        shot
    }

    #[test]
    fn depth_and_motion_of_one_particle_are_those_of_its_projection() {
        let velocity = Vec3::new(0.8, 1.5, -0.4);
        let shot = one_particle(velocity);
        let particles = shot.systems().remove(0).0;
        let [particle] = &particles[..] else { panic!("{} particles", particles.len()) };
        for scalar in [ParticleScalar::ViewDepth, ParticleScalar::MotionRight(0.1), ParticleScalar::MotionUp(0.1)] {
            let expected = by_hand(&shot, scalar, particle.position, velocity * 0.1);
            // The range of one particle's values is empty; a wider one lets the image show the value.
            let (mut shown_shot, mut shown) = shot.showing(scalar).unwrap();
            shown.low = expected - 8.0;
            shown.high = expected + 8.0;
            shown_shot.shown_scalar = Some(shown);
            let image = shown.values(&shown_shot.render_on_cpu().unwrap());
            let found: Vec<f32> = image.texels.iter().copied().flatten().collect();
            assert!(found.len() > 20, "{} pixels", found.len());
            for value in found {
                // Sixteen bits resolve a 4096th of the range of 16; half floats of the target lose some of them.
                assert!((value - expected).abs() < 0.02, "{scalar:?}: {value}, not {expected}");
            }
        }
    }

    #[test]
    fn motion_leads_particles_to_where_they_are_in_the_next_frame() {
        let shot = Shot::load("column", UVec2::new(64, 48)).unwrap();
        let seconds = 0.1;
        let system = &shot.preset.systems[0];
        let now = shot.systems().remove(0).0;
        let ways = shot.displacements(system, None, &now, seconds);
        assert_eq!(now.len(), ways.len());
        let mut later = shot.clone();
        later.preset.time += f64::from(seconds);
        let then = later.systems().remove(0).0;
        let is_there = |(particle, way): &(&Particle, &Vec3)| {
            then.iter().any(|other| other.position.distance(particle.position + **way) < 1.0e-4)
        };
        let found = now.iter().zip(&ways).filter(is_there).count();
        // The others are at the end of their lives.
        assert!(found < now.len() && found * 100 > now.len() * 95, "{found} of {}", now.len());
    }
}
