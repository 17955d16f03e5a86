// Lookups in the volume of a frame's shadow. Its first blocks have optical depths towards the lights with shadow; further
// ones, behind them along z, have what the system's uniforms tell.

#import "lib/bindings.wgsl"
#import "lib/depth_moments.wgsl"
#import "lib/shadow.wgsl"
#import "lib/view.wgsl"

// A block of the volume at a position in cells.
fn sample_volume(block: f32, position: vec3f) -> vec3f {
    let size = vec3f(textureDimensions(shadow_volume));
    let inside = clamp(position, vec3f(0.5), system.grid_size - 0.5) + vec3f(0.0, 0.0, block * size.x);
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

// Fraction of each light of a block that reaches the smoke on a ray past the scene.
fn scene_visibility(block: f32, ray: vec2f, moments: vec2f) -> vec3f {
    if system.visibility_block < 0.5 {
        return vec3f(1.0);
    }
    return mean_along_ray(system.visibility_block + block, ray, moments);
}

// Point of the smoke on a ray at its mean depth, view space.
fn mean_position(ray: vec2f, moments: vec2f) -> vec3f {
    let depth = mix(system.smoke_near, system.smoke_far, saturate(moments.x));
    return view_position(ray, depth, view.orthographic);
}

// The same in cells.
fn mean_cell(ray: vec2f, moments: vec2f) -> vec3f {
    return (system.grid_from_view * vec4f(mean_position(ray, moments), 1.0)).xyz;
}

// Openness of the smoke on a ray to the sky and to the ground.
fn openness(ray: vec2f, moments: vec2f) -> vec2f {
    if system.openness_block < 0.5 {
        return vec2f(1.0);
    }
    return mean_along_ray(system.openness_block, ray, moments).xy;
}
