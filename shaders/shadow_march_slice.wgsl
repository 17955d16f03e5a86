// shadow_march_slice: shadow_march for devices without compute shaders. A draw computes a slice of the volume.
// Reads   optical depths across the cells, which the CPU has added up.
// Writes  optical depths towards the lights of a block, or openness to sky and ground.
// Blend   none.
// Space   Cells of the grid.

#import "lib/shadow_march.wgsl"
#import "lib/volume_slice.wgsl"

// True: openness to sky and ground. False: optical depths towards lights.
override TO_SKY: bool = false;

@group(0) @binding(1) var density: texture_3d<f32>;

fn load_density(cell: vec3i) -> f32 {
    if any(cell < vec3i(0)) || any(cell >= vec3i(march.size)) {
        return 0.0;
    }
    return textureLoad(density, cell, 0).r;
}

// Between the centers of eight cells.
fn sample_density(position: vec3f) -> f32 {
    let low = floor(position - 0.5);
    let high_weight = position - 0.5 - low;
    let low_weight = 1.0 - high_weight;
    var sum = 0.0;
    for (var corner = 0; corner < 8; corner++) {
        let offset = vec3i(corner & 1, (corner >> 1u) & 1, corner >> 2u);
        let weight = select(low_weight, high_weight, offset == vec3i(1));
        sum += load_density(vec3i(low) + offset) * weight.x * weight.y * weight.z;
    }
    return sum;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slice: u32) -> SliceVertex {
    return slice_vertex(index, slice);
}

@fragment
fn fragment(in: SliceVertex) -> @location(0) vec4f {
    let cell = vec3u(vec2u(in.position.xy), in.slice % march.resolution);
    if TO_SKY {
        return vec4f(openness_along(cell, 0u, 1u) / f32(SKY_DIRECTIONS), 0.0, 0.0);
    }
    let block = in.slice / march.resolution;
    return vec4f(
        optical_depth_of_light(cell, block, 0u),
        optical_depth_of_light(cell, block, 1u),
        optical_depth_of_light(cell, block, 2u),
        0.0,
    );
}
