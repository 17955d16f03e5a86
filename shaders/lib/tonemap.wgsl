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

// sRGB code of tonemapped light. `exposure` multiplies the light first.
fn tonemapped(color: vec3f, exposure: f32) -> vec3f {
    return srgb_color(aces_fitted(color * exposure));
}

// Dither to add before rounding to 8 bits, so that slow gradients do not band: triangular noise, within half a step
// either way.
fn dither(at: vec2u) -> f32 {
    let hash = pcg3d(vec3u(at, 0u));
    return (unit(hash.x) - unit(hash.y)) * (0.5 / 255.0);
}
