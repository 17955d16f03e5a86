//! Scene depth as linear view depth, metres. `shaders/lib/depth.wgsl`.

use glam::{IVec2, Vec4};

use crate::settings::DepthDownsample;
use crate::view::{DepthConvention, SKY_VIEW_DEPTH};

/// Coefficients of [`view_depth_from_ndc_depth`] for a depth buffer 0..1.
///
/// The projection stores, at view depth z, with near n and far f:
/// - standard: d = f·(z − n) / (z·(f − n)), so z = n·f / (f − d·(f − n)); NV prints (f + n), which is wrong
/// - reversed: d' = 1 − d, so z = n·f / (n + d'·(f − n))
/// - infinite: the limit f → ∞, so z = n / (1 − d), or n / d' when reversed
/// - orthographic: z = n + d·(f − n), or f − d'·(f − n) when reversed
pub fn depth_coefficients(convention: &DepthConvention) -> Vec4 {
    let (n, f) = (f64::from(convention.near), f64::from(convention.far));
    let [a, b, c, d] = match (convention.orthographic, convention.reversed) {
        (false, false) if f.is_infinite() => [n, 0.0, 1.0, -1.0],
        (false, true) if f.is_infinite() => [n, 0.0, 0.0, 1.0],
        // Divided through by f: keeps all four near 1.
        (false, false) => [n, 0.0, 1.0, -(f - n) / f],
        (false, true) => [n, 0.0, n / f, (f - n) / f],
        (true, false) => [n, f - n, 1.0, 0.0],
        (true, true) => [f, -(f - n), 1.0, 0.0],
    };
    Vec4::new(a as f32, b as f32, c as f32, d as f32)
}

/// View depth = (c.x + c.y·d) / (c.z + c.w·d); where the denominator vanishes there is sky.
pub fn view_depth_from_ndc_depth(ndc_depth: f32, coefficients: Vec4) -> f32 {
    let numerator = coefficients.x + coefficients.y * ndc_depth;
    let denominator = coefficients.z + coefficients.w * ndc_depth;
    if denominator * SKY_VIEW_DEPTH > numerator { numerator / denominator } else { SKY_VIEW_DEPTH }
}

/// True if the reduced texel keeps the farthest depth under it, false for the nearest.
pub fn depth_downsample_keeps_farthest(mode: DepthDownsample, texel: IVec2) -> bool {
    match mode {
        DepthDownsample::Checkerboard => (texel.x + texel.y) & 1 == 0,
        _ => mode == DepthDownsample::Max,
    }
}
