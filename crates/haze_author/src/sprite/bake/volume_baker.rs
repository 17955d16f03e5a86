//! Volume baker: fills a box of voxels with density, and marches rays through it. Data that all frames share is computed
//! once, and slowly varying data on a coarse grid. Uses only `deterministic_math.rs` and plain arithmetic, so bakes are
//! bit-identical on every machine.

use glam::{UVec2, UVec3, Vec3};
use haze_core::assets::image::Image;
use haze_core::formula::saturate;

use super::baked_frame::BakedFrame;
use super::cluster::Metaball;
use super::erosion::Erosion;
use super::loop_state::{LoopState, VoxelColumn};
use super::march::{Surface, march_volume};
use super::sprite_recipe::SpriteRecipe;
use super::voxel_grid::{LANES, VoxelGrid};
use crate::deterministic_math::fast_exp_neg;
use crate::path_trace::DensityVolume;

/// Data that all frames of a sprite share.
pub(super) struct VolumeBaker<'a> {
    recipe: &'a SpriteRecipe,
    voxels: VoxelGrid,
    erosion: Erosion,
}

impl Metaball {
    /// Adds Wyvill's soft object, (1 − d²/r²)³: value and slope are 0 at distance r. Overlapping balls merge.
    fn add_field(&self, [px, py, pz]: [&[f32; LANES]; 3], field: &mut [f32; LANES]) {
        let Self { center, axis, inverse_radius } = *self;
        let inverse_axis = 1.0 / axis.length_squared().max(f32::MIN_POSITIVE);
        let scale = inverse_radius * inverse_radius;
        let is_line = axis != Vec3::ZERO;
        for lane in 0..LANES {
            let mut x = px[lane] - center.x;
            let mut y = py[lane] - center.y;
            let mut z = pz[lane] - center.z;
            if is_line {
                let along = ((x * axis.x + y * axis.y + z * axis.z) * inverse_axis).clamp(-1.0, 1.0);
                x -= axis.x * along;
                y -= axis.y * along;
                z -= axis.z * along;
            }
            let inside = (1.0 - (x * x + y * y + z * z) * scale).max(0.0);
            field[lane] += inside * inside * inside;
        }
    }
}

impl<'a> VolumeBaker<'a> {
    pub fn new(recipe: &'a SpriteRecipe) -> Self {
        let voxels = VoxelGrid::new(recipe.size);
        Self { recipe, voxels, erosion: Erosion::new(recipe, voxels) }
    }

    /// Returns the density volume at a time, as a fraction of the loop. The slice nearest to the viewer comes first.
    pub fn volume(&self, time: f32) -> DensityVolume {
        let size = self.recipe.size;
        let moment = LoopState::new(self.recipe, self.voxels, time);
        let mut volume = Image::new(UVec2::new(size, size * self.voxels.depth), 0.0);
        volume.for_bands(|first, band| {
            for (row, line) in (first..).zip(band.chunks_mut(size as usize)) {
                self.fill(&moment, row % size, row / size, line);
            }
        });
        DensityVolume { size: self.voxels.sides(), densities: volume.texels }
    }

    pub fn frame(&self, time: f32) -> BakedFrame {
        let surface = Surface { extinction: self.recipe.extinction, bump: self.recipe.bump };
        march_volume(surface, &self.volume(time), |_| Vec3::ZERO)
    }

    /// Computes the densities of one row of voxels: 0 outside, about 1 inside.
    fn fill(&self, moment: &LoopState, y: u32, z: u32, line: &mut [f32]) {
        let recipe = self.recipe;
        let middle = self.voxels.voxel_center(UVec3::new(recipe.size / 2, y, z)).with_x(0.0);
        if middle.length_squared() > 1.0 {
            return;
        }
        let displacements = moment.displacements_along(middle);
        let boxes = self.voxels.boxes();
        let first_box = ((z / LANES as u32 * boxes.y) + y / LANES as u32) * boxes.x;
        for (index, run) in line.chunks_mut(LANES).enumerate() {
            let near = &moment.balls_by_box[first_box as usize + index];
            if near.is_empty() {
                continue;
            }
            let start = index * LANES;
            let columns = &moment.columns[start..start + run.len()];
            let mut window = [0.0; LANES];
            let mut field = [0.0; LANES];
            for (window, column) in window.iter_mut().zip(columns) {
                *window = saturate((0.97 - middle.with_x(column.x).length()) * 6.0);
            }
            if window.iter().all(|&window| window <= 0.0) {
                continue;
            }
            let mut px = [0.0; LANES];
            let mut py = [0.0; LANES];
            let mut pz = [0.0; LANES];
            for (lane, &VoxelColumn { x, node, fraction }) in columns.iter().enumerate() {
                let all = displacements[node].all.lerp(displacements[node + 1].all, fraction);
                [px[lane], py[lane], pz[lane]] = (middle.with_x(x) + all).to_array();
            }
            for ball in near {
                ball.add_field([&px, &py, &pz], &mut field);
            }
            if field.iter().all(|&field| field <= 0.0) {
                continue;
            }
            let noise: [f32; LANES] = if recipe.travel > 0.0 {
                let mut noise = [0.0; LANES];
                for (noise, &VoxelColumn { x, node, fraction }) in noise.iter_mut().zip(columns) {
                    let flow = displacements[node].flow.lerp(displacements[node + 1].flow, fraction);
                    *noise = self.erosion.sample_at(middle.with_x(x) + flow);
                }
                noise
            } else {
                let first = ((z * recipe.size + y) * recipe.size) as usize + start;
                self.erosion.sample_run(first..first + run.len(), moment.phase)
            };
            for (lane, density) in run.iter_mut().enumerate() {
                let body = 1.0 - fast_exp_neg(2.0 * field[lane]);
                // Noise erodes less where the body is dense.
                // Where noise is negative it adds density, at most as much as the body has: none outside.
                let eaten = (recipe.erosion * (0.4 + noise[lane]) * (1.0 - 0.7 * body)).max(-body);
                *density = (body - eaten).max(0.0) * window[lane] * window[lane] * (3.0 - 2.0 * window[lane]);
            }
        }
    }
}
