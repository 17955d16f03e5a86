//! Converts height maps to normals, and silhouettes to height maps.

use glam::{IVec2, UVec2, Vec3};

use haze_core::assets::image::Image;

pub fn map_pixels(size: UVec2, value: impl Fn(UVec2) -> f32 + Sync) -> Image<f32> {
    let mut image = Image::new(size, 0.0);
    image.for_each(|at, gray| *gray = value(at));
    image
}

/// Returns the unnormalised normal of a height map. A height of 1 equals a half side times `strength`.
pub fn normal_of(height: &Image<f32>, at: IVec2, strength: f32) -> Vec3 {
    let slope =
        |step: IVec2| (height.load(at - step) - height.load(at + step)) * height.size.x as f32 * 0.25 * strength;
    Vec3::new(slope(IVec2::X), -slope(IVec2::Y), 1.0)
}

/// Builds a dome-like height map from a silhouette by summing blurs of doubling width. Thin parts are low, the middle
/// is high, and structure inside the amount is kept.
pub fn dome_heights(amount: &Image<f32>) -> Image<f32> {
    let mut height = Image::new(amount.size, 0.0);
    let mut blurred = amount.clone();
    let mut reach = 1;
    while reach < amount.size.x as i32 / 4 {
        // Three box blurs approximate a Gaussian.
        for _ in 0..3 {
            blurred = box_blur(&box_blur(&blurred, IVec2::X, reach), IVec2::Y, reach);
        }
        let weight = reach as f32 / amount.size.x as f32;
        height.for_each(|at, height| *height += blurred.load(at.as_ivec2()) * weight);
        reach *= 2;
    }
    let most = height.texels.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    // The square root makes the edge round, as on a ball.
    height.texels.iter_mut().for_each(|height| *height = (*height / most).sqrt());
    height
}

fn box_blur(image: &Image<f32>, step: IVec2, reach: i32) -> Image<f32> {
    map_pixels(image.size, |at| {
        let sum: f32 = (-reach..=reach).map(|offset| image.load(at.as_ivec2() + step * offset)).sum();
        sum / (2 * reach + 1) as f32
    })
}
