// Tonemap of the demo program: linear HDR to sRGB code. A host's image is never tonemapped.

#import "lib/color.wgsl"
#import "lib/hash.wgsl"

// ACES tonemap curve. (Hill, "BakingLab", 2016: a fit of the reference and output transforms)
fn aces_fitted(color: vec3f) -> vec3f {
    let input = mat3x3f(0.59719, 0.076, 0.0284, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    let output = mat3x3f(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    let v = input * max(color, vec3f(0.0));
    let fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);
    return saturate(output * fitted);
}

// ACES between the darkest and the brightest channel, and the hue of the light between them. (Adobe, "Digital Negative
// specification", 2012: a tone curve that keeps hues)
fn aces_keeping_hue(color: vec3f) -> vec3f {
    let light = max(color, vec3f(0.0));
    let fitted = aces_fitted(light);
    let least = min(light.r, min(light.g, light.b));
    let range = max(light.r, max(light.g, light.b)) - least;
    let dark = min(fitted.r, min(fitted.g, fitted.b));
    let bright = max(fitted.r, max(fitted.g, fitted.b));
    return dark + (light - least) * ((bright - dark) / max(range, 1.0e-6));
}

// AgX: light pales slowly on its way to white. (Sobotta, "AgX", 2022; fit of the curve by Wrensch, "Minimal AgX
// implementation", 2023)
fn agx(color: vec3f) -> vec3f {
    let inset = mat3x3f(0.842479, 0.0423282, 0.0423757, 0.0784336, 0.878469, 0.0784336, 0.0792237, 0.0791661, 0.879143);
    let outset = mat3x3f(1.19688, -0.0528969, -0.0529716, -0.0980209, 1.1519, -0.0980435, -0.0990297, -0.0989612, 1.15107);
    // The curve covers 16.5 stops around middle gray.
    let stops = log2(max(inset * max(color, vec3f(0.0)), vec3f(1.0e-10)));
    let x = saturate((stops + 12.47393) / 16.5);
    let x2 = x * x;
    let x4 = x2 * x2;
    let code = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    return pow(saturate(outset * code), vec3f(2.2));
}

// PBR Neutral: keeps colors up to four fifths of white as they are, and mixes brighter ones with white. (Khronos Group,
// "PBR Neutral tone mapper", 2024)
fn pbr_neutral(color: vec3f) -> vec3f {
    let positive = max(color, vec3f(0.0));
    let least = min(positive.r, min(positive.g, positive.b));
    // Takes off the reflection of a clear surface, which a renderer adds to a painted color.
    let offset = select(0.04, least - 6.25 * least * least, least < 0.08);
    let painted = positive - offset;
    let peak = max(painted.r, max(painted.g, painted.b));
    let start = 0.76;
    if peak < start {
        return painted;
    }
    let room = 1.0 - start;
    let shown_peak = 1.0 - room * room / (peak + room - start);
    let whiteness = 1.0 - 1.0 / (0.15 * (peak - shown_peak) + 1.0);
    return mix(painted * (shown_peak / peak), vec3f(shown_peak), whiteness);
}

const TONEMAP_ACES: u32 = 0u;
const TONEMAP_KEEP_HUE: u32 = 1u;
const TONEMAP_AGX: u32 = 2u;
const TONEMAP_NEUTRAL: u32 = 3u;

// sRGB code of tonemapped light. `exposure` multiplies the light first.
fn tonemapped(color: vec3f, curve: u32, exposure: f32) -> vec3f {
    let exposed = color * exposure;
    var shown: vec3f;
    switch curve {
        case TONEMAP_KEEP_HUE: { shown = aces_keeping_hue(exposed); }
        case TONEMAP_AGX: { shown = agx(exposed); }
        case TONEMAP_NEUTRAL: { shown = pbr_neutral(exposed); }
        default: { shown = aces_fitted(exposed); }
    }
    return srgb_color(shown);
}

// Dither to add before rounding to 8 bits, so that slow gradients do not band: triangular noise, within half a step
// either way.
fn dither(at: vec2u) -> f32 {
    let hash = pcg3d(vec3u(at, 0u));
    return (unit(hash.x) - unit(hash.y)) * (0.5 / 255.0);
}
