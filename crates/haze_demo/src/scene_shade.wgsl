// demo scene: shade
// What    Adds the light that comes through the smoke to the rest, of scene.wgsl. The shadow of the smoke is composed after
//         this file.
// Reads   light of all other lights, that of up to three lights apart, depth.
// Writes  scene color (linear HDR).

@group(1) @binding(1) var rest: texture_2d<f32>;
@group(1) @binding(2) var first: texture_2d<f32>;
@group(1) @binding(3) var second: texture_2d<f32>;
@group(1) @binding(4) var third: texture_2d<f32>;
@group(1) @binding(5) var depth: texture_2d<f32>;

// Adds the light that comes through the smoke.
@fragment
fn shade_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    var color = textureLoad(rest, at, 0).rgb;
    let view_depth = view_depth_from_ndc_depth(textureLoad(depth, at, 0).r, scene.depth_coefficients);
    let world = scene.eye + ray_at_unit_depth(position.xy / vec2f(textureDimensions(rest))) * view_depth;
    var through = array<vec3f, 3>(vec3f(1.0), vec3f(1.0), vec3f(1.0));
    if view_depth < SKY_VIEW_DEPTH {
        for (var slot = 0; slot < 3; slot++) {
            through[slot] = haze_transmittance(world, scene.apart[slot]);
        }
    }
    color += textureLoad(first, at, 0).rgb * through[0];
    color += textureLoad(second, at, 0).rgb * through[1];
    color += textureLoad(third, at, 0).rgb * through[2];
    return vec4f(color, 1.0);
}
