// depth_resolve: keeps the farthest sample of every pixel of a multisampled depth buffer.
// Reads   the host's depth buffer.
// Writes  resolved depth, Depth32Float, as the host stores it.
// Blend   none.
// Source  own. At the edge of an object the smoke behind it covers the whole pixel; the hardware's test of the box
//         against the host's own samples keeps the object's share clear.

#import "lib/depth.wgsl"

override REVERSED: bool = false;

@group(0) @binding(0) var host_depth: texture_depth_multisampled_2d;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let pixel = vec2i(position.xy);
    var farthest = textureLoad(host_depth, pixel, 0);
    for (var sample = 1u; sample < textureNumSamples(host_depth); sample++) {
        farthest = farther_ndc_depth(REVERSED, farthest, textureLoad(host_depth, pixel, sample));
    }
    return farthest;
}
