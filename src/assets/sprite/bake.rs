//! Bakes a sprite flipbook: a cluster of metaballs, eroded by turbulent noise, seen from the front.
//!
//! OTEE: "Grayscale heightmaps never get curvy enough … use metaballs, then add some procedural bump." So the baker has no
//! height map at all: it marches through a density volume and collects the normals on the way.

use std::path::Path;

use glam::{IVec2, IVec3, UVec2, UVec3, Vec2, Vec3};
use image::{Rgba, RgbaImage};

use super::detail::{detail, detail_size};
use super::{Sprite, SpriteLayout};
use crate::assets::json;
use crate::assets::noise::{curl_noise, fractal_noise, pcg3d, unit};
use crate::assets::picture::{MAX_SIDE, Picture};
use crate::error::{Error, FieldError};
use crate::formula::saturate;
use crate::settings::{FieldVisitor, Fields, validate};

/// The version of the recipe format that this code writes and reads.
pub const RECIPE_VERSION: u32 = 1;

/// How a sprite was made: the contents of a `*.sprite.json`. Lengths are in halves of the sprite's side, so the sprite
/// reaches from −1 to 1.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpriteRecipe {
    /// Format version.
    pub version: u32,
    /// Different seeds give different wisps of the same kind.
    pub seed: u32,
    /// Side of one frame.
    pub size: u32,
    /// Frames beside each other on the sheet.
    pub columns: u32,
    /// Frames below each other on the sheet. The flipbook loops.
    pub rows: u32,
    /// Metaballs in the cluster.
    pub balls: u32,
    /// How far from the middle their centres lie.
    pub spread: f32,
    /// Smallest reach of a ball's influence.
    pub ball_radius_min: f32,
    /// Largest reach of a ball's influence.
    pub ball_radius_max: f32,
    /// How far the balls travel round their places in one loop.
    pub drift: f32,
    /// Noise cells along the sprite's half side, for the coarsest octave.
    pub noise_frequency: f32,
    /// Octaves of noise, each of twice the frequency and `noise_gain` times the weight.
    pub noise_octaves: u32,
    /// Weight of an octave relative to the coarser one. Larger is rougher.
    pub noise_gain: f32,
    /// How much the noise takes away: 0 leaves balls, 1 leaves shreds.
    pub erosion: f32,
    /// How far the balls are drawn out along a swirling flow: curls instead of lumps.
    pub warp: f32,
    /// Extinction at full density. Larger is more opaque and has a harder edge.
    pub extinction: f32,
    /// Weight of the fine normals, a texel wide, against the broad ones, a twelfth of the sprite wide.
    pub bump: f32,
}

/// What a recipe makes.
#[derive(Clone, Debug)]
pub struct BakedSprite {
    /// The flipbook: rgb = normal / 2 + 1/2 (x right, y up, z to the viewer), a = amount.
    pub picture: RgbaImage,
    /// Depth and motion, see [`detail`](crate::assets::sprite::detail).
    pub detail: RgbaImage,
}

/// One moment of a sprite.
#[derive(Clone, Debug)]
pub struct BakedFrame {
    /// rgb = normal / 2 + 1/2, a = amount.
    pub picture: Picture<Rgba<u8>>,
    /// How far towards the viewer what is seen lies, -1..1 half sides.
    pub offset: Picture<f32>,
}

impl Fields for SpriteRecipe {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("version", &mut self.version, RECIPE_VERSION..=RECIPE_VERSION, "");
        visitor.seed("seed", &mut self.seed);
        // A frame is marched through a cube of its size; a sheet must be readable again.
        visitor.integer("size", &mut self.size, 8..=512, "pixels");
        let most = (MAX_SIDE / self.size.max(1)).min(16);
        visitor.integer("columns", &mut self.columns, 1..=most, "frames");
        visitor.integer("rows", &mut self.rows, 1..=most, "frames");
        visitor.integer("balls", &mut self.balls, 1..=256, "");
        visitor.number("spread", &mut self.spread, 0.0..=1.0, "half sides");
        visitor.number("ball_radius_min", &mut self.ball_radius_min, 0.02..=1.0, "half sides");
        visitor.number("ball_radius_max", &mut self.ball_radius_max, self.ball_radius_min..=1.0, "half sides");
        visitor.number("drift", &mut self.drift, 0.0..=0.5, "half sides");
        visitor.number("noise_frequency", &mut self.noise_frequency, 0.1..=32.0, "");
        visitor.integer("noise_octaves", &mut self.noise_octaves, 1..=8, "");
        visitor.number("noise_gain", &mut self.noise_gain, 0.0..=1.0, "");
        visitor.number("erosion", &mut self.erosion, 0.0..=4.0, "");
        visitor.number("warp", &mut self.warp, 0.0..=2.0, "");
        visitor.number("extinction", &mut self.extinction, 0.1..=200.0, "");
        visitor.number("bump", &mut self.bump, 0.0..=10.0, "");
    }
}

impl SpriteRecipe {
    /// Reads a `*.sprite.json`.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Json`] or [`Error::JsonField`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        json::load(path, RECIPE_VERSION, |recipe: &Self| validate(recipe, String::new))
    }

    /// Frames on the sheet.
    pub fn frame_count(&self) -> u32 {
        self.columns * self.rows
    }

    /// How the sheet is cut into frames.
    pub fn layout(&self) -> SpriteLayout {
        SpriteLayout { columns: self.columns, rows: self.rows, y_down: false }
    }

    /// Bakes the whole sheet and its details.
    ///
    /// # Errors
    /// The first number of the recipe that is out of range.
    pub fn bake(&self) -> Result<BakedSprite, FieldError> {
        validate(self, String::new)?;
        let frames: Vec<_> = (0..self.frame_count()).map(|frame| self.bake_frame(frame as f32)).collect();
        let pictures = frames.iter().flat_map(|frame| frame.picture.texels.iter().map(|texel| texel.0));
        let sprite = Sprite::with_levels(self.size, self.frame_count(), pictures.collect());
        let details: Vec<_> = (0..).zip(&frames).map(|(frame, baked)| detail(&sprite, frame, &baked.offset)).collect();
        Ok(BakedSprite {
            picture: self.sheet(self.size, |frame, at| frames[frame].picture.load(at)),
            detail: self.sheet(detail_size(self.size), |frame, at| details[frame].load(at)),
        })
    }

    fn sheet(&self, size: u32, texel: impl Fn(usize, IVec2) -> Rgba<u8>) -> RgbaImage {
        RgbaImage::from_fn(size * self.columns, size * self.rows, |x, y| {
            let frame = y / size * self.columns + x / size;
            texel(frame as usize, UVec2::new(x % size, y % size).as_ivec2())
        })
    }

    /// Bakes one moment of the loop; `frame` 0.5 is half way between the first two.
    pub fn bake_frame(&self, frame: f32) -> BakedFrame {
        let cluster = Cluster::new(self, frame / self.frame_count() as f32);
        // Slices of the volume below each other, the nearest to the viewer first.
        let mut volume = Picture::new(UVec2::new(self.size, self.size * self.size), 0.0);
        volume.for_each(|at, density| {
            let texel = UVec3::new(at.x, at.y % self.size, at.y / self.size);
            *density = cluster.density(self.position(texel));
        });
        let mut marched = Picture::new(UVec2::splat(self.size), (Rgba([128, 128, 255, 0]), 0.0));
        marched.for_each(|at, texel| *texel = self.march(&volume, at));
        let (picture, offset) = marched.texels.into_iter().unzip();
        let size = marched.size;
        BakedFrame { picture: Picture { size, texels: picture }, offset: Picture { size, texels: offset } }
    }

    /// The place of a voxel: x right, y up, z to the viewer.
    fn position(&self, voxel: UVec3) -> Vec3 {
        let p = (voxel.as_vec3() + 0.5) * (2.0 / self.size as f32) - 1.0;
        Vec3::new(p.x, -p.y, -p.z)
    }

    /// Front to back through one texel's column: the texel, and how far to the viewer what is seen of it lies.
    fn march(&self, volume: &Picture<f32>, at: UVec2) -> (Rgba<u8>, f32) {
        let last = self.size as i32 - 1;
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
        let wide = (self.size as i32 / 24).max(1);
        let step = 2.0 / self.size as f32;
        let mut transmittance = 1.0;
        let mut normal = Vec3::ZERO;
        let mut offset = 0.0;
        for z in 0..=last {
            let voxel = IVec3::new(at.x as i32, at.y as i32, z);
            let amount = 1.0 - (-density(voxel) * self.extinction * step).exp();
            if amount <= 0.0 {
                continue;
            }
            normal += (slope(voxel, wide) + slope(voxel, 1) * self.bump) * (transmittance * amount);
            offset += self.position(voxel.as_uvec3()).z * transmittance * amount;
            transmittance *= 1.0 - amount;
            if transmittance < 1.0 / 512.0 {
                break;
            }
        }
        let border = at.min_element() == 0 || at.max_element() == self.size - 1;
        let amount = if border { 0.0 } else { 1.0 - transmittance };
        // Where there is nothing the normal leans outwards, for filters that reach across the edge.
        let outwards = self.position(at.extend(0)).truncate().extend(0.5);
        let encoded = normal.normalize_or(outwards.normalize()) * 0.5 + 0.5;
        let channel = |value: f32| (saturate(value) * 255.0).round() as u8;
        let texel = Rgba([channel(encoded.x), channel(encoded.y), channel(encoded.z), channel(amount)]);
        (texel, offset / (1.0 - transmittance).max(1.0e-6))
    }
}

struct Ball {
    centre: Vec3,
    inverse_radius: f32,
}

/// One moment of the cluster.
struct Cluster<'a> {
    recipe: &'a SpriteRecipe,
    balls: Vec<Ball>,
    phase: Vec2,
}

impl<'a> Cluster<'a> {
    fn new(recipe: &'a SpriteRecipe, time: f32) -> Self {
        let phase = Vec2::from_angle(time * std::f32::consts::TAU);
        let balls = (0..recipe.balls).map(|index| {
            let random = |salt: u32| {
                let hash = pcg3d(UVec3::new(index, salt, recipe.seed));
                Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z))
            };
            let (place, shape) = (random(1), random(2));
            let z = place.x * 2.0 - 1.0;
            let xy = Vec2::from_angle(place.y * std::f32::consts::TAU) * (1.0 - z * z).sqrt();
            let distance = recipe.spread * place.z.sqrt();
            // The further out, the smaller: a body with puffs on it.
            let size = shape.x * (1.0 - 0.6 * place.z);
            let radius = recipe.ball_radius_min + (recipe.ball_radius_max - recipe.ball_radius_min) * size;
            let swing = Vec2::from_angle(shape.y * std::f32::consts::TAU).rotate(phase) * recipe.drift;
            Ball { centre: xy.extend(z) * distance + swing.extend(0.0), inverse_radius: 1.0 / radius }
        });
        Self { recipe, balls: balls.collect(), phase }
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
        let field: f32 = self
            .balls
            .iter()
            .map(|ball| (1.0 - ((p - ball.centre) * ball.inverse_radius).length_squared()).max(0.0).powi(3))
            .sum();
        if field <= 0.0 {
            return 0.0;
        }
        let body = 1.0 - (-2.0 * field).exp();
        let noise = fractal_noise(q, self.phase, seed, recipe.noise_octaves, 2.0, recipe.noise_gain).value;
        // Noise eats from the outside in: less where the body is thick.
        let eaten = recipe.erosion * (0.4 + noise) * (1.0 - 0.7 * body);
        (body - eaten).max(0.0) * window * window * (3.0 - 2.0 * window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_is_as_good_as_the_next() {
        let recipe = include_str!("../../../sprites/puff.sprite.json");
        let mut recipe: SpriteRecipe = json::parse(Path::new("puff.sprite.json"), recipe).unwrap();
        recipe.size = 8;
        // The second times 31 is the last word there is.
        for seed in [0, 1_108_378_657, u32::MAX] {
            let frame = SpriteRecipe { seed, ..recipe.clone() }.bake_frame(0.0);
            assert!(frame.offset.texels.iter().all(|offset| offset.is_finite()));
        }
    }
}
