// Lookups in the volume of a frame's shadow. Its first blocks have optical depths towards the lights with shadow; further
// ones, behind them along z, have what the system's uniforms tell.

#import "lib/bindings.wgsl"
#import "lib/depth_moments.wgsl"
#import "lib/shadow.wgsl"
#import "lib/view.wgsl"

// A block of the volume at a place in cells.
fn sample_volume(block: f32, place: vec3f) -> vec3f {
    let size = vec3f(textureDimensions(shadow_volume));
    let inside = clamp(place, vec3f(0.5), system.grid_size - 0.5) + vec3f(0.0, 0.0, block * size.x);
    return textureSampleLevel(shadow_volume, linear_sampler, inside / size, 0.0).rgb;
}

// Mean of a block over the smoke on a ray. `moments`: those of the smoke's depth.
fn mean_along_ray(block: f32, ray: vec2f, moments: vec2f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < DEPTH_SAMPLES; i++) {
        let depth = depth_of_sample(i, moments, system.smoke_near, system.smoke_far);
        let position = view_position(ray, depth, view.orthographic);
        sum += sample_volume(block, (system.grid_from_view * vec4f(position, 1.0)).xyz);
    }
    return sum / f32(DEPTH_SAMPLES);
}

// Optical depths of the smoke on a ray, through other smoke. `accumulated`: those that its sprites found towards the lights of
// the first block.
fn optical_depths_on_ray(accumulated: vec3f, ray: vec2f, moments: vec2f) -> array<vec3f, LIGHT_BLOCKS> {
    var depths: array<vec3f, LIGHT_BLOCKS>;
    depths[0] = accumulated;
    if SHADOW_BLOCKS > 1u {
        let first = mean_along_ray(0.0, ray, moments);
        for (var block = 1u; block < SHADOW_BLOCKS; block++) {
            depths[block] = further_optical_depths(mean_along_ray(f32(block), ray, moments), first, accumulated);
        }
    }
    return depths;
}

// Share of each light with shadow that reaches the smoke on a ray past the scene.
fn scene_visibility(ray: vec2f, moments: vec2f) -> array<vec3f, LIGHT_BLOCKS> {
    var visible = fully_visible();
    if system.visibility_block > 0.5 {
        for (var block = 0u; block < SHADOW_BLOCKS; block++) {
            visible[block] = mean_along_ray(system.visibility_block + f32(block), ray, moments);
        }
    }
    return visible;
}

// Openness of the smoke on a ray to the sky and to the ground.
fn openness(ray: vec2f, moments: vec2f) -> vec2f {
    if system.openness_block < 0.5 {
        return vec2f(1.0);
    }
    return mean_along_ray(system.openness_block, ray, moments).xy;
}
