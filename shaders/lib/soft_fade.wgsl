// The fade of a sprite where it meets the scene or the camera.

const FADE_CURVE_SMOOTHSTEP: u32 = 0u;
const FADE_CURVE_LINEAR: u32 = 1u;
const FADE_CURVE_CONTRAST: u32 = 2u;
const FADE_CURVE_EXPONENTIAL: u32 = 3u;
const FADE_CURVE_ALWAYS: u32 = 4u;

// x in 0..1. BLOG and NV: x itself.
fn fade_linear(x: f32) -> f32 {
    return x;
}

// 3x² - 2x³.
fn fade_smoothstep(x: f32) -> f32 {
    return x * x * (3.0 - 2.0 * x);
}

// NV Contrast(): a power curve, point-symmetric about (1/2, 1/2). p = 1 is linear.
fn fade_contrast(x: f32, contrast_power: f32) -> f32 {
    if x <= 0.5 {
        return 0.5 * pow(2.0 * x, contrast_power);
    }
    return 1.0 - 0.5 * pow(2.0 * (1.0 - x), contrast_power);
}

// NV F_c(x) = 1 - 2^(-2·(2x)^c). Does not reach 1 at x = 1: 0.9375 for c = 1.
fn fade_exponential(x: f32, contrast_power: f32) -> f32 {
    return 1.0 - exp2(-2.0 * pow(2.0 * x, contrast_power));
}

// Whole in front of the surface, gone 1 / fade_scale behind it. (BLOG, comment: 1 - saturate(softness · (sprite - scene)))
fn fade_always(distance: f32, fade_scale: f32) -> f32 {
    return 1.0 - saturate(-distance * fade_scale);
}

// The fade by a sprite fragment's distance in front of the scene, metres. A fragment behind the surface, or closer
// than epsilon, is gone: the difference is signed, nothing fades back in. (BLOG, NV section "Blending the sprite") Only
// the curve `always` shows what is behind.
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

// The fade by view depth: 0 at start, 1 from end on. Equal distances make a step.
fn near_fade(view_depth: f32, start: f32, end: f32) -> f32 {
    return fade_smoothstep(saturate((view_depth - start) / max(end - start, 1.0e-4)));
}
