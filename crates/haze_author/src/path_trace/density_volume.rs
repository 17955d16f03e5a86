//! Density volume with trilinear interpolation.

use glam::{UVec3, Vec3};

/// Densities in the cube from -1 to 1: x right, y up, z towards the viewer. The first voxel is at the left, top and
/// front.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityVolume {
    /// Number of voxels across, down and away from the viewer.
    pub size: UVec3,
    /// One density per voxel, across first, then down, then away: 0 outside, about 1 inside.
    pub densities: Vec<f32>,
}

/// The eight voxels around a position with their trilinear weights.
pub(super) struct Corners {
    pub voxels: [usize; 8],
    pub weights: [f32; 8],
}

impl DensityVolume {
    /// Returns the center of a voxel.
    pub fn voxel_center(&self, voxel: UVec3) -> Vec3 {
        voxel_center(self.size, voxel)
    }

    /// Returns the trilinearly interpolated density at a position in the cube.
    pub fn density(&self, p: Vec3) -> f32 {
        let Corners { voxels, weights } = trilinear_corners(self.size, p);
        voxels.iter().zip(weights).map(|(&voxel, weight)| self.densities[voxel] * weight).sum()
    }

    /// Encodes the volume for Mitsuba 3 (`gridvolume`, version 3, 32-bit floats): bounds (0, 0, 0) to (1, 1, 1), x
    /// across, y up, z towards the viewer.
    pub fn to_mitsuba(&self) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        bytes.extend(1_i32.to_le_bytes());
        bytes.extend(self.size.to_array().into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(1_i32.to_le_bytes());
        bytes.extend([0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].into_iter().flat_map(f32::to_le_bytes));
        let width = self.size.x as usize;
        let slice = (self.size.x * self.size.y) as usize;
        for slice in self.densities.chunks(slice).rev() {
            for row in slice.chunks(width).rev() {
                bytes.extend(row.iter().flat_map(|density| density.to_le_bytes()));
            }
        }
        bytes
    }

    pub(super) fn max_density(&self) -> f32 {
        self.densities.iter().copied().fold(0.0, f32::max)
    }
}

/// Returns the center of a voxel in the cube from -1 to 1, for a grid of `size`.
pub(crate) fn voxel_center(size: UVec3, voxel: UVec3) -> Vec3 {
    let p = (voxel.as_vec3() + 0.5) * (2.0 / size.as_vec3()) - 1.0;
    Vec3::new(p.x, -p.y, -p.z)
}

pub(super) fn trilinear_corners(size: UVec3, p: Vec3) -> Corners {
    let last = size.as_vec3() - 1.0;
    let at = (p * Vec3::new(1.0, -1.0, -1.0) + 1.0) * 0.5 * size.as_vec3() - 0.5;
    let at = at.clamp(Vec3::ZERO, last);
    let low = at.as_uvec3();
    let f = at - low.as_vec3();
    let step = (low + 1).min(size - 1) - low;
    let row = size.x as usize;
    let slice = (size.x * size.y) as usize;
    let first = low.z as usize * slice + low.y as usize * row + low.x as usize;
    let x = step.x as usize;
    let y = step.y as usize * row;
    let z = step.z as usize * slice;
    let back = 1.0 - f.z;
    let across = [(1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y];
    let [a, b, c, d] = across;
    Corners {
        voxels: [0, x, y, x + y, z, x + z, y + z, x + y + z].map(|offset| first + offset),
        weights: [a * back, b * back, c * back, d * back, a * f.z, b * f.z, c * f.z, d * f.z],
    }
}

/// Returns the distance at which a ray from inside leaves the cube.
pub(super) fn exit_distance(p: Vec3, direction: Vec3) -> f32 {
    let to = |axis: usize| {
        let speed = direction[axis];
        if speed == 0.0 { f32::INFINITY } else { (speed.signum() - p[axis]) / speed }
    };
    to(0).min(to(1)).min(to(2)).max(0.0)
}
