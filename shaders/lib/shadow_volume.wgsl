// Lookups in the volume of a frame's shadow. Its first block has optical depths towards the lights with shadow; further ones,
// behind it along z, have what the system's uniforms tell.

#import "lib/bindings.wgsl"
#import "lib/depth_moments.wgsl"
#import "lib/view.wgsl"

// A block of the volume at a place in cells.
fn sample_volume(block: f32, place: vec3f) -> vec3f {
    let size = vec3f(textureDimensions(shadow_volume));
    let inside = clamp(place, vec3f(0.5), system.grid_size - 0.5) + vec3f(0.0, 0.0, block * size.x);
    return textureSampleLevel(shadow_volume, linear_sampler, inside / size, 0.0).rgb;
}

// Mean of a block over the smoke on a ray; 1 for block 0. `moments`: those of the smoke's depth.
fn mean_along_ray(block: f32, ray: vec2f, moments: vec2f) -> vec3f {
    if block < 0.5 {
        return vec3f(1.0);
    }
    var sum = vec3f(0.0);
    for (var i = 0u; i < DEPTH_SAMPLES; i++) {
        let depth = depth_of_sample(i, moments, system.smoke_near, system.smoke_far);
        let position = view_position(ray, depth, view.orthographic);
        sum += sample_volume(block, (system.grid_from_view * vec4f(position, 1.0)).xyz);
    }
    return sum / f32(DEPTH_SAMPLES);
}

// Share of each light with shadow that reaches the smoke on a ray past the scene.
fn scene_visibility(ray: vec2f, moments: vec2f) -> vec3f {
    return mean_along_ray(system.visibility_block, ray, moments);
}

// Openness of the smoke on a ray to the sky and to the ground.
fn openness(ray: vec2f, moments: vec2f) -> vec2f {
    return mean_along_ray(system.openness_block, ray, moments).xy;
}
