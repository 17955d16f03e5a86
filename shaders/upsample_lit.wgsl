// upsample_lit: computes the pixels that transfer_lit draws, where a GPU draws slowly.
// Reads   lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//         specular ramp.
// Writes  the smoke at full resolution, with the glow of lights behind it: premultiplied, linear light; Rgba16Float.
// Blend   none.
// Source  OTEE "Transfer & lighting", option 1: lighting at the target's resolution; "Specular scattering".

#import "lib/lit_pixel.wgsl"

// True: positions without slopes are filtered by the hardware; depth_slopes has computed slope_cells.
override SLOPE_CELLS: bool = false;

@group(3) @binding(6) var written: texture_storage_2d<rgba16float, write>;

// Side of a workgroup, pixels.
const SIDE: u32 = 8u;

@compute @workgroup_size(8, 8)
fn pixels(@builtin(global_invocation_id) id: vec3u, @builtin(workgroup_id) workgroup: vec3u) {
    // The same in all invocations of a workgroup.
    let first = workgroup.xy * SIDE;
    let texels = vec4u(first, first + SIDE - 1u) / system.scale;
    var color = vec4f(0.0);
    if cells_have(smoke_cells, texels.xy, texels.zw) {
        let origin = system.target_origin * f32(system.scale);
        var glowing = vec2u(0u);
        if GLOWS {
            let low = origin + vec2f(first);
            glowing = lights_that_reach(low, low + f32(SIDE));
        }
        var has_slopes = true;
        if SLOPE_CELLS {
            has_slopes = cells_have(slope_cells, texels.xy, texels.zw);
        }
        color = lit_pixel(origin + vec2f(id.xy) + 0.5, has_slopes, filter_texel_size(), glowing);
    }
    textureStore(written, id.xy, vec4f(bounded_light(color.rgb), color.a));
}
