//! State of recipe version 2 at one moment of the loop: ball positions, and displacement by flow and warp.

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3};

use super::cluster::{Ball, balls};
use super::recipe::SpriteRecipe;
use super::voxels::{RUN, Voxels};
use crate::exact::direction;
use haze::assets::image::Image;
use haze::assets::noise::curl_noise;

/// Displacement of a position by the flow alone, and by flow and warp together.
#[derive(Clone, Copy)]
pub(super) struct Shift {
    pub flow: Vec3,
    pub all: Vec3,
}

impl Shift {
    pub fn lerp(self, other: Self, share: f32) -> Self {
        Self { flow: self.flow.lerp(other.flow, share), all: self.all.lerp(other.all, share) }
    }
}

/// One column of voxels: its x, and its position in the grid of shifts.
#[derive(Clone, Copy)]
pub(super) struct Column {
    pub x: f32,
    pub node: usize,
    /// Fraction of the way from `node` to the next.
    pub share: f32,
}

/// State at one moment.
pub(super) struct LoopState {
    pub phase: Vec2,
    pub columns: Vec<Column>,
    /// Shifts on a cubic grid of `nodes` per side from −1 to 1, slices below each other.
    shifts: Image<Shift>,
    /// Balls that reach each box of [`RUN`] voxels per side.
    pub near: Vec<Vec<Ball>>,
}

impl LoopState {
    pub fn new(recipe: &SpriteRecipe, voxels: Voxels, time: f32) -> Self {
        let turning = direction(time * std::f32::consts::TAU);
        // With `travel`, the noise is carried along and does not turn in place.
        let phase = if recipe.travel > 0.0 { Vec2::X } else { turning };
        let nodes = ((recipe.noise_frequency * 8.0) as u32).clamp(16, 64);
        let mut shifts = Image::new(UVec2::new(nodes, nodes * nodes), Shift { flow: Vec3::ZERO, all: Vec3::ZERO });
        let seed = recipe.seed.wrapping_mul(31);
        shifts.for_each(|at, shift| {
            let node = UVec3::new(at.x, at.y % nodes, at.y / nodes).as_vec3();
            let p = node * (2.0 / (nodes - 1) as f32) - 1.0;
            if recipe.travel > 0.0 {
                shift.flow = curl_noise(p * 0.8, turning, seed.wrapping_add(23)) * recipe.travel;
            }
            shift.all = shift.flow;
            if recipe.warp > 0.0 {
                let q = (p + shift.flow) * recipe.noise_frequency;
                let coarse = curl_noise(q * 0.5, phase, seed.wrapping_add(11));
                shift.all += (coarse + curl_noise(q + coarse, phase, seed.wrapping_add(17)) * 0.4) * recipe.warp;
            }
        });
        let margin = shifts.texels.iter().map(|shift| shift.all.length()).fold(0.0, f32::max);
        let column = |index: u32| {
            let x = (index as f32 + 0.5) * (2.0 / recipe.size as f32) - 1.0;
            let place = (x.min(1.0) + 1.0) * 0.5 * (nodes - 1) as f32;
            let node = (place as u32).min(nodes - 2);
            Column { x, node: node as usize, share: place - node as f32 }
        };
        let columns = (0..recipe.size).map(column).collect();
        Self { phase, columns, near: near(voxels, &balls(recipe, time), margin), shifts }
    }

    /// Returns the shifts of one row, at the grid nodes along x.
    pub fn shifts_along(&self, p: Vec3) -> Vec<Shift> {
        let shifts = &self.shifts;
        let nodes = shifts.size.x as i32;
        let at = (p + 1.0) * 0.5 * (nodes - 1) as f32;
        let low = at.floor();
        let share = at - low;
        let load = |x, y: i32, z: i32| shifts.load(IVec2::new(x, z.min(nodes - 1) * nodes + y.min(nodes - 1)));
        let low = low.as_ivec3();
        let along = |x| {
            let near = load(x, low.y, low.z).lerp(load(x, low.y + 1, low.z), share.y);
            near.lerp(load(x, low.y, low.z + 1).lerp(load(x, low.y + 1, low.z + 1), share.y), share.z)
        };
        (0..nodes).map(along).collect()
    }
}

fn near(voxels: Voxels, balls: &[Ball], margin: f32) -> Vec<Vec<Ball>> {
    let boxes = voxels.boxes();
    let near = |index: u32| {
        let first = UVec3::new(index % boxes.x, index / boxes.x % boxes.y, index / (boxes.x * boxes.y)) * RUN as u32;
        let (a, b) = (voxels.position(first), voxels.position(first + (RUN as u32 - 1)));
        let reach = (a - b).length() * 0.5 + margin;
        let middle = (a + b) * 0.5;
        let reaches = |ball: &&Ball| ball.offset(middle).length() < reach + 1.0 / ball.inverse_radius;
        balls.iter().filter(reaches).copied().collect()
    };
    (0..boxes.element_product()).map(near).collect()
}
