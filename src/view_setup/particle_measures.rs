//! One iteration over a system's particles per frame: bounding box, extent of the smoke, and drawing order.

use super::drawing_order::{DrawingOrder, depth_row};
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
        let (extent, size, depth_row) = (SpriteExtent::of(settings), settings.sprite.size, depth_row(space));
        self.bounds = Bounds::EMPTY;
        self.order.clear();
        self.sums.clear();
        for (index, particle) in (0u64..).zip(particles).filter(|(_, particle)| particle.is_visible()) {
            let reach = extent.reach(particle.radius, particle.velocity.length() * space.scale);
            self.bounds.include(space.world_position(particle.position), reach);
            self.order.push(depth_row, index, particle);
            self.sums.include(near, space.view_position(particle.position), particle, size);
        }
    }

    /// Returns the extent of the smoke; `None` if no particle is in front of the viewer.
    pub fn extent(&self) -> Option<SmokeExtent> {
        self.sums.extent()
    }
}
