// light_target: lights the accumulated smoke once per texel, under lighting_resolution `target`. transfer upsamples the
// light.
// Reads   accumulation target, lights, ramps, baked diffuse light.
// Writes  lit smoke: rgb light times amount, a amount; Rgba16Float, linear light.
// Blend   none.
// Source  OTEE "Transfer & lighting", at the target's resolution.
// Space   As in transfer.

#import "lib/lit_smoke.wgsl"
#import "lib/color.wgsl"

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

@compute @workgroup_size(8, 8)
fn texels(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < vec2u(system.target_size)) {
        textureStore(written, id.xy, lit_texel(vec2f(id.xy)));
    }
}

fn lit_texel(texel: vec2f) -> vec4f {
    let accumulated = textureLoad(accumulation, vec2i(texel), 0);
    let amount = accumulated.a;
    if amount <= 0.0 {
        return vec4f(0.0);
    }
    // The centre of the texel represents all of its pixels.
    let pixel = (texel + system.target_origin + 0.5) * f32(system.scale);
    let surface = shaded_surface(accumulated, load_attachments(vec2i(texel)), pixel);
    let reflected = diffuse(surface, amount, lit_position(surface, pixel)) + soft_scatter(amount) * surface.tint;
    let light = reflected + fire_light(surface, amount);
    return vec4f(bounded_light(light), 1.0) * amount;
}
