//! Lighting of sprites by six-way maps. WGSL: `shaders/lib/six_way.wgsl`.

use glam::{Vec2, Vec2Swizzles, Vec3};

use super::saturate;

/// Response of a sprite to light from each of six sides. View space or the sprite's own: x right, y up, z towards the
/// viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SixWay {
    /// Response to light from the right, the top and the front.
    pub positive: Vec3,
    /// Response to light from the left, the bottom and the back.
    pub negative: Vec3,
}

/// Decodes a texel of either half of a six-way map. Maps store the square root, so that dark sides keep precision in 8
/// bits.
pub fn six_way_from_texel(texel: Vec3) -> Vec3 {
    texel * texel
}

/// Henyey-Greenstein phase function of a cosine, without its constant factor (1 − anisotropy²) ÷ 4π, which would make
/// it a fraction per steradian. `anisotropy` is the mean cosine, within ±0.95. (Henyey and Greenstein, "Diffuse radiation
/// in the galaxy", 1941)
pub fn henyey_greenstein(cosine: f32, anisotropy: f32) -> f32 {
    let base = 1.0 + anisotropy * anisotropy - 2.0 * anisotropy * cosine;
    1.0 / (base * base.sqrt())
}

/// Weights of the axes for a light. The z axis is weighted by the phase function between light from the side and light
/// from the front or back: smoke that scatters forward glows in line with a light and much less beside it. The rest
/// goes to x and y, by the squares of the direction. (After McTaggart, "Half-Life 2 / Valve Source shading", GDC 2004:
/// the ambient cube)
pub fn six_way_axis_weights(to_light: Vec3, anisotropy: f32) -> Vec3 {
    // At an anisotropy of 0 the phase function is constant, and `along` would be 0 / 0.
    let g = anisotropy.max(0.02);
    let end = if to_light.z < 0.0 { 1.0 } else { -1.0 };
    let beside = henyey_greenstein(0.0, g);
    let along = saturate((henyey_greenstein(-to_light.z, g) - beside) / (henyey_greenstein(end, g) - beside));
    let squares = to_light * to_light;
    let scale = (1.0 - along) / (squares.x + squares.y).max(1.0e-6);
    Vec3::new(squares.x * scale, squares.y * scale, along)
}

/// Response to a light. `positive` is for light from +x, +y and +z, `negative` for light from the opposite sides.
pub fn six_way_response(positive: Vec3, negative: Vec3, to_light: Vec3, anisotropy: f32) -> f32 {
    six_way_axis_weights(to_light, anisotropy).dot(Vec3::select(to_light.cmpgt(Vec3::ZERO), positive, negative))
}

/// Response of a sprite whose surface is tilted to the right and up. It is brighter from the sides that it turns to.
pub fn tilted_six_way(light: SixWay, tilt: Vec2) -> SixWay {
    let tilt = tilt.extend(0.0);
    SixWay {
        positive: light.positive * (1.0 + tilt).max(Vec3::ZERO),
        negative: light.negative * (1.0 - tilt).max(Vec3::ZERO),
    }
}

/// Rotates the response of a sprite with the sprite. `rotation` is (cos, sin), counter-clockwise. Each side becomes the
/// [`six_way_response`] of the unrotated sprite to light from that side.
pub fn rotate_six_way(positive: Vec3, negative: Vec3, rotation: Vec2) -> SixWay {
    let squares = rotation * rotation;
    let p = positive.truncate();
    let n = negative.truncate();
    let (along, against) = if rotation.x > 0.0 { (p, n) } else { (n, p) };
    let (up, down) = if rotation.y > 0.0 { (p.yx(), n.yx()) } else { (n.yx(), p.yx()) };
    SixWay {
        positive: (along * squares.x + Vec2::new(down.x, up.y) * squares.y).extend(positive.z),
        negative: (against * squares.x + Vec2::new(up.x, down.y) * squares.y).extend(negative.z),
    }
}

/// Normal of a six-way response: the direction of the largest difference between opposite sides; (0, 0, 1) if there is
/// none.
pub fn normal_from_six_way(positive: Vec3, negative: Vec3) -> Vec3 {
    let slope = positive - negative;
    let square = slope.length_squared();
    if square < 1.0e-12 { Vec3::Z } else { slope / square.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotating_the_sprite_equals_rotating_the_light_the_other_way() {
        let positive = Vec3::new(0.1, 0.5, 0.3);
        let negative = Vec3::new(0.9, 0.2, 0.7);
        for step in 0..32 {
            let rotation = Vec2::from_angle(step as f32 * 0.37);
            let turned = rotate_six_way(positive, negative, rotation);
            let x = Vec3::new(rotation.x, -rotation.y, 0.0);
            let y = Vec3::new(rotation.y, rotation.x, 0.0);
            let response = |to_light| six_way_response(positive, negative, to_light, 0.0);
            let expected =
                [(x, turned.positive.x), (y, turned.positive.y), (-x, turned.negative.x), (-y, turned.negative.y)];
            for (to_light, side) in expected {
                assert!((response(to_light) - side).abs() < 1e-6, "{rotation}");
            }
        }
    }
}
