//! Detail of a sprite's image that is lost where the texels of a target are large.

use glam::{UVec2, Vec2, Vec4, Vec4Swizzles};

use crate::formula::texture::Texture2dArray;

/// Mip levels that are measured; the last one stands for all that follow.
const LEVELS: usize = 6;
/// Frames that stand for the whole flipbook, and texels that stand for a whole frame.
const FRAMES: u32 = 2;
const TEXELS: u32 = 1024;
/// Distance of the texels, which meets all positions within the texels of a coarser level.
const STRIDE: u32 = 40_503;
/// Power of a texel's size that the error of interpolating an image between them grows with, if the texels are smaller
/// than those of the image.
const MAGNIFIED_POWER: f32 = 1.5;

/// Detail of a sprite, by the size of a target's texels. Root mean squares over the sprite's square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpriteDetail {
    /// Of the amount in the full image.
    pub amount: f32,
    /// Difference between level 0 and mip level 1, 2 …, upsampled.
    lost: [LostDetail; LEVELS],
}

/// Detail that a target loses of a sprite. Root mean squares over the sprite's square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LostDetail {
    /// Of the amount.
    pub amount: f32,
    /// Of the normal times the amount.
    pub normal: f32,
}

impl SpriteDetail {
    /// Measures at most some of the frames.
    pub fn new(sprite: &impl Texture2dArray, frame_count: u32) -> Self {
        let step = frame_count.div_ceil(FRAMES).max(1);
        let frames = || (0..frame_count).step_by(step as usize);
        let mean = |square: &dyn Fn(u32) -> [f64; 2]| {
            let sum = frames().map(square).fold([0.0; 2], |sum, x| [sum[0] + x[0], sum[1] + x[1]]);
            sum.map(|sum| (sum / frames().count() as f64).sqrt() as f32)
        };
        let last = sprite.level_count() - 1;
        let lost = std::array::from_fn(|index| {
            let level = (index as u32 + 1).min(last);
            let [amount, normal] = mean(&|frame| squared_loss(sprite, frame, level));
            LostDetail { amount, normal }
        });
        let [amount, _] = mean(&|frame| mean_squares(sprite.dimensions(0), |at| sprite.load(at, frame, 0)));
        Self { amount, lost }
    }

    /// Detail that a target loses of a sprite at amount 1. `lod`: log2 of the sprite's texels per texel of the target,
    /// along a side.
    pub fn lost(&self, lod: f32) -> LostDetail {
        let position = lod - 1.0;
        let ([fine, coarse], fraction) = if position <= 0.0 {
            ([LostDetail::default(), self.lost[0]], (MAGNIFIED_POWER * position).exp2())
        } else {
            let index = (position as usize).min(LEVELS - 2);
            ([self.lost[index], self.lost[index + 1]], (position - index as f32).min(1.0))
        };
        let mix = |fine: f32, coarse: f32| fine + (coarse - fine) * fraction;
        LostDetail { amount: mix(fine.amount, coarse.amount), normal: mix(fine.normal, coarse.normal) }
    }
}

/// Mean squares of the difference between a frame and one of its levels, upsampled: of the amount, and of the normal times the
/// amount.
fn squared_loss(sprite: &impl Texture2dArray, frame: u32, level: u32) -> [f64; 2] {
    let size = sprite.dimensions(0);
    let coarse = sprite.dimensions(level);
    let premultiplied = |level, x: u32, y: u32| {
        let texel = sprite.load(UVec2::new(x, y), frame, level);
        ((texel.xyz() * 2.0 - 1.0) * texel.w).extend(texel.w)
    };
    let scale = coarse as f32 / size as f32;
    let bilinear = |at: UVec2| {
        let position = ((at.as_vec2() + 0.5) * scale - 0.5).clamp(Vec2::ZERO, Vec2::splat(coarse as f32 - 1.0));
        let low = position.as_uvec2();
        let fraction = position.fract();
        let high = (low + 1).min(UVec2::splat(coarse - 1));
        let row = |y| premultiplied(level, low.x, y).lerp(premultiplied(level, high.x, y), fraction.x);
        row(low.y).lerp(row(high.y), fraction.y)
    };
    mean_squares(size, |at| premultiplied(0, at.x, at.y) - bilinear(at))
}

/// Mean squares of the texels of a frame: of the amount, and of the rest.
fn mean_squares(size: u32, texel: impl Fn(UVec2) -> Vec4) -> [f64; 2] {
    let count = TEXELS.min(size * size);
    let positions =
        (0..count).map(|index| index.wrapping_mul(STRIDE) % (size * size)).map(|at| UVec2::new(at % size, at / size));
    let sum = positions.map(texel).fold([0.0; 2], |[amount, normal], texel| {
        [amount + f64::from(texel.w * texel.w), normal + f64::from(texel.xyz().length_squared())]
    });
    sum.map(|sum| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::super::{Sprite, SpriteLayout};

    #[test]
    fn coarse_texels_lose_more_of_fine_sprites() {
        let of = |name| {
            let columns = if name == "strands" { 2 } else { 4 };
            let layout = SpriteLayout { columns, rows: 2, y_down: false };
            *Sprite::load(format!("../../sprites/{name}.png").as_ref(), layout).unwrap().detail()
        };
        for name in ["puff", "wisp", "strands"] {
            let detail = of(name);
            let lods = (-8..=24).map(|step| 0.25 * step as f32);
            let rises = |(a, b): (f32, f32)| detail.lost(a).amount <= detail.lost(b).amount;
            assert!(lods.clone().zip(lods.skip(1)).all(rises), "{name}: {detail:?}");
            assert!(detail.lost(20.0).amount < detail.amount);
        }
        assert!(of("strands").lost(2.0).amount > of("puff").lost(2.0).amount);
    }

    #[test]
    fn an_even_sprite_loses_nothing() {
        let even = *Sprite::with_levels(16, 1, vec![[128, 128, 255, 90]; 256]).detail();
        assert!((-4..8).all(|lod| even.lost(lod as f32).amount < 0.01), "{even:?}");
        assert!((even.amount - 90.0 / 255.0).abs() < 1.0e-3, "{even:?}");
    }
}
