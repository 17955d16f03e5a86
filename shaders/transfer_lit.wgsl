// transfer_lit: draws smoke that light_target has lit: over the system's bounding box, or over the tiles that hold smoke,
// then with the glow of lights behind it.
// Reads   lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//         specular ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", option 1: lighting at the target's resolution; "Specular scattering".

#import "lib/lit_pixel.wgsl"
#import "lib/bounding_box.wgsl"
#import "lib/sprite.wgsl"

// True: an instance is a tile of the target; light_target has computed smoke_cells.
override TILES: bool = false;
// True: upsample_lit has computed the pixels, which take the place of the lit smoke.
override COMPUTED: bool = false;

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

@fragment
fn fragment(in: BoxVertex) -> @location(0) vec4f {
    let pixel = in.position.xy - view.origin;
    var color: vec4f;
    if COMPUTED {
        color = textureLoad(accumulation, vec2i(pixel - system.target_origin * f32(system.scale)), 0);
    } else {
        color = lit_pixel(pixel, in.has_slopes != 0u, in.texel_size, in.glowing);
    }
    if all(color == vec4f(0.0)) {
        discard;
    }
    return color;
}
