//! Gradient noise from integer hashes and plain f32 arithmetic, for what is baked: the same on every machine.

use glam::{IVec3, UVec3, Vec2, Vec3};

use crate::formula::hash::pcg3d;

/// Noise and its gradient at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// About −1..1, mean 0.
    pub value: f32,
    /// Derivatives along x, y and z.
    pub gradient: Vec3,
}

/// Gradient noise on a lattice of spacing 1. The lattice gradients rotate with `phase` = (cos, sin): a full turn is a
/// seamless loop in time that swirls without drifting. (Perlin, "Improving noise", 2002; rotation: Perlin and Neyret,
/// "Flow noise", 2001)
pub fn gradient_noise(position: Vec3, phase: Vec2, seed: u32) -> Noise {
    lattice_noise(position, |cell| lattice_gradient(cell, phase, seed))
}

/// [`gradient_noise`] at phase (1, 0) that repeats every `period` cells along each axis.
pub fn tiling_noise(position: Vec3, period: u32, seed: u32) -> Noise {
    let period = IVec3::splat(period.max(1) as i32);
    lattice_noise(position, |cell| lattice_gradient(cell.rem_euclid(period), Vec2::X, seed))
}

fn lattice_noise(position: Vec3, lattice_gradient: impl Fn(IVec3) -> Vec3) -> Noise {
    let cell = position.floor();
    let f = position - cell;
    let cell = cell.as_ivec3();
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let slope = f * f * 30.0 * (f * (f - 2.0) + 1.0);

    let mut value = 0.0;
    let mut gradient = Vec3::ZERO;
    for corner in 0..8 {
        let offset = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
        let lattice = lattice_gradient(cell.wrapping_add(offset));
        let dot = lattice.dot(f - offset.as_vec3());
        // Weight of the corner along each axis, and its derivative.
        let pick = |axis: usize| {
            if offset[axis] == 1 { (fade[axis], slope[axis]) } else { (1.0 - fade[axis], -slope[axis]) }
        };
        let (wx, sx) = pick(0);
        let (wy, sy) = pick(1);
        let (wz, sz) = pick(2);
        let weight = wx * wy * wz;
        value += weight * dot;
        gradient += lattice * weight + Vec3::new(sx * wy * wz, wx * sy * wz, wx * wy * sz) * dot;
    }
    Noise { value, gradient }
}

/// Gradient at a lattice point: two random vectors, the first weighted by cos, the second by sin.
pub fn lattice_gradient(at: IVec3, phase: Vec2, seed: u32) -> Vec3 {
    let [first, second] = lattice_gradients(at, seed);
    first * phase.x + second * phase.y
}

fn lattice_gradients(at: IVec3, seed: u32) -> [Vec3; 2] {
    let hash = pcg3d(at.as_uvec3().wrapping_add(UVec3::new(seed, seed ^ 0x9e37_79b9, 0)));
    let component = |word: u32| word as f32 * (2.0 / 65535.0) - 1.0;
    let first = Vec3::new(component(hash.x >> 16), component(hash.y >> 16), component(hash.z >> 16));
    let second = Vec3::new(component(hash.x & 0xffff), component(hash.y & 0xffff), component(hash.z & 0xffff));
    [first, second]
}

/// Gradient noise along a line. The hashes of the current lattice cell are cached, because neighbouring points share
/// it.
pub struct CachedGradientNoise {
    seed: u32,
    cell: IVec3,
    corners: [[Vec3; 2]; 8],
}

impl CachedGradientNoise {
    /// Creates the noise of a seed.
    pub fn new(seed: u32) -> Self {
        let cell = IVec3::ZERO;
        Self { seed, cell, corners: corners(cell, seed) }
    }

    /// Returns [`gradient_noise`] at the phases (1, 0) and (0, 1). Weighted by cos and sin of any phase, the two sum to
    /// the noise at that phase.
    pub fn phase_components(&mut self, position: Vec3) -> [f32; 2] {
        let cell = position.floor();
        let f = position - cell;
        if cell.as_ivec3() != self.cell {
            self.cell = cell.as_ivec3();
            self.corners = corners(self.cell, self.seed);
        }
        let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
        let mut sums = [0.0; 2];
        for (index, gradients) in self.corners.iter().enumerate() {
            let offset = corner(index).as_vec3();
            let pick = offset * fade + (1.0 - offset) * (1.0 - fade);
            let weight = pick.x * pick.y * pick.z;
            for (sum, gradient) in sums.iter_mut().zip(gradients) {
                *sum += weight * gradient.dot(f - offset);
            }
        }
        sums
    }
}

fn corner(index: usize) -> IVec3 {
    let index = index as i32;
    IVec3::new(index & 1, (index >> 1) & 1, index >> 2)
}

fn corners(cell: IVec3, seed: u32) -> [[Vec3; 2]; 8] {
    std::array::from_fn(|index| lattice_gradients(cell.wrapping_add(corner(index)), seed))
}

/// Divergence-free flow: the curl of three noise fields. Smoke that follows it swirls and does not bunch up. (Bridson,
/// Hourihan and Nordenstam, "Curl-noise for procedural fluid flow", 2007)
pub fn curl_noise(position: Vec3, phase: Vec2, seed: u32) -> Vec3 {
    let x = gradient_noise(position, phase, seed).gradient;
    let y = gradient_noise(position, phase, seed.wrapping_add(1)).gradient;
    let z = gradient_noise(position, phase, seed.wrapping_add(2)).gradient;
    Vec3::new(z.y - y.z, x.z - z.x, y.x - x.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::hash::unit;

    fn points() -> impl Iterator<Item = Vec3> {
        (0..200).map(|i| {
            let hash = pcg3d(UVec3::new(i, 7, 9));
            Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z)) * 20.0 - 10.0
        })
    }

    #[test]
    fn gradient_is_the_derivative_of_the_value() {
        let phase = Vec2::from_angle(0.7);
        for p in points() {
            let noise = gradient_noise(p, phase, 3);
            for axis in Vec3::AXES {
                // Central differences of f32 noise with a step of 1/256 have an error of about 1e-3.
                let h = 1.0 / 256.0;
                let ahead = gradient_noise(p + axis * h, phase, 3).value;
                let behind = gradient_noise(p - axis * h, phase, 3).value;
                assert!(((ahead - behind) / (2.0 * h) - noise.gradient.dot(axis)).abs() < 5e-3, "{p}");
            }
            assert!(noise.value.abs() < 1.5);
        }
    }

    #[test]
    fn noise_cell_matches_gradient_noise() {
        let mut cell = CachedGradientNoise::new(3);
        let phase = Vec2::from_angle(0.7);
        for p in points() {
            let [start, later] = cell.phase_components(p);
            let value = gradient_noise(p, phase, 3).value;
            assert!((start * phase.x + later * phase.y - value).abs() < 1e-5, "{p}");
        }
    }

    #[test]
    fn full_turn_of_the_phase_loops_seamlessly() {
        for p in points() {
            let start = gradient_noise(p, Vec2::from_angle(0.0), 1).value;
            let end = gradient_noise(p, Vec2::from_angle(std::f32::consts::TAU), 1).value;
            assert!((start - end).abs() < 1e-5);
        }
    }

    #[test]
    fn tiling_noise_repeats() {
        for p in points() {
            let here = tiling_noise(p, 4, 2);
            let there = tiling_noise(p + Vec3::new(4.0, -8.0, 12.0), 4, 2);
            assert!((here.value - there.value).abs() < 1e-4 && here.gradient.distance(there.gradient) < 1e-3, "{p}");
        }
    }

    #[test]
    fn curl_noise_is_divergence_free() {
        let phase = Vec2::X;
        for p in points() {
            let h = 1.0 / 128.0;
            let slope = |axis: Vec3| {
                (curl_noise(p + axis * h, phase, 5) - curl_noise(p - axis * h, phase, 5)).dot(axis) / (2.0 * h)
            };
            let divergence: f32 = Vec3::AXES.into_iter().map(slope).sum();
            assert!(divergence.abs() < 0.05, "{p}: {divergence}");
        }
    }
}
