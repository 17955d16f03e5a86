// Cells of the lit target, which tell where there is smoke and where it has slopes over depth.

// Side of a cell, texels.
const CELL_SIDE: u32 = 4u;

// Index among the four cells of a workgroup of 8x8 invocations, row by row. `local`: of an invocation in its workgroup.
fn quad_cell(local: vec2u) -> u32 {
    return local.x / CELL_SIDE + 2u * (local.y / CELL_SIDE);
}

// Cell of a workgroup by its index among the four.
fn quad_position(workgroup: vec2u, index: u32) -> vec2u {
    return workgroup * 2u + vec2u(index & 1u, index >> 1u);
}
