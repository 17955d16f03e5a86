// transfer_lit: draws smoke that light_target has lit, over the tiles that hold smoke. Where light_target has computed it, also
// the glow of lights behind the smoke.
// Reads   lit smoke and its depth slopes, reduced depth, scene depth, coverage ramp; cells with smoke and with slopes, glows,
//         specular ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE_MINUS_SRC_ALPHA (premultiplied over the scene).
// Source  OTEE "Transfer & lighting", option 1: lighting at the target's resolution; "Specular scattering".

#import "lib/lit_pixel.wgsl"
#import "lib/bounding_box.wgsl"
#import "lib/sprite.wgsl"

const TILES_ALL: u32 = 0u;
const TILES_FLAT: u32 = 1u;
const TILES_SLOPED: u32 = 2u;
// Tiles that are drawn. A pipeline of its own for those without slopes: some GPUs run all branches of a shader.
override TILES: u32 = TILES_ALL;
// True: upsample_lit has computed the pixels, which take the place of the lit smoke.
override COMPUTED: bool = false;

struct TileVertex {
    @builtin(position) position: vec4f,
    // First light whose glow reaches the tile, and one past the last.
    @location(0) @interpolate(flat, either) glowing: vec2u,
    @location(1) @interpolate(flat, either) texel_size: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> TileVertex {
    let first_texel = tile_origin(instance, vec2u(system.target_size), tile_side(system.scale));
    if !is_drawn(first_texel) {
        // Outside the clip volume.
        return TileVertex(vec4f(2.0, 2.0, 2.0, 1.0), vec2u(0u), vec2f(0.0));
    }
    // Tested in front of the box, none of which is nearer.
    let clip = view.clip_from_view * vec4f(0.0, 0.0, -max(system.bounds_near, view.near), 1.0);
    let depth = select(clip.z / clip.w, 0.5, BACK_FACES);
    let corner = tile_corner(first_texel, sprite_corner(index) * 0.5 + 0.5);
    let position = vec4f(ndc_from_pixel(corner, view.size), depth, 1.0);
    var glowing = vec2u(0u);
    if GLOWS && !COMPUTED {
        glowing = lights_that_reach(tile_corner(first_texel, vec2f(0.0)), tile_corner(first_texel, vec2f(1.0)));
    }
    return TileVertex(position, glowing, filter_texel_size());
}

fn is_drawn(first_texel: vec2u) -> bool {
    if !tile_has(smoke_cells, first_texel) {
        return false;
    }
    return TILES == TILES_ALL || tile_has(slope_cells, first_texel) == (TILES == TILES_SLOPED);
}

@fragment
fn fragment(in: TileVertex) -> @location(0) vec4f {
    let pixel = in.position.xy - view.origin;
    var color: vec4f;
    if COMPUTED {
        color = textureLoad(accumulation, vec2i(pixel - system.target_origin * f32(system.scale)), 0);
    } else {
        color = lit_pixel(pixel, TILES != TILES_FLAT, in.texel_size, in.glowing);
    }
    if all(color == vec4f(0.0)) {
        discard;
    }
    return color;
}
