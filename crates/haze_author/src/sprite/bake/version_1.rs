//! Recipe version 1: computes every voxel of a cube for every frame. Output stays bit-identical so that existing
//! recipes bake as before.

use glam::{IVec2, IVec3, UVec2, UVec3, Vec2, Vec3};
use image::Rgba;

use super::baked_frame::{BakedFrame, RayAccumulator};
use super::cluster::{Metaball, balls};
use super::sprite_recipe::SpriteRecipe;
use crate::deterministic_math::{cos_sin, exp};
use crate::path_trace::{DensityVolume, voxel_centre};
use haze::assets::image::Image;
use haze::assets::noise::{curl_noise, fractal_noise};
use haze::formula::saturate;

/// Bakes the frame at a time, as a fraction of the loop.
pub(super) fn frame(recipe: &SpriteRecipe, time: f32) -> BakedFrame {
    let size = recipe.size;
    let volume = densities(recipe, time);
    let mut marched = Image::new(UVec2::splat(size), (Rgba([128, 128, 255, 0]), 0.0));
    marched.for_each(|at, texel| *texel = march(recipe, &volume, at));
    BakedFrame::new(size, marched.texels)
}

/// Returns the density volume at a time, as a fraction of the loop.
pub(super) fn volume(recipe: &SpriteRecipe, time: f32) -> DensityVolume {
    DensityVolume { size: UVec3::splat(recipe.size), densities: densities(recipe, time).texels }
}

/// Returns the volume's slices below each other, the slice nearest to the viewer first.
fn densities(recipe: &SpriteRecipe, time: f32) -> Image<f32> {
    let size = recipe.size;
    let cluster = Cluster::new(recipe, time);
    let sides = UVec3::splat(size);
    let mut volume = Image::new(UVec2::new(size, size * size), 0.0);
    volume.for_each(|at, density| {
        let texel = UVec3::new(at.x, at.y % size, at.y / size);
        *density = cluster.density(voxel_centre(sides, texel));
    });
    volume
}

/// Marches one texel's column front to back. Returns the texel, and its visible offset towards the viewer in half
/// sides.
fn march(recipe: &SpriteRecipe, volume: &Image<f32>, at: UVec2) -> (Rgba<u8>, f32) {
    let sides = UVec3::splat(recipe.size);
    let last = recipe.size as i32 - 1;
    let density = |voxel: IVec3| {
        let voxel = voxel.clamp(IVec3::ZERO, IVec3::splat(last));
        volume.load(IVec2::new(voxel.x, voxel.z * (last + 1) + voxel.y))
    };
    let slope = |voxel: IVec3, reach: i32| {
        let along = |axis: IVec3| density(voxel - axis * reach) - density(voxel + axis * reach);
        // Voxel indices increase downwards and away from the viewer. z is clamped to 0 or more, so no normal faces away
        // from the viewer: normals of overlapping sprites must not cancel.
        let slope = Vec3::new(along(IVec3::X), -along(IVec3::Y), -along(IVec3::Z));
        slope.with_z(slope.z.max(0.0)).normalize_or_zero()
    };
    // Differences over a twelfth of the sprite: they show the balls but not the noise.
    let wide = (recipe.size as i32 / 24).max(1);
    let step = 2.0 / recipe.size as f32;
    let mut ray = RayAccumulator::new();
    for z in 0..=last {
        let voxel = IVec3::new(at.x as i32, at.y as i32, z);
        let amount = 1.0 - exp(-density(voxel) * recipe.extinction * step);
        if amount <= 0.0 {
            continue;
        }
        let normal = slope(voxel, wide) + slope(voxel, 1) * recipe.bump;
        ray.accumulate(amount, normal, voxel_centre(sides, voxel.as_uvec3()).z);
        if ray.is_opaque() {
            break;
        }
    }
    ray.texel(at, recipe.size, voxel_centre(sides, at.extend(0)).truncate())
}

/// The cluster at one moment.
struct Cluster<'a> {
    recipe: &'a SpriteRecipe,
    balls: Vec<Metaball>,
    phase: Vec2,
}

impl<'a> Cluster<'a> {
    fn new(recipe: &'a SpriteRecipe, time: f32) -> Self {
        let balls = balls(recipe, time);
        Self { recipe, balls, phase: cos_sin(time * std::f32::consts::TAU) }
    }

    /// Returns the density: 0 outside, about 1 inside.
    fn density(&self, p: Vec3) -> f32 {
        let recipe = self.recipe;
        let window = saturate((0.97 - p.length()) * 6.0);
        if window <= 0.0 {
            return 0.0;
        }
        // Warps the balls into curls before erosion.
        let q = p * recipe.noise_frequency;
        let seed = recipe.seed.wrapping_mul(31);
        let coarse = curl_noise(q * 0.5, self.phase, seed.wrapping_add(11));
        let p = p + (coarse + curl_noise(q + coarse, self.phase, seed.wrapping_add(17)) * 0.4) * recipe.warp;
        // Wyvill's soft objects, (1 − d²/r²)³: value and slope are 0 at distance r. Overlapping balls merge.
        let reach = |ball: &Metaball| (1.0 - ((p - ball.centre) * ball.inverse_radius).length_squared()).max(0.0);
        let field: f32 = self.balls.iter().map(reach).map(|inside| inside * inside * inside).sum();
        if field <= 0.0 {
            return 0.0;
        }
        let body = 1.0 - exp(-2.0 * field);
        let noise = fractal_noise(q, self.phase, seed, recipe.noise_octaves, 2.0, recipe.noise_gain).value;
        // Noise erodes less where the body is dense.
        let eaten = recipe.erosion * (0.4 + noise) * (1.0 - 0.7 * body);
        (body - eaten).max(0.0) * window * window * (3.0 - 2.0 * window)
    }
}
