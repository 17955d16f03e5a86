// mark_cells: marks the cells of lit smoke by which transfer_lit draws, where light_target and depth_slopes do not compute
// them.
// Reads   lit smoke and its depth slopes.
// Writes  1 for each cell with smoke, and for each with a slope; R8Unorm.
// Blend   none.
// Source  own.

#import "lib/bindings.wgsl"
#import "lib/smoke_tiles.wgsl"

@group(3) @binding(0) var lit: texture_2d<f32>;
@group(3) @binding(1) var depth_slopes: texture_2d<f32>;

// True: there are slopes.
override SLOPES: bool = false;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle that covers the target.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

struct Cell {
    @location(0) has_smoke: f32,
    @location(1) has_slope: f32,
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> Cell {
    let first = vec2u(position.xy) * CELL_SIDE;
    let end = min(first + CELL_SIDE, vec2u(system.target_size));
    var amount = 0.0;
    var slope = vec4f(0.0);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            amount = max(amount, textureLoad(lit, vec2u(x, y), 0).a);
            if SLOPES {
                slope = max(slope, abs(textureLoad(depth_slopes, vec2u(x, y), 0)));
            }
        }
    }
    return Cell(select(0.0, 1.0, amount > 0.0), select(0.0, 1.0, any(slope > vec4f(0.0))));
}
