//! Erosion noise, precomputed per voxel for all frames.

use std::ops::Range;

use glam::{UVec2, UVec3, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::noise::CachedGradientNoise;

use super::sprite_recipe::SpriteRecipe;
use super::voxel_grid::{LANES, VoxelGrid};

/// Scale of noise values stored in 16 bits; the range is ±4.
const NOISE_SCALE: f32 = 8192.0;

pub(super) struct Erosion {
    voxels: VoxelGrid,
    octaves: Vec<Octave>,
}

/// Noise of every voxel at the start of the loop and a quarter of the loop later. A moment's noise is their mix by
/// cosine and sine.
struct Octave {
    weight: f32,
    lumps: f32,
    values: Image<[i16; 2]>,
}

impl Erosion {
    pub fn new(recipe: &SpriteRecipe, voxels: VoxelGrid) -> Self {
        let weight = |index: u32| (0..index).fold(1.0, |weight, _| weight * recipe.noise_gain);
        let octave = |index: u32| (weight(index), 2_u32.pow(index) as f32, index * 7919);
        let all: Vec<_> = (0..recipe.noise_octaves).map(octave).collect();
        // Octaves are summed in advance if lumps are off (the sum is linear) or if the noise does not turn. Otherwise
        // lumps must be applied to each octave after turning.
        let travels = recipe.travel > 0.0;
        let lumps = recipe.lumps;
        let octaves = if lumps > 0.0 && !travels {
            let alone = |&(weight, frequency, salt): &(f32, f32, u32)| Octave {
                weight,
                lumps,
                values: bake_octaves(recipe, voxels, &[(1.0, frequency, salt)], 0.0),
            };
            all.iter().map(alone).collect()
        } else {
            let inside = if travels { lumps } else { 0.0 };
            vec![Octave { weight: 1.0, lumps: 0.0, values: bake_octaves(recipe, voxels, &all, inside) }]
        };
        Self { voxels, octaves }
    }

    /// Returns the noise of a run of voxels.
    pub fn sample_run(&self, voxels: Range<usize>, phase: Vec2) -> [f32; LANES] {
        let mut sums = [0.0; LANES];
        for octave in &self.octaves {
            for (sum, &[start, later]) in sums.iter_mut().zip(&octave.values.texels[voxels.clone()]) {
                let noise = (f32::from(start) * phase.x + f32::from(later) * phase.y) * (1.0 / NOISE_SCALE);
                *sum += apply_lumps(noise, octave.lumps) * octave.weight;
            }
        }
        sums
    }

    /// Returns the interpolated noise at a position. Only valid if the noise does not turn (`travel` above 0): all
    /// octaves are then summed in the first one.
    pub fn sample_at(&self, p: Vec3) -> f32 {
        let size = self.voxels.size;
        let sides = self.voxels.sides().as_vec3();
        let at = ((p * Vec3::new(1.0, -1.0, -1.0) + 1.0) * 0.5 * sides - 0.5).clamp(Vec3::ZERO, sides - 1.0);
        let low = at.as_uvec3();
        let fraction = at - low.as_vec3();
        let high = (low + 1).min(self.voxels.sides() - 1);
        let values = &self.octaves[0].values;
        let load = |x: u32, y: u32, z: u32| {
            f32::from(values.texels[((z * size + y) * size + x) as usize][0]) * (1.0 / NOISE_SCALE)
        };
        let mix = |a: f32, b: f32, fraction: f32| a + (b - a) * fraction;
        let row = |y, z| mix(load(low.x, y, z), load(high.x, y, z), fraction.x);
        let slice = |z| mix(row(low.y, z), row(high.y, z), fraction.y);
        mix(slice(low.z), slice(high.z), fraction.z)
    }
}

/// Sums octaves, each a (weight, frequency, salt), for every voxel.
fn bake_octaves(recipe: &SpriteRecipe, voxels: VoxelGrid, octaves: &[(f32, f32, u32)], lumps: f32) -> Image<[i16; 2]> {
    let size = voxels.size;
    let mut values = Image::new(UVec2::new(size, size * voxels.depth), [0_i16; 2]);
    let seed = recipe.seed.wrapping_mul(31);
    values.for_bands(|first, band| {
        for (row, line) in (first..).zip(band.chunks_mut(size as usize)) {
            for &(weight, frequency, salt) in octaves {
                let mut cell = CachedGradientNoise::new(seed.wrapping_add(salt));
                for (x, value) in (0..).zip(&mut *line) {
                    let p = voxels.voxel_center(UVec3::new(x, row % size, row / size));
                    // Voxels farther out are invisible, but `travel` may carry noise in from there.
                    if p.length_squared() > 1.0 + recipe.travel {
                        continue;
                    }
                    let noise = cell.phase_components(p * recipe.noise_frequency * frequency);
                    for (sum, noise) in value.iter_mut().zip(noise) {
                        *sum = sum.saturating_add((apply_lumps(noise, lumps) * weight * NOISE_SCALE) as i16);
                    }
                }
            }
        }
    });
    values
}

/// Blends from waves (0) to round lumps with sharp creases (1); the mean stays about the same.
fn apply_lumps(noise: f32, lumps: f32) -> f32 {
    noise + (0.4 - 2.0 * noise.abs() - noise) * lumps
}
