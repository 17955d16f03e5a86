//! One iteration over a system's particles per frame: bounding box, extent of the smoke, and drawing order.

use glam::{Mat4, Vec3A};

use super::drawing_order::DrawingOrder;
use super::particle_space::ParticleSpace;
use super::smoke_extent::{ExtentSums, SmokeExtent};
use crate::formula::smoke_extent::NEARLY_TRANSPARENT;
use crate::frame::{Bounds, Particle, SpriteExtent};
use crate::settings::Settings;

/// Measures of a system's visible particles. Keeps its memory between frames.
#[derive(Debug)]
pub struct ParticleMeasures {
    /// Order in which the particles are drawn.
    pub order: DrawingOrder,
    boxes: SystemBoxes,
    sums: ExtentSums,
    /// Boxes of the nearly transparent sprites, and their amounts.
    faint: Vec<(WorldBox, f32)>,
}

/// Boxes of a system, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SystemBoxes {
    /// Box that contains every sprite.
    pub all: Bounds,
    /// Box of the smoke that casts shadow. Nearly transparent sprites extend it less, so that births and deaths do not
    /// move it.
    pub casting: Bounds,
}

/// Corners of a box in world space.
#[derive(Clone, Copy, Debug)]
struct WorldBox {
    low: Vec3A,
    high: Vec3A,
}

impl WorldBox {
    const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Extends the box to a fraction of the way to the sides of another that lie outside.
    fn extended(self, other: Self, fraction: f32) -> Self {
        let Self { low, high } = self;
        let union = self.union(other);
        Self { low: low + (union.low - low) * fraction, high: high + (union.high - high) * fraction }
    }

    fn bounds(self) -> Bounds {
        Bounds { min: self.low.into(), max: self.high.into() }
    }
}

impl Default for ParticleMeasures {
    fn default() -> Self {
        Self {
            order: DrawingOrder::default(),
            boxes: SystemBoxes { all: Bounds::EMPTY, casting: Bounds::EMPTY },
            sums: ExtentSums::default(),
            faint: Vec::new(),
        }
    }
}

impl ParticleMeasures {
    /// Measures particles; replaces all earlier measures. `near`: view depth of the near plane, metres. `settings`: their
    /// sizes are in metres of the world.
    pub fn measure(&mut self, space: &ParticleSpace, near: f32, particles: &[Particle], settings: &Settings) {
        let extent = SpriteExtent::from_settings(settings);
        let size = settings.sprite.size;
        let is_in_world = space.world_from_particles == Mat4::IDENTITY;
        let mut dense = WorldBox::EMPTY;
        self.order.clear();
        self.sums.clear();
        self.faint.clear();
        for (index, particle) in (0u64..).zip(particles).filter(|(_, particle)| particle.is_visible()) {
            let position = Vec3A::from(particle.position);
            let world = if is_in_world { position } else { space.world_from_particles.transform_point3a(position) };
            let reach = extent.radius(particle.radius, particle.velocity.length() * space.scale);
            let sprite = WorldBox { low: world - reach, high: world + reach };
            if particle.amount < NEARLY_TRANSPARENT {
                self.faint.push((sprite, particle.amount));
            } else {
                dense = dense.union(sprite);
            }
            let in_view = space.view_from_particles.transform_point3a(position);
            self.order.push(in_view.z, index);
            self.sums.include(near, in_view, particle, size);
        }
        let all = self.faint.iter().fold(dense, |all, (sprite, _)| all.union(*sprite));
        let base = if dense.low.x > dense.high.x { all } else { dense };
        let extended = |&(sprite, amount): &(WorldBox, f32)| base.extended(sprite, amount / NEARLY_TRANSPARENT);
        let casting = self.faint.iter().map(extended).fold(base, WorldBox::union);
        self.boxes = SystemBoxes { all: all.bounds(), casting: casting.bounds() };
    }

    /// Returns the boxes of the measured particles. `known`: box of a host or of an emitter, world space, which takes the
    /// place of both and does not jump when a sprite dies.
    pub fn boxes(&self, known: Option<Bounds>) -> SystemBoxes {
        known.map_or(self.boxes, |known| SystemBoxes { all: known, casting: known })
    }

    /// Returns the extent of the smoke; `None` if no particle is in front of the viewer.
    pub fn extent(&self) -> Option<SmokeExtent> {
        self.sums.extent()
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::perspective;
    use glam::{UVec2, Vec3};

    use super::*;
    use crate::frame::View;
    use crate::view_setup::view_geometry::ViewGeometry;

    #[test]
    fn birth_and_death_of_a_sprite_do_not_move_the_box_that_casts_shadow() {
        let view = View::new(Mat4::IDENTITY, perspective(0.8, 1.0, 0.1, 80.0), UVec2::splat(64));
        let view = ViewGeometry::new(&view).unwrap();
        let at = |x: f32, amount| Particle { position: Vec3::new(x, 0.0, -5.0), amount, ..Particle::default() };
        let measure = |particles: &[Particle]| {
            let mut measures = ParticleMeasures::default();
            let space = ParticleSpace::new(&view, &Mat4::IDENTITY);
            measures.measure(&space, 0.1, particles, &Settings::default());
            measures.boxes(None)
        };
        let alone = measure(&[at(0.0, 1.0)]).casting;
        let mut last = alone;
        for step in 1..=100 {
            let SystemBoxes { all, casting } = measure(&[at(0.0, 1.0), at(10.0, step as f32 * 1.0e-3)]);
            assert_eq!(all, measure(&[at(0.0, 1.0), at(10.0, 1.0)]).all);
            assert_eq!(casting.min, alone.min);
            // 10 m in the 50 steps up to an amount of 0.05.
            let moved = (casting.max - last.max).x;
            assert!((-1.0e-4..=0.21).contains(&moved), "step {step}: {last:?}, {casting:?}");
            last = casting;
        }
        assert_eq!(last, measure(&[at(0.0, 1.0), at(10.0, 1.0)]).casting);
        // All of the smoke counts if all is nearly transparent.
        let SystemBoxes { all, casting } = measure(&[at(0.0, 0.01), at(10.0, 0.02)]);
        assert_eq!(all, casting);
    }
}
