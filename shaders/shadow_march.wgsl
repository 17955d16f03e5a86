// shadow_march
// Marches from every cell of the density grid to the lights with shadow, and to sky and ground.
//
// Reads   optical depths across the cells, in fixed-point steps.
// Writes  optical depths towards the lights; openness to sky and ground, in a block of its own.
// Space   Cells of the grid.

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
// The lower word first.
@group(0) @binding(1) var<storage, read> density: array<vec2u>;
@group(0) @binding(2) var optical_depths: texture_storage_3d<rgba16float, write>;

// Optical depth across a cell; 0 outside the grid.
fn load_density(cell: vec3i) -> f32 {
    let size = vec3i(march.size);
    if any(cell < vec3i(0)) || any(cell >= size) {
        return 0.0;
    }
    let steps = density[(cell.z * size.y + cell.y) * size.x + cell.x];
    return optical_depth_of_steps(steps.x, steps.y);
}

// Between the centres of eight cells.
fn sample_density(place: vec3f) -> f32 {
    let low = floor(place - 0.5);
    let high_weight = place - 0.5 - low;
    let low_weight = 1.0 - high_weight;
    var sum = 0.0;
    for (var corner = 0; corner < 8; corner++) {
        let offset = vec3i(corner & 1, (corner >> 1u) & 1, corner >> 2u);
        let weight = select(low_weight, high_weight, offset == vec3i(1));
        sum += load_density(vec3i(low) + offset) * weight.x * weight.y * weight.z;
    }
    return sum;
}

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

// Cells of a workgroup along each axis.
const SIDE: u32 = 4u;

// One per light and cell of the workgroup.
var<workgroup> depths: array<array<f32, 64>, LIGHTS_PER_BLOCK>;

// An invocation per light of a block and cell: the grid is small, and a march long. The blocks follow each other along z.
@compute @workgroup_size(4, 4, 12)
fn march_cells(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let place = vec3u(local.xy, local.z % SIDE);
    let light = local.z / SIDE;
    let workgroups = (u32(march.size.z) + SIDE - 1u) / SIDE;
    let block = workgroup.z / workgroups;
    let cell = vec3u(workgroup.xy, workgroup.z % workgroups) * SIDE + place;
    let index = (place.z * SIDE + place.y) * SIDE + place.x;
    let towards = march.lights[block * LIGHTS_PER_BLOCK + light];
    depths[light][index] = optical_depth_towards(towards, march.radii[block][light], vec3f(cell) + 0.5, SHADOW_STEPS);
    workgroupBarrier();
    if light == 0u && all(cell < vec3u(march.size)) {
        let found = vec4f(depths[0][index], depths[1][index], depths[2][index], 0.0);
        textureStore(optical_depths, vec3u(cell.xy, cell.z + block * march.resolution), found);
    }
}

// Mean of 2^(-optical depth) over the directions to the sky, or, with a `side` of -1, to the ground.
fn openness_towards(side: f32, origin: vec3f) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < SKY_DIRECTIONS; i++) {
        sum += exp2(-optical_depth_towards(vec4f(march.sky[i].xyz * side, 1.0), 0.0, origin, SKY_STEPS));
    }
    return sum / f32(SKY_DIRECTIONS);
}

@compute @workgroup_size(4, 4, 4)
fn march_sky(@builtin(global_invocation_id) cell: vec3u) {
    if all(cell < vec3u(march.size)) {
        let origin = vec3f(cell) + 0.5;
        let openness = vec2f(openness_towards(1.0, origin), openness_towards(-1.0, origin));
        let first_cell = march.openness_block * march.resolution;
        textureStore(optical_depths, vec3u(cell.xy, cell.z + first_cell), vec4f(openness, 0.0, 0.0));
    }
}
