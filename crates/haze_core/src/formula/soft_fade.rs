//! Fade of a sprite near the scene and near the camera. WGSL: `shaders/lib/soft_fade.wgsl`.

use super::saturate;
use crate::settings::FadeCurve;

/// Linear curve: x itself, for x in 0..1. (BLOG, NV)
pub fn fade_linear(x: f32) -> f32 {
    x
}

/// Smoothstep curve: 3x² − 2x³.
pub fn fade_smoothstep(x: f32) -> f32 {
    x * x * (3.0 - 2.0 * x)
}

/// Contrast curve: ½·(2x)^p up to x = ½, then its point reflection. (NV `Contrast()`)
pub fn fade_contrast(x: f32, contrast_power: f32) -> f32 {
    if x <= 0.5 { 0.5 * (2.0 * x).powf(contrast_power) } else { 1.0 - 0.5 * (2.0 * (1.0 - x)).powf(contrast_power) }
}

/// Exponential curve: 1 − 2^(−2·(2x)^c). It is 0.9375, not 1, at x = 1 for c = 1. (NV, second curve)
pub fn fade_exponential(x: f32, contrast_power: f32) -> f32 {
    1.0 - (-2.0 * (2.0 * x).powf(contrast_power)).exp2()
}

/// Curve `always`: 1 in front of the surface, 0 from 1 / fade_scale metres behind it. (BLOG, comment)
pub fn fade_always(distance: f32, fade_scale: f32) -> f32 {
    1.0 - saturate(-distance * fade_scale)
}

/// Fade of a sprite fragment at a signed distance in front of the scene, metres. It is 0 behind the scene and within
/// epsilon of it, except under the curve `always`.
pub fn soft_fade(curve: FadeCurve, distance: f32, fade_scale: f32, contrast_power: f32, epsilon: f32) -> f32 {
    if curve != FadeCurve::Always && distance < epsilon.max(0.0) {
        return 0.0;
    }
    let x = saturate(distance * fade_scale);
    match curve {
        FadeCurve::Smoothstep => fade_smoothstep(x),
        FadeCurve::Linear => fade_linear(x),
        FadeCurve::Contrast => fade_contrast(x, contrast_power),
        FadeCurve::Exponential => fade_exponential(x, contrast_power),
        FadeCurve::Always => fade_always(distance, fade_scale),
    }
}

/// Fade by view depth: 0 at `start`, 1 from `end` on.
pub fn near_fade(view_depth: f32, start: f32, end: f32) -> f32 {
    fade_smoothstep(saturate((view_depth - start) / (end - start).max(1.0e-4)))
}
