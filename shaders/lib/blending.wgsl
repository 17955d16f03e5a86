// What a lit fragment hands to the blend unit.

const BLEND_MODE_ALPHA: u32 = 0u;
const BLEND_MODE_ADDITIVE: u32 = 1u;
const BLEND_MODE_MULTIPLY: u32 = 2u;

// Premultiplied for alpha and additive, a filter colour for multiply. `light` is as the target holds it.
fn forward_fragment(mode: u32, light: vec3f, coverage: f32) -> vec4f {
    switch mode {
        case BLEND_MODE_ADDITIVE: { return vec4f(light * coverage, 0.0); }
        case BLEND_MODE_MULTIPLY: { return vec4f(mix(vec3f(1.0), min(light, vec3f(1.0)), coverage), 1.0); }
        default: { return vec4f(light, 1.0) * coverage; }
    }
}
