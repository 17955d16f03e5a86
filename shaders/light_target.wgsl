// light_target: lights the accumulated smoke once per texel, under lighting_resolution `target`. transfer upsamples the
// light.
// Reads   accumulation target, lights, ramps, baked diffuse light; scene depth, for the glow of lights.
// Writes  lit smoke: rgb light times amount, a amount; Rgba16Float, linear light. The glow of lights behind the smoke is added to
//         the light by `texels_with_glow`, in place of specular_scatter.
// Blend   none.
// Source  OTEE "Transfer & lighting", at the target's resolution.
// Space   As in transfer.

#import "lib/lit_smoke.wgsl"
#import "lib/glow.wgsl"
#import "lib/color.wgsl"

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = floor(position.xy);
    return lit_texel(texel, vec3f(0.0));
}

@group(3) @binding(6) var written: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn texels(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < vec2u(system.target_size)) {
        textureStore(written, id.xy, lit_texel(vec2f(id.xy), vec3f(0.0)));
    }
}

// Found by one invocation of the workgroup each.
var<workgroup> glows: array<Glow, MAX_LIGHTS>;

@compute @workgroup_size(8, 8)
fn texels_with_glow(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    for (var i = local; i < system.light_count; i += 64u) {
        glows[i] = glow_of_light(lights[i]);
    }
    workgroupBarrier();
    if any(id.xy >= vec2u(system.target_size)) {
        return;
    }
    let pixel = pixel_of_texel(vec2f(id.xy));
    let amount = textureLoad(accumulation, vec2i(id.xy), 0).a;
    var glow = vec3f(0.0);
    for (var i = 0u; i < system.light_count; i++) {
        let away = (pixel - glows[i].centre) / system.specular_scatter_size;
        let distance_squared = dot(away, away);
        if distance_squared < 1.0 && amount > 0.0 && any(glows[i].color > vec3f(0.0)) {
            glow += glow_light(glows[i].color, glows[i].position_inverse_range, distance_squared, amount, pixel);
        }
    }
    textureStore(written, id.xy, lit_texel(vec2f(id.xy), glow));
}

// The centre of a texel represents all of its pixels.
fn pixel_of_texel(texel: vec2f) -> vec2f {
    return (texel + system.target_origin + 0.5) * f32(system.scale);
}

// `glow`: light that is added to the picture whatever the coverage.
fn lit_texel(texel: vec2f, glow: vec3f) -> vec4f {
    let accumulated = textureLoad(accumulation, vec2i(texel), 0);
    let amount = accumulated.a;
    if amount <= 0.0 {
        return vec4f(0.0);
    }
    let pixel = pixel_of_texel(texel);
    let surface = shaded_surface(accumulated, load_attachments(vec2i(texel)), pixel);
    let reflected = diffuse(surface, amount, lit_position(surface, pixel)) + soft_scatter(amount) * surface.tint;
    let light = reflected + fire_light(surface, amount) + light_before_coverage(glow, coverage(amount, system.boost));
    return vec4f(bounded_light(light), 1.0) * amount;
}
