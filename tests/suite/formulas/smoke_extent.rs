//! Formula tests of `shaders/lib/smoke_extent.wgsl`.

use haze_core::formula::smoke_extent;

use super::Formula;
use super::inputs::{ARITHMETIC, random};

pub fn formulas() -> Vec<Formula> {
    const FILE: &str = "lib/smoke_extent.wgsl";
    vec![
        Formula {
            name: "extent_weight",
            file: FILE,
            wgsl: "y(0, extent_weight(x(0), x(1), x(2), x(3)));",
            reference: |x| vec![smoke_extent::extent_weight(x[0], x[1], x[2], x[3])],
            cases: random(100, &[(-0.5, 1.5), (0.1, 2.0), (-1.0, 3.0), (0.1, 0.5)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("saturate(amount) *", "amount *"),
                ("(view_depth - near)", "view_depth"),
                ("* radius * radius", "* radius"),
            ],
        },
        Formula {
            name: "mean_square_depth",
            file: FILE,
            wgsl: "y(0, mean_square_depth(x(0), x(1)));",
            reference: |x| vec![smoke_extent::mean_square_depth(x[0], x[1])],
            cases: random(50, &[(-3.0, 3.0), (0.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("radius / 3.0", "radius")],
        },
        Formula {
            name: "half_extent",
            file: FILE,
            wgsl: "y(0, half_extent(x(0), x(1)));",
            reference: |x| vec![smoke_extent::half_extent(x[0], x[1])],
            // Above and below the square of the mean.
            cases: random(50, &[(0.0, 9.0), (-1.0, 1.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("sqrt(3.0 * ", "sqrt("), ("mean_square - mean * mean", "mean_square")],
        },
        Formula {
            name: "reach_behind",
            file: FILE,
            wgsl: "y(0, reach_behind(x(0), x(1), x(2)));",
            reference: |x| vec![smoke_extent::reach_behind(x[0], x[1], x[2])],
            cases: random(100, &[(0.0, 0.1), (2.0, 9.0), (4.0, 6.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("max(back - center_depth, 0.0)", "(back - center_depth)"), (", 1.0);", ", 2.0);")],
        },
    ]
}
