//! Encoding and decoding of normals in the accumulation target. WGSL: `shaders/lib/normal.wgsl`.

use glam::{Vec2, Vec3, Vec4};

use crate::settings::{NormalDecode, NormalEncoding};

/// Output of one sprite fragment to the blend unit: normal times amount, and the amount. (OTEE "Accumulating") `weight`
/// scales the normal; it is 1 under the order `sorted`.
pub fn accumulation_from_normal(encoding: NormalEncoding, normal: Vec3, amount: f32, weight: f32) -> Vec4 {
    match encoding {
        NormalEncoding::Biased => ((normal * 0.5 + 0.5) * (amount * weight)).extend(amount),
        NormalEncoding::Signed => (normal * (amount * weight)).extend(amount),
    }
}

/// Unit normal of an accumulated texel; (0, 0, 1) if it is empty or cancels out.
///
/// With Σ weights = A, biased normals sum to rgb = Σw·n/2 + A/2, so n ∝ 2·rgb − A is exact. OTEE's literal decode
/// equals it only at A = 1. `weights` is Σ weights: A itself, unless normals are weighted.
pub fn normal_from_accumulation(encoding: NormalEncoding, decode: NormalDecode, rgb: Vec3, weights: f32) -> Vec3 {
    let normal = match (decode, encoding) {
        (NormalDecode::Literal, _) => rgb * 2.0 - 1.0,
        (NormalDecode::Exact, NormalEncoding::Biased) => rgb * 2.0 - weights,
        (NormalDecode::Exact, NormalEncoding::Signed) => rgb,
    };
    let square = normal.length_squared();
    if square < 1.0e-12 { Vec3::Z } else { normal / square.sqrt() }
}

/// Rotates a sprite's normal with the sprite. `rotation` is (cos, sin), counter-clockwise.
pub fn rotate_normal(normal: Vec3, rotation: Vec2) -> Vec3 {
    Vec3::new(normal.x * rotation.x - normal.y * rotation.y, normal.x * rotation.y + normal.y * rotation.x, normal.z)
}
