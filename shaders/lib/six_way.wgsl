// Lighting of sprites by six-way maps: responses to light from right, top and front, and from left, bottom and back.

// Decodes a texel of either half of a six-way map. Maps store the square root, so that dark sides keep precision in 8
// bits.
fn six_way_from_texel(texel: vec3f) -> vec3f {
    return texel * texel;
}

// Henyey-Greenstein phase function of a cosine, without its constant factor (1 - anisotropy^2) / 4 pi, which would make
// it a fraction per steradian. `anisotropy` is the mean cosine, within +-0.95. (Henyey and Greenstein, "Diffuse radiation
// in the galaxy", 1941)
fn henyey_greenstein(cosine: f32, anisotropy: f32) -> f32 {
    let base = 1.0 + anisotropy * anisotropy - 2.0 * anisotropy * cosine;
    return inverseSqrt(base) / base;
}

// Weights of the axes for a light. The z axis is weighted by the phase function between light from the side and light
// from the front or back: smoke that scatters forward glows in line with a light and much less beside it. The rest goes
// to x and y, by the squares of the direction. (After McTaggart, "Half-Life 2 / Valve Source shading", GDC 2004: the
// ambient cube)
fn six_way_axis_weights(to_light: vec3f, anisotropy: f32) -> vec3f {
    // At an anisotropy of 0 the phase function is constant, and `along` would be 0 / 0.
    let g = max(anisotropy, 0.02);
    let beside = henyey_greenstein(0.0, g);
    let end = henyey_greenstein(select(-1.0, 1.0, to_light.z < 0.0), g);
    let along = saturate((henyey_greenstein(-to_light.z, g) - beside) / (end - beside));
    let squares = to_light.xy * to_light.xy;
    return vec3f(squares * ((1.0 - along) / max(squares.x + squares.y, 1.0e-6)), along);
}

// Response to a light. `positive` is for light from +x, +y and +z, `negative` for light from the opposite sides.
fn six_way_response(positive: vec3f, negative: vec3f, to_light: vec3f, anisotropy: f32) -> f32 {
    return dot(six_way_axis_weights(to_light, anisotropy), select(negative, positive, to_light > vec3f(0.0)));
}

struct SixWay {
    positive: vec3f,
    negative: vec3f,
}

// Response of a sprite whose surface is tilted to the right and up. It is brighter from the sides that it turns to.
fn tilted_six_way(light: SixWay, tilt: vec2f) -> SixWay {
    return SixWay(
        light.positive * max(1.0 + vec3f(tilt, 0.0), vec3f(0.0)),
        light.negative * max(1.0 - vec3f(tilt, 0.0), vec3f(0.0)),
    );
}

// Rotates the response of a sprite with the sprite. `rotation` is (cos, sin), counter-clockwise. Each side becomes the
// six_way_response() of the unrotated sprite to light from that side.
fn rotate_six_way(positive: vec3f, negative: vec3f, rotation: vec2f) -> SixWay {
    let squares = rotation * rotation;
    let turned = rotation > vec2f(0.0);
    let along = select(negative.xy, positive.xy, turned.x);
    let against = select(positive.xy, negative.xy, turned.x);
    let up = select(negative.yx, positive.yx, turned.y);
    let down = select(positive.yx, negative.yx, turned.y);
    return SixWay(
        vec3f(along * squares.x + vec2f(down.x, up.y) * squares.y, positive.z),
        vec3f(against * squares.x + vec2f(up.x, down.y) * squares.y, negative.z),
    );
}

// Normal of a six-way response: the direction of the largest difference between opposite sides; (0, 0, 1) if there is
// none.
fn normal_from_six_way(positive: vec3f, negative: vec3f) -> vec3f {
    let slope = positive - negative;
    let square = dot(slope, slope);
    if square < 1.0e-12 {
        return vec3f(0.0, 0.0, 1.0);
    }
    return slope * inverseSqrt(square);
}
