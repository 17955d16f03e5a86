//! Detail maps: depth of each texel, for depth sprites, and motion to the next frame, for flipbook blending without
//! ghosting.
//!
//! A detail map has the layout of its sprite at a quarter of its size: r = offset towards the viewer, g and b = motion
//! right and down, a = amount. 128 encodes 0; 1 and 255 encode -1 and 1, in half sides of the sprite for r and in units
//! of [`MOTION_RANGE`] sides for g and b.

use glam::{IVec2, Mat2, UVec2, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::Sprite;
use haze_core::formula::sprite::MOTION_RANGE;
use image::Rgba;

use crate::deterministic_math::exp;

/// Mip level of the sprite with the size of the detail map. Depth and motion are smooth enough for a quarter of the
/// size.
const LEVEL: u32 = 2;

/// Returns the side of one frame of the detail map, texels.
pub(crate) fn detail_size(sprite_size: u32) -> u32 {
    (sprite_size >> LEVEL).max(1)
}

/// Computes one frame of the detail map. `offset` has the size of the sprite, `motion` is in its sides, y down, as
/// [`optical_flow`] returns it.
pub fn bake_detail_frame(sprite: &Sprite, frame: u32, offset: &Image<f32>, motion: &Image<Vec2>) -> Image<Rgba<u8>> {
    let size = detail_size(sprite.size());
    let mut image = Image::new(UVec2::splat(size), Rgba([128, 128, 128, 0]));
    let scale = sprite.size() / size;
    image.for_each(|at, texel| {
        // Mean offset of the covered texels, weighted by amount.
        let mut sum = 0.0;
        let mut weight = 0.0;
        for index in 0..scale * scale {
            let fine = at * scale + UVec2::new(index % scale, index / scale);
            let amount = sprite.texel(0, frame, fine.x, fine.y).w;
            sum += offset.load(fine.as_ivec2()) * amount;
            weight += amount;
        }
        let signed = |value: f32| (128.0 + 127.0 * value.clamp(-1.0, 1.0)).round() as u8;
        let motion = motion.load(at.as_ivec2()) / MOTION_RANGE;
        // The border must be clear, as in sprites.
        let border = at.min_element() == 0 || at.max_element() == size - 1;
        let amount = if border { 0.0 } else { sprite.texel(LEVEL, frame, at.x, at.y).w };
        let offset = if weight > 0.0 { sum / weight } else { 0.0 };
        *texel = Rgba([signed(offset), signed(motion.x), signed(motion.y), (amount * 255.0).round() as u8]);
    });
    image
}

/// Computes each texel's motion from `frame` to the next, in sides of the sprite, y down. Optical flow by least squares
/// in a window, from coarse to fine. (Lucas and Kanade, "An iterative image registration technique", 1981; pyramid
/// after Bouguet, 2001) `start`, of the size of the detail map, is a motion that is known already: it is only refined.
pub fn optical_flow(sprite: &Sprite, frame: u32, start: Option<&Image<Vec2>>) -> Image<Vec2> {
    let next = (frame + 1) % sprite.frame_count();
    let levels = if start.is_some() { 0 } else { 2 };
    let coarsest = (LEVEL + levels).min(sprite.level_count() - 1);
    let mut flow = start.cloned().unwrap_or(Image::new(UVec2::ONE, Vec2::ZERO));
    for level in (LEVEL.min(coarsest)..=coarsest).rev() {
        let from = features(sprite, frame, level);
        let to = features(sprite, next, level);
        // Starts from the coarser level's flow, converted to texels of this level.
        let size = from.size.x as f32;
        let mut finer = Image::new(from.size, Vec2::ZERO);
        finer.for_each(|at, texel| {
            *texel = bilinear(&flow, (at.as_vec2() + 0.5) * flow.size.as_vec2() / size - 0.5) * size;
        });
        for _ in 0..ITERATIONS {
            finer = refine(&from, &to, &finer);
        }
        finer.texels.iter_mut().for_each(|motion| *motion /= size);
        flow = finer;
    }
    flow
}

const ITERATIONS: u32 = 6;
/// Radius of the window whose texels share a motion, texels.
const WINDOW: i32 = 4;
/// Regularisation: keeps texels still where the features do not determine their motion.
const STIFFNESS: f32 = 0.02;

/// Returns the features that are matched between frames: amount, and normal xy times amount.
fn features(sprite: &Sprite, frame: u32, level: u32) -> Image<Vec3> {
    let mut image = Image::new(UVec2::splat(sprite.level_size(level)), Vec3::ZERO);
    image.for_each(|at, feature| {
        let texel = sprite.texel(level, frame, at.x, at.y);
        *feature = Vec3::new(1.0, texel.x * 2.0 - 1.0, texel.y * 2.0 - 1.0) * texel.w;
    });
    image
}

/// Performs one least-squares step at every texel.
fn refine(from: &Image<Vec3>, to: &Image<Vec3>, flow: &Image<Vec2>) -> Image<Vec2> {
    // Each texel's contribution to the normal equations.
    let mut local = Image::new(from.size, (Mat2::ZERO, Vec2::ZERO));
    local.for_each(|at, (matrix, right)| {
        let at = at.as_ivec2();
        let moved = at.as_vec2() + flow.load(at);
        // Gradients of the features along x and y, and the residual.
        let x = (bilinear(to, moved + Vec2::X) - bilinear(to, moved - Vec2::X)) * 0.5;
        let y = (bilinear(to, moved + Vec2::Y) - bilinear(to, moved - Vec2::Y)) * 0.5;
        let rest = from.load(at) - bilinear(to, moved);
        *matrix = Mat2::from_cols(Vec2::new(x.dot(x), x.dot(y)), Vec2::new(x.dot(y), y.dot(y)));
        *right = Vec2::new(x.dot(rest), y.dot(rest));
    });
    let offsets = (-WINDOW..=WINDOW).flat_map(|dy| (-WINDOW..=WINDOW).map(move |dx| IVec2::new(dx, dy)));
    let weight = |offset: IVec2| exp(-offset.as_vec2().length_squared() / (WINDOW * WINDOW) as f32 * 2.0);
    let window: Vec<_> = offsets.map(|offset| (offset, weight(offset))).collect();
    let mut refined = Image::new(from.size, Vec2::ZERO);
    refined.for_each(|at, motion| {
        let at = at.as_ivec2();
        let mut matrix = Mat2::from_diagonal(Vec2::splat(STIFFNESS));
        let mut right = Vec2::ZERO;
        // Mean motion of the window, for smoothing.
        let mut mean = Vec2::ZERO;
        let mut total = 0.0;
        for &(offset, weight) in &window {
            let (of_texel, right_of_texel) = local.load(at + offset);
            matrix += of_texel * weight;
            right += right_of_texel * weight;
            mean += flow.load(at + offset) * weight;
            total += weight;
        }
        let step = matrix.inverse() * right;
        *motion = flow.load(at).lerp(mean / total, 0.5) + step.clamp_length_max(1.0);
    });
    refined
}

fn bilinear<T>(image: &Image<T>, at: Vec2) -> T
where
    T: Copy + Send + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f32, Output = T>,
{
    let base = at.floor();
    let f = at - base;
    let load = |dx, dy| image.load(base.as_ivec2() + IVec2::new(dx, dy));
    let top = load(0, 0) + (load(1, 0) - load(0, 0)) * f.x;
    let bottom = load(0, 1) + (load(1, 1) - load(0, 1)) * f.x;
    top + (bottom - top) * f.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_core::assets::sprite::SpriteLayout;
    use image::RgbaImage;

    #[test]
    fn optical_flow_follows_a_moving_ball() {
        // Two frames of 64 texels: a ball, then the same ball moved 3 texels right and 2 up.
        let sheet = RgbaImage::from_fn(128, 64, |x, y| {
            let middle = if x < 64 { Vec2::new(30.0, 33.0) } else { Vec2::new(64.0 + 33.0, 31.0) };
            let p = (Vec2::new(x as f32, y as f32) - middle) / 18.0;
            let inside = (1.0 - p.length_squared()).max(0.0);
            let channel = |v: f32| (v * 255.0) as u8;
            Rgba([channel(p.x * 0.5 + 0.5), channel(0.5 - p.y * 0.5), 255, channel(inside)])
        });
        let layout = SpriteLayout { columns: 2, rows: 1, y_down: false };
        let sprite = Sprite::from_image(std::path::Path::new("ball"), &sheet, layout).unwrap();
        let found = optical_flow(&sprite, 0, None).load(IVec2::new(7, 8)) * 64.0;
        assert!(found.distance(Vec2::new(3.0, -2.0)) < 0.4, "{found}");
    }
}
