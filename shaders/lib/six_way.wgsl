// Light on a sprite by six pictures: what it shows under light from its right, top and front, and from its left, bottom and back.

// What a texel of either half of a six-way map stands for. Its square root is stored: dark sides keep their steps in 8 bits.
fn six_way_from_texel(texel: vec3f) -> vec3f {
    return texel * texel;
}

// How much light is scattered by an angle of this cosine, but for a factor: (1 - anisotropy^2) / 4 pi makes it a share for each
// steradian. (Henyey and Greenstein, "Diffuse radiation in the galaxy", 1941) `anisotropy` is the mean cosine, within +-0.95.
fn henyey_greenstein(cosine: f32, anisotropy: f32) -> f32 {
    let base = 1.0 + anisotropy * anisotropy - 2.0 * anisotropy * cosine;
    return inverseSqrt(base) / base;
}

// How much each axis counts for a light. Between the side and the front or the back, as light is scattered between those angles: smoke
// that scatters onwards glows straight before a light, and much less beside it. What is left is shared by right or left and top or
// bottom, by the squares of the light's shares of them. (After McTaggart, "Half-Life 2 / Valve Source shading", GDC 2004: the
// ambient cube)
fn six_way_shares(to_light: vec3f, anisotropy: f32) -> vec3f {
    // As if light were scattered evenly, all angles would be alike, and nothing to go by.
    let g = max(anisotropy, 0.02);
    let beside = henyey_greenstein(0.0, g);
    let end = henyey_greenstein(select(-1.0, 1.0, to_light.z < 0.0), g);
    let along = saturate((henyey_greenstein(-to_light.z, g) - beside) / (end - beside));
    let squares = to_light.xy * to_light.xy;
    return vec3f(squares * ((1.0 - along) / max(squares.x + squares.y, 1.0e-6)), along);
}

// What is shown of a light. `positive` under light from x, y and z, `negative` from the other side.
fn six_way_response(positive: vec3f, negative: vec3f, to_light: vec3f, anisotropy: f32) -> f32 {
    return dot(six_way_shares(to_light, anisotropy), select(negative, positive, to_light > vec3f(0.0)));
}

struct SixWay {
    positive: vec3f,
    negative: vec3f,
}

// Turns the light of a sprite with the sprite: rotation is (cos, sin), counter-clockwise. Each side is what six_way_response() has
// of light that comes from there, to the sprite as it was.
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

// Where smoke faces that is lit more from one side than from the other: the normal that a six-way map stands for.
fn normal_from_six_way(positive: vec3f, negative: vec3f) -> vec3f {
    let slope = positive - negative;
    let square = dot(slope, slope);
    if square < 1.0e-12 {
        return vec3f(0.0, 0.0, 1.0);
    }
    return slope * inverseSqrt(square);
}
