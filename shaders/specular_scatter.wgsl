// specular_scatter: draws the glow of lights behind the smoke, one quad of constant pixel size around each light.
// Reads   accumulation target, or lit smoke and its depth slopes; reduced depth, scene depth, lights, specular ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE (additive); alpha is unchanged.
// Source  OTEE "Specular scattering".

#import "lib/lit_target.wgsl"
#import "lib/glow.wgsl"
#import "lib/sprite.wgsl"

// True: the amount comes from the output of light_target.
override LIT: bool = false;

struct QuadVertex {
    @builtin(position) position: vec4f,
    // -1..1 across the quad.
    @location(0) uv: vec2f,
    // Of the Glow.
    @location(1) @interpolate(flat, either) color: vec3f,
    @location(2) @interpolate(flat, either) light: u32,
    @location(3) @interpolate(flat, either) texel_size: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> QuadVertex {
    var out: QuadVertex;
    // Outside the clip volume, unless the light shows.
    out.position = vec4f(2.0, 2.0, 2.0, 1.0);
    let glow = glow_of_light(lights[instance]);
    if all(glow.color <= vec3f(0.0)) {
        return out;
    }
    let corner = sprite_corner(index);
    let extent = corner * system.specular_scatter_size * 2.0 / view.size;
    out.position = vec4f(ndc_from_pixel(glow.center, view.size) + extent, 0.5, 1.0);
    out.uv = corner;
    out.color = glow.color;
    out.light = instance;
    out.texel_size = filter_texel_size();
    return out;
}

@fragment
fn fragment(in: QuadVertex) -> @location(0) vec4f {
    let distance_squared = dot(in.uv, in.uv);
    if distance_squared >= 1.0 {
        discard;
    }
    let pixel = in.position.xy - view.origin;
    var amount = 0.0;
    if LIT {
        amount = sample_lit(pixel, in.texel_size).a;
    } else {
        amount = sample_target(accumulation, pixel).a;
    }
    if amount <= 0.0 {
        discard;
    }
    return vec4f(glow_in_smoke(in.color, lights[in.light], distance_squared, amount, pixel), 0.0);
}
