//! Divergence-free noise from integer hashes and plain f32 arithmetic, which WGSL can reproduce. WGSL:
//! `shaders/lib/swirl_noise.wgsl`.

use glam::{BVec3, IVec3, UVec3, Vec2, Vec3};

use super::hash::pcg3d;

/// Root mean square of each component of the curl below, so that the noise has 1.
const SWIRL_RMS: f32 = 0.02286;

/// Simplex coordinates of a point, in which the corners of the simplices are integers.
pub fn skewed(position: Vec3) -> Vec3 {
    position + (position.x + position.y + position.z) / 3.0
}

/// Three numbers from −1 to 1, of 10 bits each.
fn unpack_signed(word: u32) -> Vec3 {
    let bits = UVec3::new(word >> 22, word >> 12, word >> 2) & UVec3::splat(1023);
    bits.as_vec3() * (2.0 / 1023.0) - 1.0
}

/// Curl of the vector potential (0.5 − d·d)⁴ G·d of a corner, at a distance d from it. G is a random matrix whose rows
/// take each other's places as the phase (cos, sin) turns.
fn corner_curl(corner: IVec3, d: Vec3, phase: Vec2, seed: u32) -> Vec3 {
    let near = (0.5 - d.dot(d)).max(0.0);
    let hash = pcg3d(corner.as_uvec3().wrapping_add(UVec3::new(seed, seed ^ 0x9e37_79b9, 0)));
    let a = unpack_signed(hash.x);
    let b = unpack_signed(hash.y);
    let c = unpack_signed(hash.z);
    let x = a * phase.x + b * phase.y;
    let y = b * phase.x + c * phase.y;
    let z = c * phase.x + a * phase.y;
    let potential = Vec3::new(x.dot(d), y.dot(d), z.dot(d));
    let curl = Vec3::new(z.y - y.z, x.z - z.x, y.x - x.y);
    near * near * near * (near * curl - 8.0 * d.cross(potential))
}

/// Divergence-free noise at [simplex coordinates](skewed), whose corners have the numbers of a lattice that begins at
/// `first`. Each component has a mean of 0 and a root mean square of 1. Smoke that follows it swirls and does not bunch up.
/// A full turn of the phase, (cos, sin), is a seamless loop in time that swirls without drifting. (Bridson, Hourihan and
/// Nordenstam, "Curl-noise for procedural fluid flow", 2007, on simplices)
pub fn swirl_noise(at: Vec3, first: IVec3, phase: Vec2, seed: u32) -> Vec3 {
    let cell = at.floor();
    let f = at - cell;
    let origin = cell.as_ivec3().wrapping_add(first);
    // From the first corner, in world space.
    let d = f - (f.x + f.y + f.z) / 6.0;
    // The corners between lie along the largest coordinate, then the next.
    let one = |mask: BVec3| Vec3::select(mask, Vec3::ONE, Vec3::ZERO);
    let rank = one(BVec3::new(f.x >= f.y, f.y > f.x, f.z > f.x)) + one(BVec3::new(f.x >= f.z, f.y >= f.z, f.z > f.y));
    let second = one(rank.cmpeq(Vec3::splat(2.0)));
    let third = one(rank.cmpge(Vec3::ONE));
    let corner = |offset: Vec3| origin.wrapping_add(offset.as_ivec3());
    let sum = corner_curl(origin, d, phase, seed)
        + corner_curl(corner(second), d - second + 1.0 / 6.0, phase, seed)
        + corner_curl(corner(third), d - third + 1.0 / 3.0, phase, seed)
        + corner_curl(corner(Vec3::ONE), d - 0.5, phase, seed);
    sum / SWIRL_RMS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::hash::unit;

    fn points(count: u32) -> impl Iterator<Item = Vec3> {
        (0..count).map(|i| {
            let hash = pcg3d(UVec3::new(i, 7, 9));
            Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z)) * 200.0 - 100.0
        })
    }

    fn noise(position: Vec3, phase: Vec2) -> Vec3 {
        swirl_noise(skewed(position), IVec3::ZERO, phase, 5)
    }

    #[test]
    fn noise_is_divergence_free() {
        let h = 1.0 / 128.0;
        for p in points(2000) {
            let slope =
                |axis: Vec3| (noise(p + axis * h, Vec2::Y) - noise(p - axis * h, Vec2::Y)).dot(axis) / (2.0 * h);
            let divergence: f32 = Vec3::AXES.into_iter().map(slope).sum();
            // Slopes are up to 20; the rounding of f32 positions near 100 gives 0.02.
            assert!(divergence.abs() < 0.1, "{p}: {divergence}");
        }
    }

    #[test]
    fn noise_has_unit_variance_at_every_phase() {
        for turn in [0.0, 0.9, 2.5] {
            let phase = Vec2::from_angle(turn);
            let squares: Vec3 = points(50_000).map(|p| noise(p, phase)).map(|u| u * u).sum();
            let variance = squares / 50_000.0;
            assert!((variance - 1.0).abs().max_element() < 0.03, "{variance}");
        }
    }

    #[test]
    fn a_lattice_that_begins_elsewhere_is_the_noise_there() {
        for p in points(200) {
            let at = skewed(p);
            let moved = at - Vec3::new(3.0, -40.0, 7.0);
            let first = IVec3::new(3, -40, 7);
            let error = (swirl_noise(moved, first, Vec2::X, 5) - swirl_noise(at, IVec3::ZERO, Vec2::X, 5)).length();
            assert!(error < 2.0e-3, "{p}: {error}");
        }
    }

    #[test]
    fn full_turn_of_the_phase_loops_seamlessly() {
        for p in points(200) {
            let start = noise(p, Vec2::from_angle(0.0));
            let end = noise(p, Vec2::from_angle(std::f32::consts::TAU));
            assert!((start - end).length() < 1e-5);
        }
    }
}
