
// Common to all passes over the final image: image_pass.rs.

@group(0) @binding(0) var image: texture_2d<f32>;
// Depth buffer of the scene.
@group(0) @binding(1) var scene_depth: texture_2d<f32>;

fn load_clamped(at: vec2i) -> vec3f {
    return textureLoad(image, clamp(at, vec2i(0), vec2i(textureDimensions(image)) - 1), 0).rgb;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u(index & 1u, index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
