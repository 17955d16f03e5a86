// Encoding and decoding of normals in the accumulation target. View space: x right, y up, z towards the viewer.

const NORMAL_ENCODING_SIGNED: u32 = 0u;
const NORMAL_ENCODING_BIASED: u32 = 1u;
const NORMAL_DECODE_EXACT: u32 = 0u;
const NORMAL_DECODE_LITERAL: u32 = 1u;

// Output of one sprite fragment to the blend unit: normal times amount, and the amount. (OTEE "Accumulating") `weight`
// scales the normal; it is 1 under the order `sorted`.
fn accumulation_from_normal(encoding: u32, normal: vec3f, amount: f32, weight: f32) -> vec4f {
    if encoding == NORMAL_ENCODING_BIASED {
        return vec4f((normal * 0.5 + 0.5) * (amount * weight), amount);
    }
    return vec4f(normal * (amount * weight), amount);
}

// Unit normal of an accumulated texel.
// The target was cleared to 0, and blended layers have weights that sum to the amount A. Biased normals e = n/2 + 1/2
// therefore give rgb = sum(w·n)/2 + A/2, and 2·rgb - A = sum(w·n) is exact at every amount. OTEE's normalize(rgb·2 - 1)
// equals it only at A = 1; it is kept as NORMAL_DECODE_LITERAL. A zero vector (empty, or cancelled) faces the viewer.
// `weights` is the sum of the layers' weights: A, unless normals are weighted.
fn normal_from_accumulation(encoding: u32, decode: u32, rgb: vec3f, weights: f32) -> vec3f {
    var normal = rgb;
    if decode == NORMAL_DECODE_LITERAL {
        normal = rgb * 2.0 - 1.0;
    } else if encoding == NORMAL_ENCODING_BIASED {
        normal = rgb * 2.0 - weights;
    }
    let square = dot(normal, normal);
    if square < 1.0e-12 {
        return vec3f(0.0, 0.0, 1.0);
    }
    return normal * inverseSqrt(square);
}

// Rotates a sprite's normal with the sprite. `rotation` is (cos, sin), counter-clockwise.
fn rotate_normal(normal: vec3f, rotation: vec2f) -> vec3f {
    return vec3f(
        normal.x * rotation.x - normal.y * rotation.y,
        normal.x * rotation.y + normal.y * rotation.x,
        normal.z,
    );
}
