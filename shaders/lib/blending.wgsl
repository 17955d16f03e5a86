// Output of lit smoke to the blend unit.

const BLEND_MODE_ALPHA: u32 = 0u;
const BLEND_MODE_ADDITIVE: u32 = 1u;
const BLEND_MODE_MULTIPLY: u32 = 2u;

// Output of a forward fragment: premultiplied for alpha and additive, a filter color for multiply. `light` is as the
// target stores it.
fn forward_fragment(mode: u32, light: vec3f, coverage: f32) -> vec4f {
    switch mode {
        case BLEND_MODE_ADDITIVE: { return vec4f(light * coverage, 0.0); }
        case BLEND_MODE_MULTIPLY: { return vec4f(mix(vec3f(1.0), min(light, vec3f(1.0)), coverage), 1.0); }
        default: { return vec4f(light, 1.0) * coverage; }
    }
}

// Output of a pixel of deferred smoke, premultiplied: its light, and the fraction of the scene that it hides.
fn deferred_fragment(is_additive: bool, light: vec3f, coverage: f32) -> vec4f {
    return vec4f(light * coverage, select(coverage, 0.0, is_additive));
}
