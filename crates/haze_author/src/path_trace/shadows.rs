//! Precomputed shadows: integrated density between every voxel and every light.

use glam::{UVec2, UVec3, Vec3};
use haze_core::assets::image::Image;

use super::density_volume::{DensityVolume, exit_distance, trilinear_corners, voxel_center};

/// Integrated density from each voxel towards each light. The entries of a voxel are adjacent.
pub(super) struct ShadowVolume {
    size: UVec3,
    depths: Image<f32>,
    lights: usize,
}

impl ShadowVolume {
    pub fn new(volume: &DensityVolume, lights: &[Vec3]) -> Self {
        // The grid is equally fine along each axis. A coarser axis would make positions between voxels too dark.
        let size = UVec3::splat(volume.size.max_element());
        let UVec3 { x: width, y: height, z: depth } = size;
        let count = lights.len();
        let mut depths = Image::new(UVec2::new(width * count as u32, height * depth), 0.0);
        // Half of the narrowest side of a voxel: the volume is 2 wide.
        let step = 1.0 / volume.size.max_element() as f32;
        depths.for_bands(|first, band| {
            for (row, line) in (first..).zip(band.chunks_mut(width as usize * count)) {
                for (x, depths) in (0..width).zip(line.chunks_mut(count)) {
                    let from = voxel_center(size, UVec3::new(x, row % height, row / height));
                    for (depth, &light) in depths.iter_mut().zip(lights) {
                        let distance = exit_distance(from, light);
                        let steps = (distance / step).ceil().max(1.0);
                        let step = distance / steps;
                        let position = |index: u32| from + light * ((index as f32 + 0.5) * step);
                        *depth = (0..steps as u32).map(|index| volume.density(position(index))).sum::<f32>() * step;
                    }
                }
            }
        });
        Self { size, depths, lights: count }
    }

    /// Writes the integrated density towards every light to `sums`, trilinearly interpolated at `p`.
    pub fn at(&self, p: Vec3, sums: &mut [f32]) {
        sums.fill(0.0);
        let corners = trilinear_corners(self.size, p);
        for (&voxel, weight) in corners.voxels.iter().zip(corners.weights) {
            let of_voxel = &self.depths.texels[voxel * self.lights..][..self.lights];
            for (sum, depth) in sums.iter_mut().zip(of_voxel) {
                *sum += depth * weight;
            }
        }
    }
}
