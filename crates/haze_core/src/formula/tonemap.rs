//! Tonemap of the demo program: linear HDR to sRGB code. The library never tonemaps a host's image. WGSL:
//! `shaders/lib/tonemap.wgsl`.

use glam::{Mat3, UVec2, Vec3, vec3};

use super::color::srgb_from_linear;
use super::hash::{pcg3d, unit};

/// ACES tonemap curve, linear HDR to linear 0..1. (Hill, "BakingLab", 2016: a fit of the reference and output
/// transforms)
pub fn aces_fitted(color: Vec3) -> Vec3 {
    const INPUT: Mat3 = Mat3::from_cols(
        vec3(0.597_19, 0.076, 0.028_4),
        vec3(0.354_58, 0.908_34, 0.133_83),
        vec3(0.048_23, 0.015_66, 0.837_77),
    );
    const OUTPUT: Mat3 = Mat3::from_cols(
        vec3(1.604_75, -0.102_08, -0.003_27),
        vec3(-0.531_08, 1.108_13, -0.072_76),
        vec3(-0.073_67, -0.006_05, 1.076_02),
    );
    let v = INPUT * color.max(Vec3::ZERO);
    let fitted = (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (OUTPUT * fitted).clamp(Vec3::ZERO, Vec3::ONE)
}

/// sRGB code of tonemapped light. `exposure` multiplies the light first.
pub fn tonemapped(color: Vec3, exposure: f32) -> Vec3 {
    aces_fitted(color * exposure).map(srgb_from_linear)
}

/// Dither to add before rounding to 8 bits, so that slow gradients do not band: triangular noise, within half a step
/// either way.
pub fn dither(at: UVec2) -> f32 {
    let hash = pcg3d(at.extend(0));
    (unit(hash.x) - unit(hash.y)) * (0.5 / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tonemap_curve_keeps_black_and_white_and_is_monotonic() {
        assert!(aces_fitted(Vec3::ZERO).max_element() < 1e-3);
        assert!(aces_fitted(Vec3::splat(100.0)).min_element() > 0.99);
        let grays: Vec<_> = (0..200).map(|step| aces_fitted(Vec3::splat(0.02 * step as f32)).x).collect();
        assert!(grays.is_sorted());
    }
}
