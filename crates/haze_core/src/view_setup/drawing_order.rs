//! Visible sprites in drawing order. Sorted normals are blended over each other and depend on the order; the amount
//! does not. (OTEE "Accumulating")

use super::particle_space::ParticleSpace;
use crate::frame::Particle;

/// Keys of the visible particles.
#[derive(Debug, Default)]
pub struct DrawingOrder {
    /// Sort key in the upper 32 bits, index in the lower 32 bits.
    keys: Vec<u64>,
    /// Output of a round of the sort.
    sorted: Vec<u64>,
}

/// Bits of the key that one round of the sort uses.
const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 3;
/// Minimum number of keys for the radix sort; for fewer, its tables cost more than they save.
const MIN_RADIX_KEYS: usize = 512;

impl DrawingOrder {
    /// Reads the keys of particles.
    pub fn read(&mut self, space: &ParticleSpace, particles: &[Particle]) {
        self.clear();
        for (index, particle) in (0u64..).zip(particles).filter(|(_, particle)| particle.is_visible()) {
            self.push(space.view_from_particles.transform_point3a(particle.position.into()).z, index);
        }
    }

    /// Removes all keys; keeps the memory.
    pub(super) fn clear(&mut self) {
        self.keys.clear();
    }

    /// Adds a visible particle. `z`: of its center in view space; it increases towards the viewer.
    pub(super) fn push(&mut self, z: f32, index: u64) {
        self.keys.push((u64::from(ordered_bits(z)) << 32) | index);
    }

    /// Returns the indices of the visible particles in drawing order.
    pub fn indices(&self) -> impl ExactSizeIterator<Item = usize> {
        self.keys.iter().map(|&key| (key & 0xffff_ffff) as usize)
    }

    /// Releases memory that the last sort did not need.
    pub fn shrink(&mut self) {
        self.keys.shrink_to_fit();
        self.sorted.shrink_to_fit();
    }

    /// Sorts farthest first. Equal depths keep their order, so that the image is reproducible. A radix sort from the
    /// lowest digit up, each round stable.
    pub fn sort(&mut self) {
        let Self { keys, sorted } = self;
        if keys.len() < MIN_RADIX_KEYS {
            keys.sort_unstable();
            return;
        }
        let digit =
            |key: u64, round: usize| (key >> (32 + DIGIT_BITS * round as u32)) as usize & ((1 << DIGIT_BITS) - 1);
        let mut positions = [[0_usize; 1 << DIGIT_BITS]; DIGITS];
        for &key in keys.iter() {
            (0..DIGITS).for_each(|round| positions[round][digit(key, round)] += 1);
        }
        sorted.resize(keys.len(), 0);
        for (round, positions) in positions.iter_mut().enumerate() {
            // A round in which all keys have the same digit moves nothing.
            if positions[digit(keys[0], round)] == keys.len() {
                continue;
            }
            let mut before = 0;
            for position in positions.iter_mut() {
                before += std::mem::replace(position, before);
            }
            for &key in keys.iter() {
                let position = &mut positions[digit(key, round)];
                sorted[*position] = key;
                *position += 1;
            }
            std::mem::swap(keys, sorted);
        }
    }
}

/// Maps a number to bits that sort in the same order. (Herf, "Radix tricks", 2001)
fn ordered_bits(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::View;
    use crate::view_setup::view_geometry::ViewGeometry;
    use glam::camera::rh;
    use glam::{Mat4, UVec2, Vec3};

    #[test]
    fn particles_are_sorted_farthest_first_ties_in_order_and_invisible_ones_dropped() {
        let clip_from_view = rh::proj::directx::perspective(1.0, 1.0, 0.1, 100.0);
        let view = ViewGeometry::new(&View::new(Mat4::IDENTITY, clip_from_view, UVec2::ONE)).unwrap();
        let at = |z: f32, frame: f32| Particle { position: Vec3::new(0.0, 0.0, z), frame, ..Particle::default() };
        let particles = [
            at(-3.0, 0.0),
            at(f32::NAN, 1.0),
            at(4.0, 2.0),
            at(-9.0, 3.0),
            at(-3.0, 4.0),
            Particle { amount: 0.0, ..at(-1.0, 5.0) },
        ];
        let mut order = DrawingOrder::default();
        order.read(&ParticleSpace::new(&view, &Mat4::IDENTITY), &particles);
        order.sort();
        let frames: Vec<_> = order.indices().map(|index| particles[index].frame).collect();
        assert_eq!(frames, [3.0, 0.0, 4.0, 2.0]);
    }

    #[test]
    fn radix_sort_matches_the_standard_sort() {
        // Depths of all signs and magnitudes, each twice; in the last case all equal.
        for spread in [1.0, 1.0e-3, 0.0] {
            let depth = |index: u32| spread * f32::tan((index % 2000) as f32 * 2.4) - 3.0;
            let key = |index: u32| (u64::from(ordered_bits(depth(index))) << 32) | u64::from(index);
            let mut order = DrawingOrder { keys: (0..4000).map(key).collect(), ..DrawingOrder::default() };
            let mut expected = order.keys.clone();
            expected.sort_unstable();
            order.sort();
            assert_eq!(order.keys, expected);
        }
    }
}
