// Reading the accumulation target at full resolution: shared by transfer and specular_scatter.

#import "lib/bindings.wgsl"
#import "lib/depth.wgsl"
#import "lib/upsample.wgsl"

@group(3) @binding(0) var accumulation: texture_2d<f32>;
// Linear view depth over system.depth_limit.
@group(3) @binding(1) var reduced_depth: texture_2d<f32>;

override UPSAMPLE: u32 = UPSAMPLE_GUIDED;

// The texels that a pixel is made of.
struct Footprint {
    // Along each side: 0 outside the part of the view that the target covers.
    side: i32,
    first: vec2i,
    // A row in each vector.
    weights: array<vec4f, 4>,
}

fn scene_view_depth(pixel: vec2f) -> f32 {
    return view_depth_from_ndc_depth(load_scene_depth(vec2i(pixel)), view.depth_coefficients);
}

fn clamped_texel(texel: vec2i) -> vec2i {
    return clamp(texel, vec2i(0), vec2i(system.target_size) - 1);
}

fn load_reduced_depth(texel: vec2i) -> f32 {
    return textureLoad(reduced_depth, clamped_texel(texel), 0).r * system.depth_limit;
}

fn footprint(pixel: vec2f) -> Footprint {
    var out: Footprint;
    let texel = pixel / system.scale - system.target_origin;
    if any(texel < vec2f(0.0)) || any(texel >= system.target_size) {
        return out;
    }
    if system.scale == 1.0 {
        out.side = 1;
        out.first = vec2i(texel);
        out.weights[0].x = 1.0;
        return out;
    }
    let corner = texel - 0.5;
    let base = vec2i(floor(corner));
    let fraction = fract(corner);
    var depths = vec4f(0.0);
    var depth = 0.0;
    if UPSAMPLE != UPSAMPLE_BILINEAR {
        depths.x = load_reduced_depth(base);
        depths.y = load_reduced_depth(base + vec2i(1, 0));
        depths.z = load_reduced_depth(base + vec2i(0, 1));
        depths.w = load_reduced_depth(base + 1);
        depth = min(scene_view_depth(pixel), system.depth_limit);
    }
    let fade = 1.0 / system.fade_scale;
    if UPSAMPLE == UPSAMPLE_GUIDED && !is_smooth(depths, depth, fade) {
        out.side = 4;
        out.first = base - 1;
        var around: array<vec4f, 4>;
        for (var i = 0; i < 16; i++) {
            around[i / 4][i % 4] = load_reduced_depth(out.first + vec2i(i % 4, i / 4));
        }
        out.weights = guided_weights(fraction, around, depth, fade);
        return out;
    }
    let weights = upsample_weights(UPSAMPLE, fraction, depths, depth);
    out.side = 2;
    out.first = base;
    out.weights[0] = vec4f(weights.xy, 0.0, 0.0);
    out.weights[1] = vec4f(weights.zw, 0.0, 0.0);
    return out;
}

// A texture of the accumulation target at a pixel; zero outside.
fn sample_target(target_texture: texture_2d<f32>, at: Footprint) -> vec4f {
    var weights = at.weights;
    var sum = vec4f(0.0);
    var low = vec4f(1.0e30);
    var high = vec4f(-1.0e30);
    for (var y = 0; y < at.side; y++) {
        for (var x = 0; x < at.side; x++) {
            let value = textureLoad(target_texture, clamped_texel(at.first + vec2i(x, y)), 0);
            sum += value * weights[y][x];
            low = min(low, value);
            high = max(high, value);
        }
    }
    // Guided weights may overshoot.
    return select(sum, clamp(sum, low, high), at.side == 4);
}

// The point of the smoke that is lit at a pixel, view space: on the pixel's ray, flattened to one plane, or the box would
// show its faces.
fn lit_position(pixel: vec2f) -> vec3f {
    let ray = ndc_from_pixel(pixel, view.size) * view.ray_scale + view.ray_offset;
    return view_position(ray, -system.centre.z, view.orthographic);
}
