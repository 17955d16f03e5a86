//! Formula tests of `shaders/lib/smoke_tiles.wgsl`.

use glam::UVec2;
use haze_core::formula::smoke_tiles;

use super::Formula;

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "tile_side",
            file: "lib/smoke_tiles.wgsl",
            wgsl: "y(0, f32(tile_side(u32(x(0)))));",
            reference: |x| vec![smoke_tiles::tile_side(x[0] as u32) as f32],
            cases: (1..=16).map(|scale| vec![scale as f32]).collect(),
            tolerance: 0.0,
            mutants: &[("MIN_TILE_PIXELS + scale - 1u", "8u"), ("* CELL_SIDE;", "* 8u;")],
        },
        Formula {
            name: "tile_counts",
            file: "lib/smoke_tiles.wgsl",
            wgsl: "let counts = tile_counts(vec2u(vec2f(x(0), x(1))), u32(x(2))); y2(0, vec2f(counts));",
            reference: |x| {
                let counts = smoke_tiles::tile_counts(UVec2::new(x[0] as u32, x[1] as u32), x[2] as u32);
                counts.as_vec2().to_array().to_vec()
            },
            cases: vec![vec![640.0, 361.0, 16.0], vec![1.0, 32.0, 32.0], vec![33.0, 8.0, 8.0]],
            tolerance: 0.0,
            mutants: &[("+ side - 1u) / side", "/ side)")],
        },
        Formula {
            name: "tile_origin",
            file: "lib/smoke_tiles.wgsl",
            wgsl: "let at = tile_origin(u32(x(0)), vec2u(vec2f(x(1), x(2))), u32(x(3))); y2(0, vec2f(at));",
            reference: |x| {
                let size = UVec2::new(x[1] as u32, x[2] as u32);
                smoke_tiles::tile_origin(x[0] as u32, size, x[3] as u32).as_vec2().to_array().to_vec()
            },
            cases: vec![vec![45.0, 640.0, 361.0, 16.0], vec![7.0, 33.0, 40.0, 16.0], vec![0.0, 1.0, 1.0, 8.0]],
            tolerance: 0.0,
            mutants: &[("tile / across", "tile")],
        },
    ]
}
