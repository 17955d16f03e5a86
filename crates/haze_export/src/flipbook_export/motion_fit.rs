//! Motion vectors, shortened to what the images between frames follow.
//!
//! Particles of a plume move through an outline and a light that stand still: smoke is born, lit and fades where other smoke
//! was before, and sparks fly in front of it. A vector is the mean over all particles. Each texel gets the length at which the frame
//! predicts the images halfway to the frames before and after, between which an engine uses it. Two frames alone do not tell it:
//! sparks and flames that are alike match each other's.

use glam::{IVec2, Vec2, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;

/// Lengths that are tried, as fractions of the way of the particles. More lengths lower the error by less than a hundredth.
const FRACTIONS: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Squared error that a vector of full length must save, or rest is as good: one code of 8 bits.
const FULL_LENGTH_COST: f32 = 1.0 / (255.0 * 255.0);

/// Images halfway from a frame to its neighbors: encoded, multiplied by opacity. `None` where no frame is.
#[derive(Clone, Copy)]
pub struct HalfwayImages<'a> {
    /// Between the frame before and this one.
    pub before: Option<&'a Image<Vec4>>,
    /// Between this frame and the next.
    pub after: Option<&'a Image<Vec4>>,
}

/// Shortens each vector to the length at which the frame, moved by half of it, is most like the images halfway to its neighbors.
/// Without such images all vectors are 0. `motion`: x to the right, y up, fractions of the frame; alpha stays. `frame`:
/// encoded, multiplied by opacity.
pub fn followed(motion: &Image<Vec4>, frame: &Image<Vec4>, halfway: HalfwayImages<'_>) -> Image<Vec4> {
    let size = motion.size.as_vec2();
    let mut followed = motion.clone();
    // No windows around texels: sparks are a texel wide, and the smoke beside them moves otherwise.
    followed.for_each(|at, way| {
        let error = |fraction: f32| {
            let half = way.xy() * size * Vec2::new(0.5, -0.5) * fraction;
            let difference = |image: Option<&Image<Vec4>>, position: Vec2| {
                image.map_or(0.0, |image| (sample(frame, position) - image.load(at.as_ivec2())).length_squared())
            };
            let before = difference(halfway.before, at.as_vec2() + half);
            let after = difference(halfway.after, at.as_vec2() - half);
            before + after + FULL_LENGTH_COST * fraction
        };
        let errors = FRACTIONS.map(|fraction| (fraction, error(fraction)));
        let best = errors.into_iter().min_by(|(_, a), (_, b)| a.total_cmp(b));
        let fraction = best.map_or(0.0, |(fraction, _)| fraction);
        *way = (way.xyz() * fraction).extend(way.w);
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

/// Bilinear filter; `position` in texels, 0 at the center of the first.
fn sample(image: &Image<Vec4>, position: Vec2) -> Vec4 {
    let low = position.floor();
    let fraction = position - position.floor();
    let last = image.size.as_ivec2() - 1;
    let load = |x: i32, y: i32| image.load((low.as_ivec2() + IVec2::new(x, y)).clamp(IVec2::ZERO, last));
    load(0, 0).lerp(load(1, 0), fraction.x).lerp(load(0, 1).lerp(load(1, 1), fraction.x), fraction.y)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    const SIDE: u32 = 48;

    fn image(texel: impl Fn(Vec2) -> f32 + Sync) -> Image<Vec4> {
        let mut image = Image::new(UVec2::splat(SIDE), Vec4::ZERO);
        image.for_each(|at, out| *out = Vec4::splat(texel(at.as_vec2())));
        image
    }

    fn disc(center: Vec2) -> impl Fn(Vec2) -> f32 {
        move |at| (1.2 - at.distance(center) / 10.0).clamp(0.0, 1.0)
    }

    /// The same vector everywhere: pixels to the right and up.
    fn even_motion(pixels: Vec2) -> Image<Vec4> {
        let way = pixels / SIDE as f32;
        let mut motion = image(disc(Vec2::splat(24.0)));
        motion.texels.iter_mut().for_each(|texel| *texel = Vec4::new(way.x, way.y, 0.0, texel.w));
        motion
    }

    /// Vectors that are left of a motion if images look so before a frame, in it and after it.
    fn left(motion: &Image<Vec4>, [before, frame, after]: [&Image<Vec4>; 3]) -> Image<Vec4> {
        followed(motion, frame, HalfwayImages { before: Some(before), after: Some(after) })
    }

    fn length(image: &Image<Vec4>, x: i32, y: i32) -> f32 {
        image.load(IVec2::new(x, y)).xy().length() * SIDE as f32
    }

    #[test]
    fn vectors_stay_where_frames_move_and_end_where_they_stand_still() {
        // Four pixels to the right and up.
        let motion = even_motion(Vec2::splat(4.0));
        let at = |offset: f32| image(disc(Vec2::new(24.0 + offset, 24.0 - offset)));
        let frame = at(0.0);
        // At the edge of the disc, where motion can be seen.
        let length = |image: &Image<Vec4>| length(image, 18, 30);
        let moved = left(&motion, [&at(-2.0), &frame, &at(2.0)]);
        let still = left(&motion, [&frame, &frame, &frame]);
        let slow = left(&motion, [&at(-1.0), &frame, &at(1.0)]);
        assert!((length(&moved) - 32.0_f32.sqrt()).abs() < 0.01, "{}", length(&moved));
        assert!((length(&slow) - 8.0_f32.sqrt()).abs() < 0.01, "{}", length(&slow));
        assert!(length(&still) < 0.01, "{}", length(&still));
        let alpha = |image: &Image<Vec4>| image.load(IVec2::splat(12)).w.to_bits();
        assert_eq!(alpha(&moved), alpha(&motion));
        // At the ends of a flipbook, one neighbor is enough.
        let after = at(2.0);
        let first = followed(&motion, &frame, HalfwayImages { before: None, after: Some(&after) });
        assert!((length(&first) - 32.0_f32.sqrt()).abs() < 0.01, "{}", length(&first));
        let alone = followed(&motion, &frame, HalfwayImages { before: None, after: None });
        assert!(length(&alone) < 0.01, "{}", length(&alone));
    }

    #[test]
    fn sparks_that_are_alike_move_although_frames_look_the_same() {
        // One spark takes the place of the next in each frame: eight pixels.
        let sparks = |offset: f32| image(move |at| f32::from((at.x - offset).rem_euclid(8.0) < 2.0));
        let motion = even_motion(Vec2::new(8.0, 0.0));
        let moved = left(&motion, [&sparks(-4.0), &sparks(0.0), &sparks(4.0)]);
        // Texels that have a spark halfway.
        for x in [20, 21, 28, 29] {
            assert!((length(&moved, x, 24) - 8.0).abs() < 0.01, "{x}: {}", length(&moved, x, 24));
        }
    }

    #[test]
    fn a_spark_does_not_move_the_flame_beside_it() {
        let flame = disc(Vec2::splat(24.0));
        let scene = |spark: f32| image(|at| 0.5 * flame(at) + f32::from(at.distance(Vec2::new(spark, 24.0)) < 0.5));
        let motion = even_motion(Vec2::new(6.0, 0.0));
        let moved = left(&motion, [&scene(21.0), &scene(24.0), &scene(27.0)]);
        for (x, y) in [(21, 24), (27, 24)] {
            assert!((length(&moved, x, y) - 6.0).abs() < 0.01, "{x} {y}: {}", length(&moved, x, y));
        }
        for (x, y) in [(21, 23), (21, 25), (27, 23), (16, 24), (24, 34)] {
            assert!(length(&moved, x, y) < 0.01, "{x} {y}: {}", length(&moved, x, y));
        }
    }
}
