// depth_downsample: brings the scene's depth to the resolution of the accumulation target, one kept depth per texel.
// Reads   scene_depth (full resolution, as the host stores it).
// Writes  reduced depth: linear view depth over system.depth_limit, 0..1, as a depth buffer; by `texels`, as R32Float.
// Blend   none.
// Source  OTEE "Transfer & lighting", option 1.

#import "lib/bindings.wgsl"
#import "lib/depth.wgsl"

override DEPTH_DOWNSAMPLE: u32 = DEPTH_DOWNSAMPLE_CHECKERBOARD;
// True for a copy in Depth16Unorm. It is stored one step too far, so that rounding never hides a sprite that the 32-bit
// depth shows.
override COARSE_COPY: bool = false;

fn stored_depth(view_depth: f32) -> f32 {
    return saturate(view_depth / system.depth_limit + select(0.0, 1.0 / 65535.0, COARSE_COPY));
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    return kept_depth(vec2i(floor(position.xy)) + vec2i(system.target_origin));
}

@group(3) @binding(0) var written: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn texels(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < vec2u(system.target_size)) {
        textureStore(written, id.xy, vec4f(kept_depth(vec2i(id.xy) + vec2i(system.target_origin))));
    }
}

// Stored depth of a texel of the view.
fn kept_depth(texel: vec2i) -> f32 {
    let scale = i32(system.scale);
    let first = texel * scale;
    let last = vec2i(view.size) - 1;

    if DEPTH_DOWNSAMPLE == DEPTH_DOWNSAMPLE_POINT {
        let pixel = min(first + scale / 2, last);
        let depth = view_depth_from_ndc_depth(load_scene_depth(pixel), view.depth_coefficients);
        return stored_depth(depth);
    }
    var nearest = SKY_VIEW_DEPTH;
    var farthest = 0.0;
    let end = min(first + scale - 1, last);
    for (var y = first.y; y <= end.y; y++) {
        for (var x = first.x; x <= end.x; x++) {
            let ndc_depth = load_scene_depth(vec2i(x, y));
            let depth = view_depth_from_ndc_depth(ndc_depth, view.depth_coefficients);
            nearest = min(nearest, depth);
            farthest = max(farthest, depth);
        }
    }
    let kept = select(nearest, farthest, depth_downsample_keeps_farthest(DEPTH_DOWNSAMPLE, texel));
    return stored_depth(kept);
}
