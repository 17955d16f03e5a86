// Marches through the density grid. The importing file has sample_density(place: vec3f) -> f32: the optical depth across a cell,
// between the centres of eight cells, 0 outside the grid.

#import "lib/density_grid.wgsl"
#import "lib/shadow.wgsl"
#import "lib/ambient.wgsl"

struct ShadowMarch {
    // Position, and 0 in w; or the direction to the light, and 1 in w.
    lights: array<vec4f, SHADOWED_LIGHTS>,
    // Radii of the lights of each block, in cells.
    radii: array<vec4f, LIGHT_BLOCKS>,
    // Directions to the sky, and 1 in w. Those to the ground are opposite.
    sky: array<vec4f, 4>,
    // Number of cells along each axis.
    size: vec3f,
    // Cells of a block of the volume along each axis.
    resolution: u32,
    // Block of the openness.
    openness_block: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

@group(0) @binding(0) var<uniform> march: ShadowMarch;

fn optical_depth_towards(light: vec4f, radius: f32, origin: vec3f, steps: u32) -> f32 {
    let ray = shadow_ray(light, origin, march.size);
    let step = ray.w / f32(steps);
    // The steps fill the cone between the point and the light's disc.
    let slope = radius / max(distance(light.xyz, origin), 1.0e-4);
    var depth = 0.0;
    for (var i = 0u; i < steps; i++) {
        let along = (f32(i) + 0.5) * step;
        let aside = light_disc_offset(i, ray.xyz) * (along * slope);
        depth += sample_density(origin + ray.xyz * along + aside);
    }
    return min(depth * step, MAX_OPTICAL_DEPTH);
}

// Optical depth from a cell to a light of a block.
fn optical_depth_of_light(cell: vec3u, block: u32, light: u32) -> f32 {
    let towards = march.lights[block * LIGHTS_PER_BLOCK + light];
    return optical_depth_towards(towards, march.radii[block][light], vec3f(cell) + 0.5, SHADOW_STEPS);
}

// Mean of 2^(-optical depth) over the directions to the sky, or, with a `side` of -1, to the ground.
fn openness_towards(side: f32, origin: vec3f) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < SKY_DIRECTIONS; i++) {
        sum += exp2(-optical_depth_towards(vec4f(march.sky[i].xyz * side, 1.0), 0.0, origin, SKY_STEPS));
    }
    return sum / f32(SKY_DIRECTIONS);
}

// Openness of a cell to sky and ground.
fn openness_of_cell(cell: vec3u) -> vec2f {
    let origin = vec3f(cell) + 0.5;
    return vec2f(openness_towards(1.0, origin), openness_towards(-1.0, origin));
}
