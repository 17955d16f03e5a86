// Light from the hemispheres above and below.

const SKY_DIRECTIONS: u32 = 4u;
const SKY_STEPS: u32 = 16u;

// Lookup coordinate of the diffuse ramp under even light from a hemisphere around `axis`. A ramp that is Lambert's cosine
// then gives (1 + cos) / 2, which is exact.
fn hemisphere_coordinate(normal: vec3f, axis: vec3f) -> f32 {
    return saturate(0.75 + 0.25 * dot(normal, axis));
}

// Response of six-way maps to even light from a hemisphere around `axis`: the light of the side at its pole, and half of that
// of each side at its rim.
fn six_way_hemisphere(positive: vec3f, negative: vec3f, axis: vec3f) -> f32 {
    return 0.5 * (dot(positive + negative, vec3f(1.0)) + dot(axis, positive - negative));
}

// Lookup position in the shadow ramp for light from a hemisphere: as from the side. `openness`: mean of
// 2^(-optical depth).
fn openness_position(openness: f32) -> vec2f {
    return vec2f(saturate(1.0 - openness), 0.5);
}
