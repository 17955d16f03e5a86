// Reading the accumulation target at full resolution: shared by transfer and specular_scatter.

#import "lib/bindings.wgsl"
#import "lib/depth.wgsl"
#import "lib/upsample.wgsl"

@group(3) @binding(0) var accumulation: texture_2d<f32>;
// Linear view depth over system.depth_limit.
@group(3) @binding(1) var reduced_depth: texture_2d<f32>;

override UPSAMPLE: u32 = UPSAMPLE_JOINT_BILATERAL;

fn scene_view_depth(pixel: vec2f) -> f32 {
    return view_depth_from_ndc_depth(load_scene_depth(vec2i(pixel)), view.depth_coefficients);
}

// The accumulation target at a pixel of the view; zero outside the part of the view that it covers.
fn sample_accumulation(pixel: vec2f) -> vec4f {
    let texel = pixel / system.scale - system.target_origin;
    if any(texel < vec2f(0.0)) || any(texel >= system.target_size) {
        return vec4f(0.0);
    }
    if system.scale == 1.0 {
        return textureLoad(accumulation, vec2i(texel), 0);
    }
    let corner = texel - 0.5;
    let base = floor(corner);
    let last = vec2i(system.target_size) - 1;
    let low = max(vec2i(base), vec2i(0));
    let high = min(vec2i(base) + 1, last);
    let a = low;
    let b = vec2i(high.x, low.y);
    let c = vec2i(low.x, high.y);
    let d = high;
    var depths = vec4f(0.0);
    var depth = 0.0;
    if UPSAMPLE != UPSAMPLE_BILINEAR {
        depths.x = textureLoad(reduced_depth, a, 0).r;
        depths.y = textureLoad(reduced_depth, b, 0).r;
        depths.z = textureLoad(reduced_depth, c, 0).r;
        depths.w = textureLoad(reduced_depth, d, 0).r;
        depths *= system.depth_limit;
        depth = min(scene_view_depth(pixel), system.depth_limit);
    }
    let weights = upsample_weights(UPSAMPLE, corner - base, depths, depth);
    return textureLoad(accumulation, a, 0) * weights.x
        + textureLoad(accumulation, b, 0) * weights.y
        + textureLoad(accumulation, c, 0) * weights.z
        + textureLoad(accumulation, d, 0) * weights.w;
}
