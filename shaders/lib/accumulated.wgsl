// Sampling of the accumulation target at full resolution.

#import "lib/bindings.wgsl"
#import "lib/depth.wgsl"
#import "lib/upsample.wgsl"

// Or the output of light_target, in passes that read it.
@group(3) @binding(0) var accumulation: texture_2d<f32>;
// Linear view depth over system.depth_limit.
@group(3) @binding(1) var reduced_depth: texture_2d<f32>;

override UPSAMPLE: u32 = UPSAMPLE_GUIDED;

fn scene_view_depth(pixel: vec2f) -> f32 {
    return view_depth_from_ndc_depth(load_scene_depth(vec2i(pixel)), view.depth_coefficients);
}

fn clamped_texel(texel: vec2i) -> vec2i {
    return clamp(texel, vec2i(0), vec2i(system.target_size) - 1);
}

// Depth of a texel that guides the upsampling. Everything behind the smoke counts as one depth.
fn guide(texel: vec2i) -> f32 {
    return min(textureLoad(reduced_depth, texel, 0).r * system.depth_limit, system.smoke_depth_limit);
}

// Samples a texture of the accumulation target at a pixel of the view. It is zero outside the part of the view that the
// target covers.
fn sample_target(target_texture: texture_2d<f32>, pixel: vec2f) -> vec4f {
    let texel = pixel / f32(system.scale) - system.target_origin;
    if any(texel < vec2f(0.0)) || any(texel >= system.target_size) {
        return vec4f(0.0);
    }
    if system.scale == 1u {
        return textureLoad(target_texture, vec2i(texel), 0);
    }
    let corner = texel - 0.5;
    let base = vec2i(floor(corner));
    let fraction = fract(corner);
    let a = clamped_texel(base);
    let b = clamped_texel(base + vec2i(1, 0));
    let c = clamped_texel(base + vec2i(0, 1));
    let d = clamped_texel(base + vec2i(1, 1));
    var depths = vec4f(0.0);
    var depth = 0.0;
    if UPSAMPLE != UPSAMPLE_BILINEAR {
        depths = vec4f(guide(a), guide(b), guide(c), guide(d));
        depth = min(scene_view_depth(pixel), system.smoke_depth_limit);
    }
    let weights = upsample_weights(UPSAMPLE, fraction, depths, depth);
    let value = textureLoad(target_texture, a, 0) * weights.x
        + textureLoad(target_texture, b, 0) * weights.y
        + textureLoad(target_texture, c, 0) * weights.z
        + textureLoad(target_texture, d, 0) * weights.w;
    if UPSAMPLE != UPSAMPLE_GUIDED {
        return value;
    }
    // Smooth pixels skip the loop with a count of 0.
    let fade = 1.0 / system.fade_scale;
    let count = select(16, 0, bilinear_suffices(depths, depth, fade));
    var fit: GuidedFit;
    fit.nearest = SKY_VIEW_DEPTH;
    fit.farthest = -SKY_VIEW_DEPTH;
    for (var i = 0; i < count; i++) {
        let offset = vec2i(i % 4, i / 4) - 1;
        let at = clamped_texel(base + offset);
        let position = vec3f(vec2f(offset) - fraction, guide(at) - depth);
        fit = add_texel(fit, position, guided_weight(position, depth), textureLoad(target_texture, at, 0));
    }
    if count == 0 {
        return value;
    }
    return fitted_value(fit, fade);
}

// Ray through a pixel, as in view_position().
fn ray_of_pixel(pixel: vec2f) -> vec2f {
    return ndc_from_pixel(pixel, view.size) * view.ray_scale + view.ray_offset;
}

// Point of the smoke that is lit at a pixel, view space. It is on the pixel's ray, flattened to one plane; otherwise
// the faces of the box would show.
fn shading_position(pixel: vec2f) -> vec3f {
    return view_position(ray_of_pixel(pixel), -system.center.z, view.orthographic);
}
