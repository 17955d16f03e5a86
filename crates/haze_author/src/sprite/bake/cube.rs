//! Version 1: every voxel of a cube is worked out anew for every frame. Kept to the bit, for recipes that were written for it.

use glam::{IVec2, IVec3, UVec2, UVec3, Vec2, Vec3};
use image::Rgba;

use super::cluster::{Ball, balls};
use super::frame::{BakedFrame, Ray};
use super::recipe::SpriteRecipe;
use crate::exact::{direction, exp};
use crate::path_trace::{Volume, position};
use haze::assets::noise::{curl_noise, fractal_noise};
use haze::assets::picture::Picture;
use haze::formula::saturate;

/// One moment, a share of the loop.
pub(super) fn frame(recipe: &SpriteRecipe, time: f32) -> BakedFrame {
    let size = recipe.size;
    let volume = slices(recipe, time);
    let mut marched = Picture::new(UVec2::splat(size), (Rgba([128, 128, 255, 0]), 0.0));
    marched.for_each(|at, texel| *texel = march(recipe, &volume, at));
    BakedFrame::new(size, marched.texels)
}

/// Its densities.
pub(super) fn volume(recipe: &SpriteRecipe, time: f32) -> Volume {
    Volume { size: UVec3::splat(recipe.size), densities: slices(recipe, time).texels }
}

/// Slices of the volume below each other, the nearest to the viewer first.
fn slices(recipe: &SpriteRecipe, time: f32) -> Picture<f32> {
    let size = recipe.size;
    let cluster = Cluster::new(recipe, time);
    let sides = UVec3::splat(size);
    let mut volume = Picture::new(UVec2::new(size, size * size), 0.0);
    volume.for_each(|at, density| {
        let texel = UVec3::new(at.x, at.y % size, at.y / size);
        *density = cluster.density(position(sides, texel));
    });
    volume
}

/// Front to back through one texel's column: the texel, and how far to the viewer what is seen of it lies.
fn march(recipe: &SpriteRecipe, volume: &Picture<f32>, at: UVec2) -> (Rgba<u8>, f32) {
    let sides = UVec3::splat(recipe.size);
    let last = recipe.size as i32 - 1;
    let density = |voxel: IVec3| {
        let voxel = voxel.clamp(IVec3::ZERO, IVec3::splat(last));
        volume.load(IVec2::new(voxel.x, voxel.z * (last + 1) + voxel.y))
    };
    let slope = |voxel: IVec3, reach: i32| {
        let along = |axis: IVec3| density(voxel - axis * reach) - density(voxel + axis * reach);
        // Voxels count down and away from the viewer. Slopes that face away are turned side-on: every normal keeps a
        // part towards the viewer, so that overlapping sprites never cancel.
        let slope = Vec3::new(along(IVec3::X), -along(IVec3::Y), -along(IVec3::Z));
        slope.with_z(slope.z.max(0.0)).normalize_or_zero()
    };
    // A twelfth of the sprite: the balls show, the noise does not.
    let wide = (recipe.size as i32 / 24).max(1);
    let step = 2.0 / recipe.size as f32;
    let mut ray = Ray::new();
    for z in 0..=last {
        let voxel = IVec3::new(at.x as i32, at.y as i32, z);
        let amount = 1.0 - exp(-density(voxel) * recipe.extinction * step);
        if amount <= 0.0 {
            continue;
        }
        let normal = slope(voxel, wide) + slope(voxel, 1) * recipe.bump;
        ray.meet(amount, normal, position(sides, voxel.as_uvec3()).z);
        if ray.is_over() {
            break;
        }
    }
    ray.texel(at, recipe.size, position(sides, at.extend(0)).truncate())
}

/// One moment of the cluster.
struct Cluster<'a> {
    recipe: &'a SpriteRecipe,
    balls: Vec<Ball>,
    phase: Vec2,
}

impl<'a> Cluster<'a> {
    fn new(recipe: &'a SpriteRecipe, time: f32) -> Self {
        let balls = balls(recipe, time);
        Self { recipe, balls, phase: direction(time * std::f32::consts::TAU) }
    }

    /// 0 outside, about 1 inside.
    fn density(&self, p: Vec3) -> f32 {
        let recipe = self.recipe;
        let window = saturate((0.97 - p.length()) * 6.0);
        if window <= 0.0 {
            return 0.0;
        }
        // The balls are drawn out into curls before the noise eats them.
        let q = p * recipe.noise_frequency;
        let seed = recipe.seed.wrapping_mul(31);
        let coarse = curl_noise(q * 0.5, self.phase, seed.wrapping_add(11));
        let p = p + (coarse + curl_noise(q + coarse, self.phase, seed.wrapping_add(17)) * 0.4) * recipe.warp;
        // Wyvill's soft object, (1 − d²/r²)³: value and slope are 0 at its reach. Overlapping balls merge.
        let reach = |ball: &Ball| (1.0 - ((p - ball.centre) * ball.inverse_radius).length_squared()).max(0.0);
        let field: f32 = self.balls.iter().map(reach).map(|inside| inside * inside * inside).sum();
        if field <= 0.0 {
            return 0.0;
        }
        let body = 1.0 - exp(-2.0 * field);
        let noise = fractal_noise(q, self.phase, seed, recipe.noise_octaves, 2.0, recipe.noise_gain).value;
        // Noise eats from the outside in: less where the body is thick.
        let eaten = recipe.erosion * (0.4 + noise) * (1.0 - 0.7 * body);
        (body - eaten).max(0.0) * window * window * (3.0 - 2.0 * window)
    }
}
