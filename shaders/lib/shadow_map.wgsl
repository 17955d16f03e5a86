// Lookup of a host's shadow map.

const MAX_SHADOW_LAYERS: u32 = 6u;

// Place of a point in a layer of a shadow map: position from the upper left corner, 0 to 1, and depth; and 1 in w, or 0 if
// the point is outside of the layer. `clip`: the point in the layer's clip space.
fn shadow_map_position(clip: vec4f) -> vec4f {
    let ndc = clip.xyz / max(clip.w, 1.0e-6);
    let is_inside = clip.w > 1.0e-6 && all(abs(ndc) <= vec3f(1.0)) && ndc.z >= 0.0;
    return vec4f(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5, ndc.z, select(0.0, 1.0, is_inside));
}

// 1 if light reaches a point with this depth, 0 if the map has a surface before it. `reversed`: the map stores the near
// plane as 1.
fn shadow_map_visibility(depth: f32, stored: f32, bias: f32, reversed: bool) -> f32 {
    let is_lit = select(depth <= stored + bias, depth >= stored - bias, reversed);
    return select(0.0, 1.0, is_lit);
}
