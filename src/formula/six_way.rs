//! Light on a sprite by six pictures. `shaders/lib/six_way.wgsl`.

use glam::{Vec2, Vec2Swizzles, Vec3};

use super::saturate;

/// What a sprite shows under light from each side, view space or its own: x right, y up, z to the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SixWay {
    /// Under light from the right, the top and the front.
    pub positive: Vec3,
    /// Under light from the left, the bottom and the back.
    pub negative: Vec3,
}

/// What a texel of either half of a six-way map stands for. Its square root is stored: dark sides keep their steps in 8 bits.
pub fn six_way_from_texel(texel: Vec3) -> Vec3 {
    texel * texel
}

/// How much light is scattered by an angle of this cosine, but for a factor: (1 − anisotropy²) ÷ 4π makes it a share for each
/// steradian. (Henyey and Greenstein, "Diffuse radiation in the galaxy", 1941) `anisotropy` is the mean cosine, within ±0.95.
pub fn henyey_greenstein(cosine: f32, anisotropy: f32) -> f32 {
    let base = 1.0 + anisotropy * anisotropy - 2.0 * anisotropy * cosine;
    1.0 / (base * base.sqrt())
}

/// How much each axis counts for a light. Between the side and the front or the back, as light is scattered between those angles: smoke
/// that scatters onwards glows straight before a light, and much less beside it. What is left is shared by right or left and top or
/// bottom, by the squares of the light's shares of them. (After McTaggart, "Half-Life 2 / Valve Source shading", GDC 2004: the
/// ambient cube)
pub fn six_way_shares(to_light: Vec3, anisotropy: f32) -> Vec3 {
    // As if light were scattered evenly, all angles would be alike, and nothing to go by.
    let g = anisotropy.max(0.02);
    let end = if to_light.z < 0.0 { 1.0 } else { -1.0 };
    let beside = henyey_greenstein(0.0, g);
    let along = saturate((henyey_greenstein(-to_light.z, g) - beside) / (henyey_greenstein(end, g) - beside));
    let squares = to_light * to_light;
    let scale = (1.0 - along) / (squares.x + squares.y).max(1.0e-6);
    Vec3::new(squares.x * scale, squares.y * scale, along)
}

/// What is shown of a light. `positive` under light from x, y and z, `negative` from the other side.
pub fn six_way_response(positive: Vec3, negative: Vec3, to_light: Vec3, anisotropy: f32) -> f32 {
    six_way_shares(to_light, anisotropy).dot(Vec3::select(to_light.cmpgt(Vec3::ZERO), positive, negative))
}

/// Turns the light of a sprite with the sprite: rotation is (cos, sin), counter-clockwise. Each side is what [`six_way_response`] has of
/// light that comes from there, to the sprite as it was.
pub fn rotate_six_way(positive: Vec3, negative: Vec3, rotation: Vec2) -> SixWay {
    let squares = rotation * rotation;
    let (p, n) = (positive.truncate(), negative.truncate());
    let (along, against) = if rotation.x > 0.0 { (p, n) } else { (n, p) };
    let (up, down) = if rotation.y > 0.0 { (p.yx(), n.yx()) } else { (n.yx(), p.yx()) };
    SixWay {
        positive: (along * squares.x + Vec2::new(down.x, up.y) * squares.y).extend(positive.z),
        negative: (against * squares.x + Vec2::new(up.x, down.y) * squares.y).extend(negative.z),
    }
}

/// Where smoke faces that is lit more from one side than from the other: the normal that a six-way map stands for.
pub fn normal_from_six_way(positive: Vec3, negative: Vec3) -> Vec3 {
    let slope = positive - negative;
    let square = slope.length_squared();
    if square < 1.0e-12 { Vec3::Z } else { slope / square.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sprite_that_turns_answers_as_light_that_turns_the_other_way() {
        let (positive, negative) = (Vec3::new(0.1, 0.5, 0.3), Vec3::new(0.9, 0.2, 0.7));
        for step in 0..32 {
            let rotation = Vec2::from_angle(step as f32 * 0.37);
            let turned = rotate_six_way(positive, negative, rotation);
            let (x, y) = (Vec3::new(rotation.x, -rotation.y, 0.0), Vec3::new(rotation.y, rotation.x, 0.0));
            let response = |to_light| six_way_response(positive, negative, to_light, 0.0);
            let expected =
                [(x, turned.positive.x), (y, turned.positive.y), (-x, turned.negative.x), (-y, turned.negative.y)];
            for (to_light, side) in expected {
                assert!((response(to_light) - side).abs() < 1e-6, "{rotation}");
            }
        }
    }
}
