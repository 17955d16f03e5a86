//! Shots that show one layer of the smoke of another: particles' numbers, or the light of fire alone.

use glam::Vec3;
use haze::preset::{Preset, SceneName};
use haze::settings::{Settings, SoftScatterMode};

use super::particle_scalar::{ParticleScalar, ShownScalar};
use super::shot::Shot;

impl Shot {
    /// Returns the shot without its scene, in even light. Its image is that of the light that its settings leave.
    pub fn without_light(&self) -> Self {
        let mut shot = self.clone();
        let Preset { environment, lights, systems, .. } = &mut shot.preset;
        environment.scene = SceneName::Empty;
        (environment.zenith, environment.horizon) = (Vec3::ZERO, Vec3::ZERO);
        lights.clear();
        for Settings { diffuse, soft_scatter, specular_scatter, shadow, ambient, .. } in
            systems.iter_mut().map(|system| &mut system.settings)
        {
            (diffuse.intensity, ambient.intensity) = (0.0, 0.0);
            (soft_scatter.intensity, specular_scatter.intensity, shadow.strength) = (0.0, 0.0, 0.0);
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
        let (low, high) = (low.clamp(-most, most), high.clamp(-most, most));
        let shown = ShownScalar { scalar, low, high: high.max(low + 1.0e-3) };
        let mut shot = self.without_light();
        for settings in shot.preset.systems.iter_mut().map(|system| &mut system.settings) {
            settings.fire.intensity = 0.0;
            (settings.sprite.tint, settings.sprite.age_color) = (1.0, 0.0);
            let scatter = &mut settings.soft_scatter;
            (scatter.mode, scatter.intensity) = (SoftScatterMode::Smoothstep, 1.0);
            (scatter.scatter_color, scatter.ambient_color) = (Vec3::ONE, Vec3::ONE);
        }
        shot.shown_scalar = Some(shown);
        Some((shot, shown))
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use haze::assets::image::Image;
    use haze::frame::{Particle, View};

    use super::*;

    fn mean(shot: &Shot, scalar: ParticleScalar) -> Image<Option<f32>> {
        let (shot, shown) = shot.showing(scalar).unwrap();
        shown.values(&shot.render_on_cpu().unwrap())
    }

    /// A shot with one particle of a velocity, and its camera.
    fn one_particle(velocity: Vec3) -> (Shot, View) {
        let mut shot = Shot::load("column", UVec2::new(64, 48)).unwrap();
        let system = &mut shot.preset.systems[0];
        let emitter = &mut system.emitter;
        *emitter = haze::emitter::Emitter::default();
        (emitter.rate, emitter.lifetime, emitter.lifetime_spread, emitter.duration) = (1.0, 9.0, 0.0, 1.0);
        (emitter.velocity, emitter.velocity_spread) = (velocity, 0.0);
        (emitter.wind, emitter.buoyancy, emitter.turbulence, emitter.drag) = (Vec3::ZERO, 0.0, 0.0, 0.0);
        shot.preset.time = 2.0;
        let view = shot.preset.camera.view(shot.size);
        (shot, view)
    }

    #[test]
    fn depth_and_motion_of_one_particle_are_those_of_its_projection() {
        let velocity = Vec3::new(0.8, 1.5, -0.4);
        let (shot, view) = one_particle(velocity);
        let particles = shot.systems().remove(0).0;
        let [particle] = &particles[..] else { panic!("{} particles", particles.len()) };
        for scalar in [ParticleScalar::ViewDepth, ParticleScalar::MotionRight(0.1), ParticleScalar::MotionUp(0.1)] {
            let expected = scalar.of(particle, velocity * 0.1, &view);
            let image = mean(&shot, scalar);
            let found: Vec<f32> = image.texels.iter().copied().flatten().collect();
            assert!(found.len() > 20, "{} pixels", found.len());
            for value in found {
                // A single value is stored in sixteen bits of a range of a thousandth.
                assert!((value - expected).abs() < 1.5e-3, "{scalar:?}: {value}, not {expected}");
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
        later.preset.time += seconds;
        let then = later.systems().remove(0).0;
        let is_there = |(particle, way): &(&Particle, &Vec3)| {
            then.iter().any(|other| other.position.distance(particle.position + **way) < 1.0e-4)
        };
        let found = now.iter().zip(&ways).filter(is_there).count();
        // The others are at the end of their lives.
        assert!(found < now.len() && found * 100 > now.len() * 95, "{found} of {}", now.len());
    }
}
