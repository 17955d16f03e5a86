// A slice of the volume of a frame's shadow, as a render target.

struct SliceVertex {
    @builtin(position) position: vec4f,
    // Index along z.
    @location(0) @interpolate(flat, either) slice: u32,
}

// One triangle that covers the slice.
fn slice_vertex(index: u32, slice: u32) -> SliceVertex {
    return SliceVertex(vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0), slice);
}
