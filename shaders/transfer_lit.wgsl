// transfer_lit: draws smoke that light_target has lit: over the system's bounding box, or over the tiles that hold smoke,
// then with the glow of lights behind it.
// Reads   lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//         specular ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", option 1: lighting at the target's resolution; "Specular scattering".

#import "lib/lit_target.wgsl"
#import "lib/bounding_box.wgsl"
#import "lib/smoke_tiles.wgsl"
#import "lib/sprite.wgsl"
#import "lib/coverage.wgsl"
#import "lib/glow.wgsl"

// True: an instance is a tile of the target; light_target has computed smoke_cells.
override TILES: bool = false;
// True: tiles without slopes are filtered by the hardware; depth_slopes has computed slope_cells.
override SLOPE_CELLS: bool = false;
// True: adds the glow of lights, which light_target has computed.
override GLOWS: bool = false;

// A column per light: the rows of a Glow.
@group(3) @binding(4) var glows: texture_2d<f32>;

struct BoxVertex {
    @builtin(position) position: vec4f,
    // First light whose glow reaches the tile, and one past the last.
    @location(0) @interpolate(flat, either) glowing: vec2u,
    // 0 if no texel of the tile has a slope, otherwise 1.
    @location(1) @interpolate(flat, either) has_slopes: u32,
    @location(2) @interpolate(flat, either) texel_size: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> BoxVertex {
    if TILES {
        return tile_vertex(
            sprite_corner(index) * 0.5 + 0.5,
            tile_origin(instance, vec2u(system.target_size), tile_side(system.scale)),
        );
    }
    return BoxVertex(box_position(index), vec2u(0u), 1u, filter_texel_size());
}

fn tile_vertex(side: vec2f, first_texel: vec2u) -> BoxVertex {
    if !tile_has(smoke_cells, first_texel) {
        // Outside the clip volume.
        return BoxVertex(vec4f(2.0, 2.0, 2.0, 1.0), vec2u(0u), 0u, vec2f(0.0));
    }
    // Tested in front of the box, none of which is nearer.
    let clip = view.clip_from_view * vec4f(0.0, 0.0, -max(system.bounds_near, view.near), 1.0);
    let depth = select(clip.z / clip.w, 0.5, BACK_FACES);
    let position = vec4f(ndc_from_pixel(tile_corner(first_texel, side), view.size), depth, 1.0);
    var glowing = vec2u(0u);
    if GLOWS {
        glowing = lights_that_reach(tile_corner(first_texel, vec2f(0.0)), tile_corner(first_texel, vec2f(1.0)));
    }
    var has_slopes = true;
    if SLOPE_CELLS {
        has_slopes = tile_has(slope_cells, first_texel);
    }
    return BoxVertex(position, glowing, u32(has_slopes), filter_texel_size());
}

// Range of the lights whose glow reaches a rectangle of pixels.
fn lights_that_reach(low: vec2f, high: vec2f) -> vec2u {
    var range = vec2u(0u);
    for (var i = 0u; i < system.light_count; i++) {
        let centre = textureLoad(glows, vec2u(i, 0u), 0).xy;
        let color = textureLoad(glows, vec2u(i, 1u), 0).rgb;
        let offset = centre - clamp(centre, low, high);
        let reaches = dot(offset, offset) < system.specular_scatter_size * system.specular_scatter_size;
        if reaches && any(color > vec3f(0.0)) {
            range = vec2u(select(range.x, i, range.y == 0u), i + 1u);
        }
    }
    return range;
}

@fragment
fn fragment(in: BoxVertex) -> @location(0) vec4f {
    let pixel = in.position.xy - view.origin;
    var lit: vec4f;
    if SLOPE_CELLS && in.has_slopes == 0u {
        let place = filtered_place(pixel / f32(system.scale) - system.target_origin, in.texel_size);
        lit = textureSampleLevel(accumulation, linear_sampler, place, 0.0);
    } else {
        lit = sample_lit(pixel, in.texel_size);
    }
    let amount = lit.a;
    if amount <= 0.0 {
        discard;
    }
    // Light of the texels, weighted by their amounts. Amounts below a millionth are invisible, and must not divide.
    let smoke = vec4f(bounded_light(lit.rgb / max(amount, 1.0e-6)), 1.0) * smoke_coverage(amount);
    if GLOWS {
        return smoke + vec4f(glow_of_lights(in.glowing, amount, pixel), 0.0);
    }
    return smoke;
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
