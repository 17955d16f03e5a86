//! Ray marching through a density volume.

use glam::{UVec2, UVec3, Vec3};
use image::Rgba;

use super::baked_frame::RayAccumulator;
use super::sprite_recipe::SpriteRecipe;
use crate::deterministic_math::fast_exp_neg;
use crate::path_trace::DensityVolume;

/// Marches the columns of one row of texels front to back.
pub(super) fn march(recipe: &SpriteRecipe, volume: &DensityVolume, y: u32, line: &mut [(Rgba<u8>, f32)]) {
    let (size, depth) = (volume.size.x as usize, volume.size.z as usize);
    // One row of voxels; indices are clamped to the volume.
    let row = |dy: isize, z: usize, dz: isize| {
        let y = (y as usize).saturating_add_signed(dy).min(size - 1);
        let start = (z.saturating_add_signed(dz).min(depth - 1) * size + y) * size;
        &volume.densities[start..start + size]
    };
    // Depth of a voxel over its width: 4 from 32 pixels on.
    let ratio = size as f32 / depth as f32;
    let reach = [(size / 24).max(1), 1];
    let deep = reach.map(|reach| (reach as f32 / ratio).round().max(1.0));
    let step = 2.0 / depth as f32;
    let mut rays = vec![RayAccumulator::new(); size];
    for z in 0..depth {
        let place = volume.voxel_center(UVec3::new(0, y, z as u32)).z;
        let here = row(0, z, 0);
        // Rows above, below, in front and behind, for wide and fine differences.
        let around = [0, 1].map(|index| {
            let (reach, deep) = (reach[index] as isize, deep[index] as isize);
            [row(-reach, z, 0), row(reach, z, 0), row(0, z, -deep), row(0, z, deep)]
        });
        let slope = |x: usize, index: usize| {
            let [above, below, front, behind] = around[index].map(|row: &[f32]| row[x]);
            let along_x = here[x.saturating_sub(reach[index])] - here[(x + reach[index]).min(size - 1)];
            let along_z = (behind - front) * reach[index] as f32 / (deep[index] * ratio);
            // z is clamped so that no normal faces away from the viewer: normals of overlapping sprites must not cancel.
            Vec3::new(along_x, below - above, along_z.max(0.0)).normalize_or_zero()
        };
        for ((x, &density), ray) in here.iter().enumerate().zip(&mut rays) {
            if density <= 0.0 || ray.is_opaque() {
                continue;
            }
            let amount = 1.0 - fast_exp_neg(density * recipe.extinction * step);
            ray.accumulate(amount, slope(x, 0) + slope(x, 1) * recipe.bump, place);
        }
    }
    for ((x, texel), ray) in (0..).zip(line).zip(rays) {
        let place = volume.voxel_center(UVec3::new(x, y, 0)).truncate();
        *texel = ray.texel(UVec2::new(x, y), recipe.size, place);
    }
}
