// diffuse_bake: bakes all lights through the diffuse ramp into a small texture by normal, once per system and frame.
// Reads   lights, diffuse and backlight ramp.
// Writes  one face of the cubemap, or the motif: Rgba16Float, linear light.
// Blend   none.
// Source  OTEE "Diffuse lighting": "use cubemaps", "motif lighting".
// Space   Normals in view space. Lights are sampled at the middle of the system.

#import "lib/diffuse.wgsl"
#import "lib/diffuse_bake.wgsl"
#import "lib/color.wgsl"

override MOTIF: bool = false;
// Number of texels along a side of the target.
override BAKE_SIZE: f32 = 32.0;

struct BakeVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) face: u32,
}

// Face i is drawn with vertices 3i to 3i + 2.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> BakeVertex {
    let corner = index % 3u;
    return BakeVertex(
        vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0),
        index / 3u,
    );
}

@fragment
fn fragment(in: BakeVertex) -> @location(0) vec4f {
    // First and last texel centers lie on -1 and 1.
    let position = floor(in.position.xy) / (BAKE_SIZE - 1.0) * 2.0 - 1.0;
    var normal = motif_normal(position);
    if !MOTIF {
        normal = normalize(cube_direction(i32(in.face), position));
    }
    // Baked by normal only, with the coverage of thick smoke.
    let unshaded = shade_of_sprites(vec3f(0.0));
    return vec4f(bounded_light(diffuse_from_lights(normal, 1.0, system.center, unshaded)), 1.0);
}
