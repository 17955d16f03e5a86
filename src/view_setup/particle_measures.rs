//! One iteration over a system's particles per frame: bounding box, extent of the smoke, and drawing order.

use glam::{Mat4, Vec3A};

use super::drawing_order::DrawingOrder;
use super::particle_space::ParticleSpace;
use super::smoke_extent::{ExtentSums, SmokeExtent};
use crate::frame::{Bounds, Particle, SpriteExtent};
use crate::settings::Settings;

/// Measures of a system's visible particles. Keeps its memory between frames.
#[derive(Debug)]
pub struct ParticleMeasures {
    /// Box that contains every sprite, world space.
    pub bounds: Bounds,
    pub order: DrawingOrder,
    sums: ExtentSums,
}

impl Default for ParticleMeasures {
    fn default() -> Self {
        Self { bounds: Bounds::EMPTY, order: DrawingOrder::default(), sums: ExtentSums::default() }
    }
}

impl ParticleMeasures {
    /// Measures particles; replaces all earlier measures. `near`: view depth of the near plane, metres. `settings`: their
    /// sizes are in metres of the world.
    pub fn measure(&mut self, space: &ParticleSpace, near: f32, particles: &[Particle], settings: &Settings) {
        let (extent, size) = (SpriteExtent::of(settings), settings.sprite.size);
        let is_in_world = space.world_from_particles == Mat4::IDENTITY;
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        self.order.clear();
        self.sums.clear();
        for (index, particle) in (0u64..).zip(particles).filter(|(_, particle)| particle.is_visible()) {
            let position = Vec3A::from(particle.position);
            let world = if is_in_world { position } else { space.world_from_particles.transform_point3a(position) };
            let reach = extent.reach(particle.radius, particle.velocity.length() * space.scale);
            (low, high) = (low.min(world - reach), high.max(world + reach));
            let in_view = space.view_from_particles.transform_point3a(position);
            self.order.push(in_view.z, index);
            self.sums.include(near, in_view, particle, size);
        }
        self.bounds = Bounds { min: low.into(), max: high.into() };
    }

    /// Returns the extent of the smoke; `None` if no particle is in front of the viewer.
    pub fn extent(&self) -> Option<SmokeExtent> {
        self.sums.extent()
    }
}
