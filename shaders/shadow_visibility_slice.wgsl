// shadow_visibility_slice: shadow_visibility for devices without compute shaders. A draw computes a slice of the volume.
// Reads   shadow maps of the lights of a block.
// Writes  visibility of the lights.
// Blend   none.
// Space   Cells of the grid; clip space of the lights.

#import "lib/shadow_map_lookup.wgsl"
#import "lib/volume_slice.wgsl"

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slice: u32) -> SliceVertex {
    return slice_vertex(index, slice);
}

@fragment
fn fragment(in: SliceVertex) -> @location(0) vec4f {
    let cell = vec3u(vec2u(in.position.xy), in.slice - visibility.first_cell);
    return vec4f(cell_visibility(cell), 0.0);
}
