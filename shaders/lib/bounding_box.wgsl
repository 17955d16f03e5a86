// Bounding box of a system, drawn by transfer.

#import "lib/bindings.wgsl"

// True: draw back faces, which the near plane never clips away. False: draw front faces, depth-tested.
override BACK_FACES: bool = false;

// The twelve triangles of a box, counter-clockwise seen from outside. Bit 0 of a corner is x, bit 1 is y, bit 2 is z.
const BOX_CORNERS = array<u32, 36>(
    0u, 2u, 1u, 1u, 2u, 3u,
    4u, 5u, 6u, 5u, 7u, 6u,
    0u, 1u, 4u, 1u, 5u, 4u,
    2u, 6u, 3u, 3u, 6u, 7u,
    0u, 4u, 2u, 2u, 4u, 6u,
    1u, 3u, 5u, 3u, 7u, 5u,
);

// Clip position of a vertex of the box.
fn box_position(index: u32) -> vec4f {
    var corners = BOX_CORNERS;
    let corner = corners[index];
    let side = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
    let world = mix(system.bounds_min, system.bounds_max, side);
    var clip = view.clip_from_view * (view.view_from_world * vec4f(world, 1.0));
    if BACK_FACES {
        // Not depth-tested: the near and far planes do not matter, only the half-space in front of the eye.
        clip.z = 0.5 * clip.w;
    }
    return clip;
}
