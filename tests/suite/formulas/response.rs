//! Formula tests of `shaders/lib/response.wgsl`.

use glam::Vec3;
use haze_core::formula::response::{diffuse_response, fire_response, soft_scatter_curve};
use haze_core::settings::{Backlight, RampFilter};

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, test_ramp, unit_vectors, v2, v3, with_choices};

const FRACTION: (f32, f32) = (0.0, 1.0);
const SIDE: (f32, f32) = (-1.0, 1.0);

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "diffuse_response",
            file: "lib/response.wgsl",
            wgsl: "BACKLIGHT = u32(x(0)); y3(0, diffuse_response(test_ramp, test_ramp, test_sampler, \
                   vec3f(x(1), x(2), x(3)), vec3f(x(4), x(5), x(6)), x(7), x(8)));",
            reference: |x| {
                let ramp = test_ramp();
                let against = if Backlight::ALL[x[0] as usize] == Backlight::Ramp { x[8] } else { 0.0 };
                let normal = v3(&x[1..]);
                let to_light = v3(&x[4..]);
                diffuse_response([&ramp; 2], RampFilter::Bilinear, normal, to_light, x[7], against).to_array().to_vec()
            },
            cases: unit_vectors(
                unit_vectors(
                    with_choices(count(Backlight::ALL), &[SIDE, SIDE, SIDE, SIDE, SIDE, SIDE, FRACTION, FRACTION]),
                    1,
                ),
                4,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("diffuse_coordinate(normal, to_light), covered", "diffuse_coordinate(normal, -to_light), covered"),
                (
                    "sample_ramp_2d(ramp_from_behind, linear_sampler, at)",
                    "sample_ramp_2d(ramp_from_behind, linear_sampler, at.yx)",
                ),
                (
                    "if BACKLIGHT == BACKLIGHT_RAMP {\n        falloff = mix(falloff, sample_ramp_2d(ramp_from_behind, linear_sampler, at), against)",
                    "{\n        falloff = mix(falloff, vec3f(0.0), against)",
                ),
            ],
        },
        Formula {
            name: "soft_scatter_curve",
            file: "lib/response.wgsl",
            wgsl: "y3(0, soft_scatter_curve(x(0), vec3f(0.9, 0.2, 0.4), vec3f(0.1, 0.6, 0.3), x(1), x(2)));",
            reference: |x| {
                let colors = [Vec3::new(0.9, 0.2, 0.4), Vec3::new(0.1, 0.6, 0.3)];
                soft_scatter_curve(x[0], colors[0], colors[1], x[1], x[2]).to_array().to_vec()
            },
            cases: random(100, &[FRACTION; 3]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("mix(scatter_color, ambient_color", "mix(ambient_color, scatter_color"),
                ("soft_scatter_weight(amount, scatter_amount", "soft_scatter_weight(amount, 0.0"),
            ],
        },
        Formula {
            name: "fire_response",
            file: "lib/response.wgsl",
            wgsl: "y3(0, fire_response(test_ramp, test_sampler, vec2f(x(0), x(1)), x(2), x(3)));",
            reference: |x| fire_response(&test_ramp(), RampFilter::Bilinear, v2(x), x[2], x[3]).to_array().to_vec(),
            cases: random(100, &[FRACTION, FRACTION, FRACTION, (0.5, 2.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("coverage(amount * fire.y, boost)", "coverage(amount, boost)"),
                ("boost))) * fire.y", "boost)))"),
                ("vec2f(fire.x,", "vec2f(fire.y,"),
            ],
        },
    ]
}
