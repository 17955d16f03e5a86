// Fade of a sprite near the scene and near the camera.

const FADE_CURVE_SMOOTHSTEP: u32 = 0u;
const FADE_CURVE_LINEAR: u32 = 1u;
const FADE_CURVE_CONTRAST: u32 = 2u;
const FADE_CURVE_EXPONENTIAL: u32 = 3u;
const FADE_CURVE_ALWAYS: u32 = 4u;

// Linear curve: x itself, for x in 0..1. (BLOG, NV)
fn fade_linear(x: f32) -> f32 {
    return x;
}

// Smoothstep curve: 3x² - 2x³.
fn fade_smoothstep(x: f32) -> f32 {
    return x * x * (3.0 - 2.0 * x);
}

// Contrast curve: a power curve, point-symmetric about (1/2, 1/2). p = 1 is linear. (NV Contrast())
fn fade_contrast(x: f32, contrast_power: f32) -> f32 {
    if x <= 0.5 {
        return 0.5 * pow(2.0 * x, contrast_power);
    }
    return 1.0 - 0.5 * pow(2.0 * (1.0 - x), contrast_power);
}

// Exponential curve: 1 - 2^(-2·(2x)^c). It is 0.9375, not 1, at x = 1 for c = 1. (NV F_c(x))
fn fade_exponential(x: f32, contrast_power: f32) -> f32 {
    return 1.0 - exp2(-2.0 * pow(2.0 * x, contrast_power));
}

// Curve `always`: 1 in front of the surface, 0 from 1 / fade_scale metres behind it. (BLOG, comment: 1 -
// saturate(softness · (sprite - scene)))
fn fade_always(distance: f32, fade_scale: f32) -> f32 {
    return 1.0 - saturate(-distance * fade_scale);
}

// Fade of a sprite fragment at a signed distance in front of the scene, metres. It is 0 behind the surface and within
// epsilon of it, so nothing fades back in. (BLOG, NV section "Blending the sprite") Only the curve `always` shows
// sprites behind the surface.
fn soft_fade(curve: u32, distance: f32, fade_scale: f32, contrast_power: f32, epsilon: f32) -> f32 {
    if curve != FADE_CURVE_ALWAYS && distance < max(epsilon, 0.0) {
        return 0.0;
    }
    let x = saturate(distance * fade_scale);
    switch curve {
        case FADE_CURVE_LINEAR: { return fade_linear(x); }
        case FADE_CURVE_CONTRAST: { return fade_contrast(x, contrast_power); }
        case FADE_CURVE_EXPONENTIAL: { return fade_exponential(x, contrast_power); }
        case FADE_CURVE_ALWAYS: { return fade_always(distance, fade_scale); }
        default: { return fade_smoothstep(x); }
    }
}

// Fade by view depth: 0 at `start`, 1 from `end` on. Equal distances make a step.
fn near_fade(view_depth: f32, start: f32, end: f32) -> f32 {
    return fade_smoothstep(saturate((view_depth - start) / max(end - start, 1.0e-4)));
}
