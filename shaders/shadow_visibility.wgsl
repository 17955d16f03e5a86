// shadow_visibility
// Looks up a host's shadow maps at the cells of the density grid: the share of each cell that a light reaches past the scene.
//
// Reads   shadow maps of the lights of a block.
// Writes  visibility of the lights, in a block of the volume.
// Space   Cells of the grid; clip space of the lights.

#import "lib/shadow_map_lookup.wgsl"

@group(0) @binding(4) var volume: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(4, 4, 4)
fn look_up_cells(@builtin(global_invocation_id) cell: vec3u) {
    if any(cell >= vec3u(visibility.size)) {
        return;
    }
    textureStore(volume, vec3u(cell.xy, cell.z + visibility.first_cell), vec4f(cell_visibility(cell), 0.0));
}
