// Scene depth as linear view depth, metres.

// View depth of pixels without a surface. SKY_VIEW_DEPTH in crates/haze_core/src/formula/depth.rs.
const SKY_VIEW_DEPTH: f32 = 1.0e6;

// view_depth = (c.x + c.y·d) / (c.z + c.w·d), one form for every convention. The coefficients and their derivation are
// in depth_coefficients() in crates/haze_core/src/formula/depth.rs.
fn view_depth_from_ndc_depth(ndc_depth: f32, coefficients: vec4f) -> f32 {
    let numerator = coefficients.x + coefficients.y * ndc_depth;
    let denominator = coefficients.z + coefficients.w * ndc_depth;
    // A zero denominator is an infinite far plane: the sky. `!(a > b)` is true for NaN too.
    if !(denominator * SKY_VIEW_DEPTH > numerator) {
        return SKY_VIEW_DEPTH;
    }
    return numerator / denominator;
}

// View depth of a linear target's texel. Values from SKY_VIEW_DEPTH up are sky, and so is NaN.
fn view_depth_from_linear(texel: f32) -> f32 {
    return select(SKY_VIEW_DEPTH, texel, texel < SKY_VIEW_DEPTH);
}

// The farther of two values of a depth buffer. `reversed`: it stores the near plane as 1.
fn farther_ndc_depth(reversed: bool, a: f32, b: f32) -> f32 {
    return select(max(a, b), min(a, b), reversed);
}

const DEPTH_DOWNSAMPLE_CHECKERBOARD: u32 = 0u;
const DEPTH_DOWNSAMPLE_MAX: u32 = 1u;
const DEPTH_DOWNSAMPLE_MIN: u32 = 2u;
const DEPTH_DOWNSAMPLE_POINT: u32 = 3u;

// True if the reduced texel keeps the farthest depth under it, false if it keeps the nearest. Checkerboard alternates,
// so that every 2x2 footprint of an upsampler has both sides of an edge.
fn depth_downsample_keeps_farthest(mode: u32, texel: vec2i) -> bool {
    if mode == DEPTH_DOWNSAMPLE_CHECKERBOARD {
        return ((texel.x + texel.y) & 1) == 0;
    }
    return mode == DEPTH_DOWNSAMPLE_MAX;
}
