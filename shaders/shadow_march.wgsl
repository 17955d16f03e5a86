// shadow_march
// Marches from every cell of the density grid to the lights with shadow, and to sky and ground.
//
// Reads   optical depths across the cells, in fixed-point steps.
// Writes  optical depths towards the lights; openness to sky and ground, in a block of its own.
// Space   Cells of the grid.

#import "lib/shadow_march.wgsl"

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
    depths[light][index] = optical_depth_of_light(cell, block, light);
    workgroupBarrier();
    if light == 0u && all(cell < vec3u(march.size)) {
        let found = vec4f(depths[0][index], depths[1][index], depths[2][index], 0.0);
        textureStore(optical_depths, vec3u(cell.xy, cell.z + block * march.resolution), found);
    }
}

@compute @workgroup_size(4, 4, 4)
fn march_sky(@builtin(global_invocation_id) cell: vec3u) {
    if all(cell < vec3u(march.size)) {
        let at = vec3u(cell.xy, cell.z + march.openness_block * march.resolution);
        textureStore(optical_depths, at, vec4f(openness_of_cell(cell), 0.0, 0.0));
    }
}
