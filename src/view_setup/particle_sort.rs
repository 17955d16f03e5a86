//! Visible sprites in drawing order. Sorted normals are blended over each other and depend on the order; the amount
//! does not. (OTEE "Accumulating")

use super::view_geometry::ViewGeometry;
use crate::frame::Particle;

/// Scratch memory, kept between frames.
#[derive(Debug, Default)]
pub struct SortScratch {
    /// Sort key in the upper 32 bits, index in the lower 32 bits.
    keys: Vec<u64>,
    /// Output of a round of the sort.
    sorted: Vec<u64>,
}

impl SortScratch {
    /// Releases memory that the last sort did not need.
    pub fn shrink(&mut self) {
        self.keys.shrink_to_fit();
        self.sorted.shrink_to_fit();
    }
}

/// Bits of the key that one round of the sort uses.
const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 3;
/// Minimum number of keys for the radix sort; for fewer, its tables cost more than they save.
const MIN_RADIX_KEYS: usize = 512;

impl SortScratch {
    /// Sorts by key, and by index for equal keys: a radix sort from the lowest digit up, each round stable.
    fn sort(&mut self) {
        let Self { keys, sorted } = self;
        if keys.len() < MIN_RADIX_KEYS {
            keys.sort_unstable();
            return;
        }
        let digit =
            |key: u64, round: usize| (key >> (32 + DIGIT_BITS * round as u32)) as usize & ((1 << DIGIT_BITS) - 1);
        let mut places = [[0_usize; 1 << DIGIT_BITS]; DIGITS];
        for &key in keys.iter() {
            (0..DIGITS).for_each(|round| places[round][digit(key, round)] += 1);
        }
        sorted.resize(keys.len(), 0);
        for (round, places) in places.iter_mut().enumerate() {
            // A round in which all keys have the same digit moves nothing.
            if places[digit(keys[0], round)] == keys.len() {
                continue;
            }
            let mut before = 0;
            for place in places.iter_mut() {
                before += std::mem::replace(place, before);
            }
            for &key in keys.iter() {
                let place = &mut places[digit(key, round)];
                sorted[*place] = key;
                *place += 1;
            }
            std::mem::swap(keys, sorted);
        }
    }
}

/// Writes the visible particles to `out`: farthest first if `is_sorted`, otherwise in the given order.
pub fn write_in_drawing_order(
    view: &ViewGeometry,
    particles: &[Particle],
    is_sorted: bool,
    scratch: &mut SortScratch,
    out: &mut Vec<Particle>,
) {
    if is_sorted {
        back_to_front(view, particles, scratch, out);
        return;
    }
    out.clear();
    out.extend(particles.iter().filter(|particle| particle.is_visible()));
}

/// Writes the visible particles back to front. Equal depths keep their order, so that the image is reproducible.
fn back_to_front(view: &ViewGeometry, particles: &[Particle], scratch: &mut SortScratch, sorted: &mut Vec<Particle>) {
    // Third row of view_from_world: gives view z, which increases towards the viewer.
    let row = view.view_from_world.row(2);
    scratch.keys.clear();
    scratch.keys.extend((0u64..).zip(particles).filter(|(_, particle)| particle.is_visible()).map(
        |(index, particle)| {
            let z = row.truncate().dot(particle.position) + row.w;
            (u64::from(ordered_bits(z)) << 32) | index
        },
    ));
    scratch.sort();
    sorted.clear();
    sorted.extend(scratch.keys.iter().map(|&key| particles[(key & 0xffff_ffff) as usize]));
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
        let mut sorted = Vec::new();
        back_to_front(&view, &particles, &mut SortScratch::default(), &mut sorted);
        let frames: Vec<_> = sorted.iter().map(|particle| particle.frame).collect();
        assert_eq!(frames, [3.0, 0.0, 4.0, 2.0]);
    }

    #[test]
    fn radix_sort_matches_the_standard_sort() {
        // Depths of all signs and magnitudes, each twice; in the last case all equal.
        for spread in [1.0, 1.0e-3, 0.0] {
            let depth = |index: u32| spread * f32::tan((index % 2000) as f32 * 2.4) - 3.0;
            let key = |index: u32| (u64::from(ordered_bits(depth(index))) << 32) | u64::from(index);
            let mut scratch = SortScratch { keys: (0..4000).map(key).collect(), ..SortScratch::default() };
            let mut expected = scratch.keys.clone();
            expected.sort_unstable();
            scratch.sort();
            assert_eq!(scratch.keys, expected);
        }
    }
}
