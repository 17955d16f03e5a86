//! Formula tests of `shaders/lib/order.wgsl`.

use haze_core::formula::order;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v4};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "optical_depth_in_front",
            file: "lib/order.wgsl",
            wgsl: "var k: array<vec4f, 4>; for (var i = 0u; i < 16u; i++) { k[i / 4u][i % 4u] = x(3u + i); } \
                   y(0, optical_depth_in_front(k, x(0), x(1), x(2)));",
            reference: |x| {
                let knots = std::array::from_fn(|i| v4(&x[3 + 4 * i..]));
                vec![order::optical_depth_in_front(&knots, x[0], x[1], x[2])]
            },
            // Depths before the first knot, between knots, and beyond the last.
            cases: random(200, &[[(-2.0, 14.0), (3.0, 4.0), (5.0, 8.0)].as_slice(), &[(0.0, 9.0); 16]].concat()),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("through * 0.5 + 0.25", "through"), ("position - f32(low)", "0.0"), ("low + 1u", "low")],
        },
        Formula {
            name: "order_weight",
            file: "lib/order.wgsl",
            wgsl: "y(0, order_weight(x(0), x(1)));",
            reference: |x| vec![order::order_weight(x[0], x[1])],
            cases: random(100, &[(0.0, 4.0), (0.0, 12.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("depth_weight * optical_depth", "depth_weight"), ("exp(-min", "exp(min")],
        },
    ]
}
