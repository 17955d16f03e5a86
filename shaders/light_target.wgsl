// light_target: lights the accumulated smoke once per texel, under lighting_resolution `target`. transfer upsamples the
// light.
// Reads   accumulation target, lights, ramps, baked diffuse light.
// Writes  lit smoke: rgb light times amount, a amount; Rgba16Float, linear light. In compute also the cells with smoke, and
//         the glow of lights behind it.
// Blend   none.
// Source  OTEE "Transfer & lighting", at the target's resolution.
// Space   As in transfer.

#import "lib/lit_smoke.wgsl"
#import "lib/glow.wgsl"
#import "lib/cells.wgsl"

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return lit_texel(floor(position.xy));
}

@group(3) @binding(6) var written: texture_storage_2d<rgba16float, write>;

// As smoke_cells in lib/smoke_tiles.wgsl, and glows in transfer_lit.wgsl.
@group(3) @binding(7) var written_cells: texture_storage_2d<r32float, write>;
@group(3) @binding(8) var written_glows: texture_storage_2d<rgba32float, write>;

var<workgroup> has_smoke: array<atomic<u32>, 4>;

// A workgroup is four cells.
@compute @workgroup_size(8, 8)
fn texels(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(local_invocation_index) index: u32,
) {
    if all(id.xy < vec2u(system.target_size)) {
        let lit = lit_texel(vec2f(id.xy));
        textureStore(written, id.xy, lit);
        if lit.a > 0.0 {
            atomicStore(&has_smoke[quad_cell(local.xy)], 1u);
        }
    }
    workgroupBarrier();
    if index < 4u {
        textureStore(written_cells, quad_position(workgroup.xy, index), vec4f(f32(atomicLoad(&has_smoke[index]))));
    }
    if all(workgroup.xy == vec2u(0u)) {
        for (var light = index; light < system.light_count; light += 64u) {
            let glow = glow_of_light(lights[light]);
            textureStore(written_glows, vec2u(light, 0u), vec4f(glow.center, 0.0, 0.0));
            textureStore(written_glows, vec2u(light, 1u), vec4f(glow.color, 0.0));
        }
    }
}

fn lit_texel(texel: vec2f) -> vec4f {
    let accumulated = textureLoad(accumulation, vec2i(texel), 0);
    let amount = accumulated.a;
    if amount <= 0.0 {
        return vec4f(0.0);
    }
    // The center of the texel represents all of its pixels.
    let pixel = (texel + system.target_origin + 0.5) * f32(system.scale);
    let surface = shaded_surface(accumulated, load_attachments(vec2i(texel)), pixel);
    let reflected = diffuse(surface, amount, lit_position(surface, pixel)) + soft_scatter(amount) * surface.tint;
    let light = reflected + fire_light(surface, amount);
    return vec4f(bounded_light(light), 1.0) * amount;
}
