// shadow_visibility_slice: shadow_visibility for devices without compute shaders. A draw computes a slice of the volume.
// Reads   shadow maps of the lights of a block.
// Writes  visibility of the lights.
// Blend   none.
// Space   Cells of the grid; clip space of the lights.

#import "lib/shadow_map_lookup.wgsl"
#import "lib/volume_slice.wgsl"

// Fraction of a cell that each light reaches: the mean of its octants.
fn cell_visibility(cell: vec3u) -> vec3f {
    var visible = vec3f(0.0);
    for (var i = 0u; i < 8u; i++) {
        visible += octant_visibility(2u * cell + vec3u(i & 1u, (i >> 1u) & 1u, i >> 2u));
    }
    return visible / 8.0;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slice: u32) -> SliceVertex {
    return slice_vertex(index, slice);
}

@fragment
fn fragment(in: SliceVertex) -> @location(0) vec4f {
    let cell = vec3u(vec2u(in.position.xy), in.slice - visibility.first_cell);
    return vec4f(cell_visibility(cell), 0.0);
}
