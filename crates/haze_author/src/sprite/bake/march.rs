//! Ray marching through a density volume.

use glam::{IVec2, UVec2, UVec3, Vec3};
use haze_core::assets::image::Image;
use image::Rgba;

use super::baked_frame::{BakedFrame, MarchedTexel, RayAccumulator};
use crate::deterministic_math::fast_exp_neg;
use crate::path_trace::DensityVolume;

const CLEAR: Rgba<u8> = Rgba([128, 128, 255, 0]);

/// Appearance of a density volume.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Extinction at density 1, per half side.
    pub extinction: f32,
    /// Weight of fine normals relative to broad normals.
    pub bump: f32,
}

/// Marches through a square volume from the front. `carried` gives three more numbers of a voxel by its index, of which
/// the frame gets the mean of what is visible.
pub fn march_volume(surface: Surface, volume: &DensityVolume, carried: impl Fn(usize) -> Vec3 + Sync) -> BakedFrame {
    let size = volume.size.x;
    let clear = MarchedTexel { texel: CLEAR, offset: 0.0, carried: Vec3::ZERO };
    let mut marched = Image::new(UVec2::splat(size), clear);
    marched.for_bands(|first, band| {
        for (y, line) in (first..).zip(band.chunks_mut(size as usize)) {
            march(surface, volume, &carried, y, line);
        }
    });
    // Texels without visible neighbours all get the same value, which compresses well.
    let is_clear = |at: IVec2| marched.load(at).texel.0[3] == 0;
    let is_far = |at: IVec2| is_clear(at) && (-1..=1).all(|y| (-1..=1).all(|x| is_clear(at + IVec2::new(x, y))));
    let mut texels = Image::new(marched.size, clear);
    texels.for_each(|at, texel| {
        if !is_far(at.as_ivec2()) {
            *texel = marched.load(at.as_ivec2());
        }
    });
    BakedFrame::new(size, &texels.texels)
}

/// Marches the columns of one row of texels front to back.
fn march(
    surface: Surface,
    volume: &DensityVolume,
    carried: &impl Fn(usize) -> Vec3,
    y: u32,
    line: &mut [MarchedTexel],
) {
    let size = volume.size.x as usize;
    let depth = volume.size.z as usize;
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
        let position = volume.voxel_center(UVec3::new(0, y, z as u32)).z;
        let here = row(0, z, 0);
        // Rows above, below, in front and behind, for wide and fine differences.
        let around = [0, 1].map(|index| {
            let reach = reach[index] as isize;
            let deep = deep[index] as isize;
            [row(-reach, z, 0), row(reach, z, 0), row(0, z, -deep), row(0, z, deep)]
        });
        let slope = |x: usize, index: usize| {
            let [above, below, front, behind] = around[index].map(|row: &[f32]| row[x]);
            let along_x = here[x.saturating_sub(reach[index])] - here[(x + reach[index]).min(size - 1)];
            let along_z = (behind - front) * reach[index] as f32 / (deep[index] * ratio);
            // z is clamped so that no normal faces away from the viewer: normals of overlapping sprites must not
            // cancel.
            Vec3::new(along_x, below - above, along_z.max(0.0)).normalize_or_zero()
        };
        for ((x, &density), ray) in here.iter().enumerate().zip(&mut rays) {
            if density <= 0.0 || ray.is_opaque() {
                continue;
            }
            let amount = 1.0 - fast_exp_neg(density * surface.extinction * step);
            let carried = carried((z * size + y as usize) * size + x);
            ray.accumulate(amount, slope(x, 0) + slope(x, 1) * surface.bump, position, carried);
        }
    }
    for ((x, texel), ray) in (0..).zip(line).zip(rays) {
        let position = volume.voxel_center(UVec3::new(x, y, 0)).truncate();
        *texel = ray.texel(UVec2::new(x, y), volume.size.x, position);
    }
}
