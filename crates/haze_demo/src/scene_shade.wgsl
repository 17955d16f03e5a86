// demo scene: shade
// What    Adds the light that comes through the smoke to the rest, of scene.wgsl. The shadow of the smoke is composed after
//         this file.
// Reads   light of all other lights, that of up to three lights apart; depth at 2x2 samples per pixel.
// Writes  scene color (linear HDR).

@group(1) @binding(1) var rest: texture_2d<f32>;
@group(1) @binding(2) var first: texture_2d<f32>;
@group(1) @binding(3) var second: texture_2d<f32>;
@group(1) @binding(4) var third: texture_2d<f32>;
// Adds the light that comes through the smoke, at a depth of the depth buffer.
fn shaded(position: vec2f, depth: f32) -> vec4f {
    let at = vec2i(position);
    var color = textureLoad(rest, at, 0);
    let view_depth = scene_view_depth(depth);
    let world = scene.eye + ray_at_unit_depth(position / vec2f(textureDimensions(rest))) * view_depth;
    var through = array<vec3f, 3>(vec3f(1.0), vec3f(1.0), vec3f(1.0));
    if view_depth < SKY_VIEW_DEPTH {
        for (var slot = 0; slot < 3; slot++) {
            through[slot] = haze_transmittance(world, scene.apart[slot]);
        }
    }
    color += vec4f(textureLoad(first, at, 0).rgb * through[0], 0.0);
    color += vec4f(textureLoad(second, at, 0).rgb * through[1], 0.0);
    color += vec4f(textureLoad(third, at, 0).rgb * through[2], 0.0);
    return color;
}

@fragment
fn shade_fragment(in: LayerVertex) -> @location(0) vec4f {
    let groups = sample_groups(vec2i(in.position.xy));
    let is_front = in.layer == FRONT;
    if is_front && !any(groups.is_front) {
        discard;
    }
    return shaded(in.position.xy, select(groups.back, groups.front, is_front));
}
