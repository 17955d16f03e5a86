// shadow_visibility
// Looks up a host's shadow maps at the cells of the density grid: the fraction of each cell that a light reaches past the
// scene.
//
// Reads   shadow maps of the lights of a block.
// Writes  visibility of the lights, in a block of the volume.
// Space   Cells of the grid; clip space of the lights.

#import "lib/shadow_map_lookup.wgsl"

@group(0) @binding(4) var volume: texture_storage_3d<rgba16float, write>;

// Of eight cells, one after the other.
var<workgroup> octants: array<vec3f, 64>;

// An invocation per octant of a cell: the grid is small, and its cells alone would leave most of a GPU idle.
@compute @workgroup_size(4, 4, 4)
fn look_up_cells(@builtin(global_invocation_id) octant: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let side = vec3u(1u, 2u, 4u);
    let first = 8u * dot(local / 2u, side);
    let position = dot(local % 2u, side);
    octants[first + position] = octant_visibility(octant);
    workgroupBarrier();
    let cell = octant / 2u;
    if position != 0u || any(cell >= vec3u(visibility.size)) {
        return;
    }
    var visible = vec3f(0.0);
    for (var i = 0u; i < 8u; i++) {
        visible += octants[first + i];
    }
    textureStore(volume, vec3u(cell.xy, cell.z + visibility.first_cell), vec4f(visible / 8.0, 0.0));
}
