// depth_slopes: fits a line to the lit smoke over depth around each texel, for its upsampling.
// Reads   lit smoke, reduced depth.
// Writes  change of the lit smoke over SLOPE_LENGTH of a soft fade; Rgba16Float. Zero where depth hardly changes.
//         In compute also the cells with such a change.
// Blend   none.
// Source  He and Sun, "Fast guided filter", 2015: the coefficients are fitted at low resolution.

#import "lib/accumulated.wgsl"
#import "lib/cells.wgsl"

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return slope_at(vec2i(floor(position.xy)));
}

@group(3) @binding(2) var written: texture_storage_2d<rgba16float, write>;
// As slope_cells in lib/smoke_tiles.wgsl.
@group(3) @binding(3) var written_cells: texture_storage_2d<r32float, write>;

var<workgroup> has_slope: array<atomic<u32>, 4>;

// A workgroup is four cells.
@compute @workgroup_size(8, 8)
fn texels(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(local_invocation_index) index: u32,
) {
    if all(id.xy < vec2u(system.target_size)) {
        let slope = slope_at(vec2i(id.xy));
        textureStore(written, id.xy, slope);
        if any(slope != vec4f(0.0)) {
            atomicStore(&has_slope[quad_cell(local.xy)], 1u);
        }
    }
    workgroupBarrier();
    if index < 4u {
        textureStore(written_cells, quad_position(workgroup.xy, index), vec4f(f32(atomicLoad(&has_slope[index]))));
    }
}

fn slope_at(texel: vec2i) -> vec4f {
    let depth = guide(texel);
    let fade = 1.0 / system.fade_scale;
    var nearest = depth;
    var farthest = depth;
    for (var i = 0; i < 5; i++) {
        let around = guide(clamped_texel(texel + cross_offset(i)));
        nearest = min(nearest, around);
        farthest = max(farthest, around);
    }
    if is_shallow(nearest, farthest, fade) {
        return vec4f(0.0);
    }
    var line: DepthLine;
    for (var i = 0; i < 5; i++) {
        let offset = cross_offset(i);
        let at = clamped_texel(texel + offset);
        let z = guide(at) - depth;
        line = add_to_line(line, z, guided_weight(vec3f(vec2f(offset), z), depth), textureLoad(accumulation, at, 0));
    }
    return depth_slope(line, fade);
}

// Offset of one of five texels, which form a cross.
fn cross_offset(index: i32) -> vec2i {
    if index < 3 {
        return vec2i(index - 1, 0);
    }
    return vec2i(0, 2 * index - 7);
}
