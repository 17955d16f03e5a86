// Color of a pixel of lit smoke, with the glow of lights behind it, shared by transfer_lit and upsample_lit.

#import "lib/lit_target.wgsl"
#import "lib/smoke_tiles.wgsl"
#import "lib/coverage.wgsl"
#import "lib/glow.wgsl"
#import "lib/blending.wgsl"

// True: adds the glow of lights, which light_target has computed.
override GLOWS: bool = false;

// A column per light: the rows of a Glow.
@group(3) @binding(4) var glows: texture_2d<f32>;

// Premultiplied color at a pixel of the view; zero where there is no smoke. `has_slopes`: false if no texel around has a
// slope. `texel_size`: filter_texel_size(). `glowing`: lights_that_reach() the pixel.
fn lit_pixel(pixel: vec2f, has_slopes: bool, texel_size: vec2f, glowing: vec2u) -> vec4f {
    var lit: vec4f;
    if !has_slopes {
        let position = filtered_position(pixel / f32(system.scale) - system.target_origin, texel_size);
        lit = textureSampleLevel(accumulation, linear_sampler, position, 0.0);
    } else {
        lit = sample_lit(pixel, texel_size);
    }
    let amount = lit.a;
    if amount <= 0.0 {
        return vec4f(0.0);
    }
    // Light of the texels, weighted by their amounts. Amounts below a millionth are invisible, and must not divide.
    let light = bounded_light(lit.rgb / max(amount, 1.0e-6));
    let smoke = deferred_fragment(ADDITIVE, light, smoke_coverage(amount));
    if GLOWS {
        return smoke + vec4f(glow_of_lights(glowing, amount, pixel), 0.0);
    }
    return smoke;
}

// First light whose glow reaches a rectangle of pixels, and one past the last.
fn lights_that_reach(low: vec2f, high: vec2f) -> vec2u {
    var range = vec2u(0u);
    for (var i = 0u; i < system.light_count; i++) {
        let center = textureLoad(glows, vec2u(i, 0u), 0).xy;
        let color = textureLoad(glows, vec2u(i, 1u), 0).rgb;
        let offset = center - clamp(center, low, high);
        let reaches = dot(offset, offset) < system.specular_scatter_size * system.specular_scatter_size;
        if reaches && any(color > vec3f(0.0)) {
            range = vec2u(select(range.x, i, range.y == 0u), i + 1u);
        }
    }
    return range;
}

fn glow_of_lights(glowing: vec2u, amount: f32, pixel: vec2f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = glowing.x; i < glowing.y; i++) {
        let offset = (pixel - textureLoad(glows, vec2u(i, 0u), 0).xy) / system.specular_scatter_size;
        let color = textureLoad(glows, vec2u(i, 1u), 0).rgb;
        let distance_squared = dot(offset, offset);
        if distance_squared < 1.0 && any(color > vec3f(0.0)) {
            sum += glow_in_smoke(color, lights[i], distance_squared, amount, pixel);
        }
    }
    return sum;
}
