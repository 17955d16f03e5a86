//! State at one moment of the loop: ball positions, and displacement by flow and warp.

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::noise::curl_noise;

use super::cluster::{Metaball, balls};
use super::sprite_recipe::SpriteRecipe;
use super::voxel_grid::{LANES, VoxelGrid};
use crate::deterministic_math::cos_sin;

/// Displacement of a position by the flow alone, and by flow and warp together.
#[derive(Clone, Copy)]
pub(super) struct Displacement {
    pub flow: Vec3,
    pub all: Vec3,
}

impl Displacement {
    pub fn lerp(self, other: Self, fraction: f32) -> Self {
        Self { flow: self.flow.lerp(other.flow, fraction), all: self.all.lerp(other.all, fraction) }
    }
}

/// One column of voxels: its x, and its position in the grid of shifts.
#[derive(Clone, Copy)]
pub(super) struct VoxelColumn {
    pub x: f32,
    pub node: usize,
    /// Fraction of the way from `node` to the next.
    pub fraction: f32,
}

/// State at one moment.
pub(super) struct LoopState {
    pub phase: Vec2,
    pub columns: Vec<VoxelColumn>,
    /// Shifts on a cubic grid of `nodes` per side from −1 to 1, slices below each other.
    displacements: Image<Displacement>,
    /// Balls that reach each box of [`LANES`] voxels per side.
    pub balls_by_box: Vec<Vec<Metaball>>,
}

impl LoopState {
    pub fn new(recipe: &SpriteRecipe, voxels: VoxelGrid, time: f32) -> Self {
        let turning = cos_sin(time * std::f32::consts::TAU);
        // With `travel`, the noise is carried along and does not turn in place.
        let phase = if recipe.travel > 0.0 { Vec2::X } else { turning };
        let nodes = ((recipe.noise_frequency * 8.0) as u32).clamp(16, 64);
        let mut displacements =
            Image::new(UVec2::new(nodes, nodes * nodes), Displacement { flow: Vec3::ZERO, all: Vec3::ZERO });
        let seed = recipe.seed.wrapping_mul(31);
        displacements.for_each(|at, displacement| {
            let node = UVec3::new(at.x, at.y % nodes, at.y / nodes).as_vec3();
            let p = node * (2.0 / (nodes - 1) as f32) - 1.0;
            if recipe.travel > 0.0 {
                displacement.flow = curl_noise(p * 0.8, turning, seed.wrapping_add(23)) * recipe.travel;
            }
            displacement.all = displacement.flow;
            if recipe.warp > 0.0 {
                let q = (p + displacement.flow) * recipe.noise_frequency;
                let coarse = curl_noise(q * 0.5, phase, seed.wrapping_add(11));
                displacement.all += (coarse + curl_noise(q + coarse, phase, seed.wrapping_add(17)) * 0.4) * recipe.warp;
            }
        });
        let margin = displacements.texels.iter().map(|displacement| displacement.all.length()).fold(0.0, f32::max);
        let column = |index: u32| {
            let x = (index as f32 + 0.5) * (2.0 / recipe.size as f32) - 1.0;
            let position = (x.min(1.0) + 1.0) * 0.5 * (nodes - 1) as f32;
            let node = (position as u32).min(nodes - 2);
            VoxelColumn { x, node: node as usize, fraction: position - node as f32 }
        };
        let columns = (0..recipe.size).map(column).collect();
        Self { phase, columns, balls_by_box: balls_by_box(voxels, &balls(recipe, time), margin), displacements }
    }

    /// Returns the shifts of one row, at the grid nodes along x.
    pub fn displacements_along(&self, p: Vec3) -> Vec<Displacement> {
        let displacements = &self.displacements;
        let nodes = displacements.size.x as i32;
        let at = (p + 1.0) * 0.5 * (nodes - 1) as f32;
        let low = at.floor();
        let fraction = at - low;
        let load = |x, y: i32, z: i32| displacements.load(IVec2::new(x, z.min(nodes - 1) * nodes + y.min(nodes - 1)));
        let low = low.as_ivec3();
        let along = |x| {
            let near = load(x, low.y, low.z).lerp(load(x, low.y + 1, low.z), fraction.y);
            near.lerp(load(x, low.y, low.z + 1).lerp(load(x, low.y + 1, low.z + 1), fraction.y), fraction.z)
        };
        (0..nodes).map(along).collect()
    }
}

fn balls_by_box(voxels: VoxelGrid, balls: &[Metaball], margin: f32) -> Vec<Vec<Metaball>> {
    let boxes = voxels.boxes();
    let near = |index: u32| {
        let first = UVec3::new(index % boxes.x, index / boxes.x % boxes.y, index / (boxes.x * boxes.y)) * LANES as u32;
        let a = voxels.voxel_center(first);
        let b = voxels.voxel_center(first + (LANES as u32 - 1));
        let reach = (a - b).length() * 0.5 + margin;
        let middle = (a + b) * 0.5;
        let reaches = |ball: &&Metaball| ball.offset(middle).length() < reach + 1.0 / ball.inverse_radius;
        balls.iter().filter(reaches).copied().collect()
    };
    (0..boxes.element_product()).map(near).collect()
}
