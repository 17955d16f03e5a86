// Marches through the density grid. The importing file has sample_density(position: vec3f) -> f32: the optical depth across a
// cell, between the centers of eight cells, 0 outside the grid.

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
    // Extent of the smoke along each axis, in cells: where marches end.
    extent: vec3f,
    // Block of the openness.
    openness_block: u32,
    // Number of blocks of lights.
    light_blocks: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

@group(0) @binding(0) var<uniform> march: ShadowMarch;

fn optical_depth_towards(light: vec4f, radius: f32, origin: vec3f, steps: u32) -> f32 {
    let ray = shadow_ray(light, origin, march.extent);
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

// Rays of a cell: to the sky, and opposite to them to the ground.
const SKY_RAYS: u32 = 2u * SKY_DIRECTIONS;

// Sum of 2^(-optical depth) over every `stride`th ray from the first on: to the sky in x, to the ground in y.
fn openness_along(cell: vec3u, first: u32, stride: u32) -> vec2f {
    var sum = vec2f(0.0);
    for (var ray = first; ray < SKY_RAYS; ray += stride) {
        let to_ground = ray >= SKY_DIRECTIONS;
        let direction = march.sky[ray % SKY_DIRECTIONS].xyz * select(1.0, -1.0, to_ground);
        let depth = optical_depth_towards(vec4f(direction, 1.0), 0.0, vec3f(cell) + 0.5, SKY_STEPS);
        sum += select(vec2f(1.0, 0.0), vec2f(0.0, 1.0), to_ground) * exp2(-depth);
    }
    return sum;
}
