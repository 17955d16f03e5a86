// shadow_march
// Marches from every cell of the density grid to the lights with shadow, and to sky and ground. First copies the grid to a
// texture, between whose texels the hardware blends: eight loads and as many products per step took five times as
// long on an H200.
//
// Reads   optical depths across the cells, in fixed-point steps.
// Writes  texture of the density; optical depths towards the lights; openness to sky and ground, in a block of its own.
// Space   Cells of the grid.

#import "lib/shadow_march.wgsl"

// The lower word first.
@group(0) @binding(1) var<storage, read> density: array<vec2u>;
// Optical depths towards the lights; in `copy_density`, texture of the density.
@group(0) @binding(2) var written: texture_storage_3d<rgba16float, write>;
// Texture of the density, with one empty cell around the grid.
@group(0) @binding(3) var density_texture: texture_3d<f32>;
@group(0) @binding(4) var linear_sampler: sampler;

@compute @workgroup_size(4, 4, 4)
fn copy_density(@builtin(global_invocation_id) id: vec3u) {
    let size = vec3i(march.size);
    if any(vec3i(id) >= size + 2) {
        return;
    }
    let cell = vec3i(id) - 1;
    var depth = 0.0;
    if all(cell >= vec3i(0)) && all(cell < size) {
        let steps = density[(cell.z * size.y + cell.y) * size.x + cell.x];
        depth = min(optical_depth_of_steps(steps.x, steps.y), MAX_OPTICAL_DEPTH);
    }
    textureStore(written, id, vec4f(depth, 0.0, 0.0, 0.0));
}

fn sample_density(position: vec3f) -> f32 {
    let inside = clamp(position + 1.0, vec3f(0.5), march.size + 1.5);
    return textureSampleLevel(density_texture, linear_sampler, inside / vec3f(textureDimensions(density_texture)), 0.0).r;
}

// Cells of a workgroup along each axis.
const SIDE: u32 = 4u;

// By invocation of a cell, then by cell of the workgroup: optical depth to a light, or sum of the openness to sky and ground.
var<workgroup> found: array<array<vec2f, 64>, LIGHTS_PER_BLOCK>;

// Three invocations per cell, because the grid is small, and a march long: for the lights of a block one each, for sky and
// ground two or three of the shorter rays. The blocks follow each other along z: the lights, then, on GPUs, sky and ground.
@compute @workgroup_size(4, 4, 12)
fn march_cells(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let position = vec3u(local.xy, local.z % SIDE);
    let ray = local.z / SIDE;
    let workgroups = (u32(march.size.z) + SIDE - 1u) / SIDE;
    let block = workgroup.z / workgroups;
    let is_light = block < march.light_blocks;
    let cell = vec3u(workgroup.xy, workgroup.z % workgroups) * SIDE + position;
    let index = (position.z * SIDE + position.y) * SIDE + position.x;
    if is_light {
        found[ray][index].x = optical_depth_of_light(cell, block, ray);
    } else {
        found[ray][index] = openness_along(cell, ray, LIGHTS_PER_BLOCK);
    }
    workgroupBarrier();
    if ray != 0u || any(cell >= vec3u(march.size)) {
        return;
    }
    var texel = vec4f(found[0][index].x, found[1][index].x, found[2][index].x, 0.0);
    if !is_light {
        let sum = found[0][index] + found[1][index] + found[2][index];
        texel = vec4f(sum / f32(SKY_DIRECTIONS), 0.0, 0.0);
    }
    let written_block = select(march.openness_block, block, is_light);
    textureStore(written, vec3u(cell.xy, cell.z + written_block * march.resolution), texel);
}

// For CPUs, which march a quarter faster where no barrier follows.
@compute @workgroup_size(4, 4, 4)
fn march_sky(@builtin(global_invocation_id) cell: vec3u) {
    if all(cell < vec3u(march.size)) {
        let openness = openness_along(cell, 0u, 1u) / f32(SKY_DIRECTIONS);
        textureStore(written, vec3u(cell.xy, cell.z + march.openness_block * march.resolution), vec4f(openness, 0.0, 0.0));
    }
}
