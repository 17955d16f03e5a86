//! Motion vectors, shortened to what the frames follow.
//!
//! Particles of a plume move through an outline and a light that stand still: smoke is born, lit and fades where other smoke
//! was before. Where full vectors would move outline and light along, shorter ones predict the next frame better.

use glam::{IVec2, Vec2, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;

/// Lengths that are tried, as shares of the way of the particles.
const SHARES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Frames per radius of the windows in which errors are compared.
const WINDOWS: u32 = 24;

/// Shortens each vector to the length that predicts best, in a window around it, the one of two frames from the other.
/// `motion`: x to the right, y up, shares of the frame; alpha stays. `frames`: encoded, multiplied by opacity.
pub fn followed(motion: &Image<Vec4>, frames: [&Image<Vec4>; 2]) -> Image<Vec4> {
    let size = motion.size.as_vec2();
    let radius = (motion.size.min_element() / WINDOWS).max(1);
    let error = |share: f32| {
        let mut error = Image::new(motion.size, 0.0);
        error.for_each(|at, error| {
            let half = motion.load(at.as_ivec2()).xy() * size * Vec2::new(0.5, -0.5) * share;
            let place = at.as_vec2();
            *error = (sample(frames[0], place - half) - sample(frames[1], place + half)).length_squared();
        });
        blurred(&error, radius)
    };
    let errors = SHARES.map(error);
    let mut shares = Image::new(motion.size, 0.0);
    shares.for_each(|at, share| {
        // The first of equal errors: no motion where nothing can be seen.
        let best =
            errors.iter().zip(SHARES).min_by(|(a, _), (b, _)| a.load(at.as_ivec2()).total_cmp(&b.load(at.as_ivec2())));
        *share = best.map_or(0.0, |(_, share)| share);
    });
    let shares = blurred(&shares, radius);
    let mut followed = motion.clone();
    followed.for_each(|at, way| {
        let share = shares.load(at.as_ivec2());
        *way = (way.xyz() * share).extend(way.w);
    });
    followed
}

/// Shortens vectors that lead out of the frame, beyond which a sheet has another one: from each texel, the way to either side ends
/// half a texel inside. `motion` as in [`followed`].
pub fn kept_inside(motion: &Image<Vec4>) -> Image<Vec4> {
    let size = motion.size.as_vec2();
    let mut kept = motion.clone();
    kept.for_each(|at, way| {
        let at = at.as_vec2();
        // From the center of the texel to those at the borders.
        let room = at.min(size - 1.0 - at) / size;
        *way = way.xy().clamp(-room, room).extend(way.z).extend(way.w);
    });
    kept
}

/// Bilinear filter; `place` in texels, 0 at the center of the first.
fn sample(image: &Image<Vec4>, place: Vec2) -> Vec4 {
    let (low, share) = (place.floor(), place - place.floor());
    let last = image.size.as_ivec2() - 1;
    let load = |x: i32, y: i32| image.load((low.as_ivec2() + IVec2::new(x, y)).clamp(IVec2::ZERO, last));
    load(0, 0).lerp(load(1, 0), share.x).lerp(load(0, 1).lerp(load(1, 1), share.x), share.y)
}

/// Mean over a square of 2 · `radius` + 1 texels, first along rows, then along columns.
fn blurred(image: &Image<f32>, radius: u32) -> Image<f32> {
    let along = |image: &Image<f32>, step: IVec2| {
        let (last, radius) = (image.size.as_ivec2() - 1, radius as i32);
        let mut mean = Image::new(image.size, 0.0);
        mean.for_each(|at, mean| {
            let texel = |offset: i32| image.load((at.as_ivec2() + step * offset).clamp(IVec2::ZERO, last));
            *mean = (-radius..=radius).map(texel).sum::<f32>() / (2 * radius + 1) as f32;
        });
        mean
    };
    along(&along(image, IVec2::X), IVec2::Y)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    /// A soft disc.
    fn disc(center: Vec2) -> Image<Vec4> {
        let mut image = Image::new(UVec2::splat(48), Vec4::ZERO);
        image.for_each(|at, texel| *texel = Vec4::splat((1.2 - at.as_vec2().distance(center) / 10.0).clamp(0.0, 1.0)));
        image
    }

    #[test]
    fn vectors_stay_where_frames_move_and_end_where_they_stand_still() {
        let mut motion = disc(Vec2::splat(24.0));
        // Four pixels to the right and up.
        motion.texels.iter_mut().for_each(|texel| *texel = Vec4::new(4.0 / 48.0, 4.0 / 48.0, 0.0, texel.w));
        let from = disc(Vec2::new(22.0, 26.0));
        let moved = followed(&motion, [&from, &disc(Vec2::new(26.0, 22.0))]);
        let still = followed(&motion, [&from, &from]);
        let halfway = followed(&motion, [&from, &disc(Vec2::new(24.0, 24.0))]);
        let length = |image: &Image<Vec4>| image.load(IVec2::splat(24)).xy().length() * 48.0;
        assert!((length(&moved) - 32.0_f32.sqrt()).abs() < 0.01, "{}", length(&moved));
        assert!((length(&halfway) - 8.0_f32.sqrt()).abs() < 0.8, "{}", length(&halfway));
        assert!(length(&still) < 0.01, "{}", length(&still));
        let alpha = |image: &Image<Vec4>| image.load(IVec2::splat(12)).w.to_bits();
        assert_eq!(alpha(&moved), alpha(&motion));
    }
}
