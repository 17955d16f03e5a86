//! Formula tests of `shaders/lib/lighting.wgsl`.

use glam::Vec3;
use haze_core::formula::lighting;
use haze_core::formula::uniforms::LightUniform;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, unit_vectors, v3, with_choices};

fn light(x: &[f32]) -> LightUniform {
    LightUniform {
        position: v3(&x[0..]),
        inverse_range: x[3],
        direction: v3(&x[4..]),
        directional: x[7],
        color: Vec3::ONE,
        specular_scatter: 1.0,
        spot_scale: x[8],
        spot_offset: x[9],
        radius: x[10],
        shadow_slot: 0.0,
    }
}

pub fn formulas() -> Vec<Formula> {
    [lights(), weights(), coverages(), specular_scatter()].into_iter().flatten().collect()
}

fn lights() -> Vec<Formula> {
    vec![
        Formula {
            name: "distance_attenuation",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, distance_attenuation(x(0), x(1), x(2)));",
            reference: |x| vec![lighting::distance_attenuation(x[0], x[1], x[2])],
            cases: {
                let mut cases = random(100, &[(0.0, 30.0), (0.1, 1.0), (0.1, 1.0)]);
                // Lights of radius 0 within 15 mm, and lights of unlimited range.
                cases.extend(random(20, &[(0.0, 2.0e-4), (0.0, 0.1), (0.0, 0.0)]));
                cases.extend(random(20, &[(0.0, 900.0), (0.0, 0.0), (0.1, 1.0)]));
                cases
            },
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("distance_squared + radius * radius", "distance_squared"),
                ("max(distance_squared + radius * radius, 1.0e-4)", "(distance_squared + radius * radius + 1.0e-9)"),
            ],
        },
        Formula {
            name: "range_window",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, range_window(x(0), x(1)));",
            reference: |x| vec![lighting::range_window(x[0], x[1])],
            cases: random(100, &[(0.0, 30.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("1.0 - ratio * ratio", "1.0 - ratio"), ("window * window", "window")],
        },
        Formula {
            name: "cone_attenuation",
            file: "lib/lighting.wgsl",
            wgsl: "let light = Light(vec3f(0.0), 0.0, vec3f(x(0), x(1), x(2)), 0.0, vec3f(1.0), 1.0, x(3), x(4), 0.0, 0.0); \
                   y(0, cone_attenuation(light, vec3f(x(5), x(6), x(7))));",
            reference: |x| {
                let light = LightUniform { direction: v3(x), spot_scale: x[3], spot_offset: x[4], ..light(&[0.0; 11]) };
                vec![lighting::cone_attenuation(&light, v3(&x[5..]))]
            },
            cases: {
                let any = (-1.0, 1.0);
                unit_vectors(unit_vectors(random(200, &[any, any, any, (0.0, 4.0), (0.0, 4.0), any, any, any]), 0), 5)
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("direction - light.direction", "direction + light.direction"),
                ("saturate(light.spot_offset - ", "(light.spot_offset - "),
                ("0.5 * dot(apart, apart)", "dot(apart, apart)"),
                ("cone * cone", "cone"),
            ],
        },
        Formula {
            name: "sample_light",
            file: "lib/lighting.wgsl",
            wgsl: "let light = Light(vec3f(x(0), x(1), x(2)), x(3), vec3f(x(4), x(5), x(6)), x(7), vec3f(1.0), \
                   1.0, x(8), x(9), x(10), 0.0); \
                   let s = sample_light(light, vec3f(x(11), x(12), x(13))); \
                   y(0, s.direction.x); y(1, s.direction.y); y(2, s.direction.z); y(3, s.attenuation);",
            reference: |x| {
                let sample = lighting::sample_light(&light(x), v3(&x[11..]));
                sample.direction.extend(sample.attenuation).to_array().to_vec()
            },
            cases: {
                let range = [
                    (-4.0, 4.0),
                    (-4.0, 4.0),
                    (-4.0, 4.0),
                    (0.05, 0.2),
                    (-1.0, 1.0),
                    (-1.0, 1.0),
                    (-1.0, 1.0),
                    (-0.5, 1.0),
                    (0.0, 4.0),
                    (0.0, 4.0),
                    (0.05, 0.5),
                    (-3.0, 3.0),
                    (-3.0, 3.0),
                    (-3.0, 3.0),
                ];
                unit_vectors(random(300, &range), 4)
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("cone_attenuation(light, -direction)", "cone_attenuation(light, direction)"),
                ("light.position - position", "position - light.position"),
                ("LightSample(-light.direction", "LightSample(light.direction"),
            ],
        },
    ]
}

fn weights() -> Vec<Formula> {
    vec![
        Formula {
            name: "diffuse_coordinate",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, diffuse_coordinate(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![lighting::diffuse_coordinate(v3(x), v3(&x[3..]))],
            cases: unit_vectors(unit_vectors(random(100, &[(-1.0, 1.0); 6]), 0), 3),
            tolerance: ARITHMETIC,
            mutants: &[("* 0.5 + 0.5", "")],
        },
        Formula {
            name: "direction_to_viewer",
            file: "lib/lighting.wgsl",
            wgsl: "let d = direction_to_viewer(vec3f(x(1), x(2), x(3)), x(0)); y(0, d.x); y(1, d.y); y(2, d.z);",
            reference: |x| lighting::direction_to_viewer(v3(&x[1..]), x[0]).to_array().to_vec(),
            cases: with_choices(2, &[(-9.0, 9.0), (-9.0, 9.0), (-50.0, -0.1)]),
            tolerance: ARITHMETIC,
            mutants: &[("return -position", "return position"), ("orthographic > 0.5", "orthographic > 2.0")],
        },
        Formula {
            name: "backlight_weight",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, backlight_weight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![lighting::backlight_weight(v3(x), v3(&x[3..]))],
            cases: unit_vectors(unit_vectors(random(100, &[(-1.0, 1.0); 6]), 0), 3),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - 0.5", "0.5 + 0.5"), ("against * against * against", "against * against")],
        },
        Formula {
            name: "soft_scatter_weight",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, soft_scatter_weight(x(0), x(1), x(2)));",
            reference: |x| vec![lighting::soft_scatter_weight(x[0], x[1], x[2])],
            cases: {
                let mut cases = random(100, &[(0.0, 1.0), (0.0, 0.5), (0.05, 1.0)]);
                // A scatter_smooth of 0 is a step; the smoothstep would divide by zero.
                cases.extend([vec![0.3, 0.5, 0.0], vec![0.7, 0.5, 0.0]]);
                cases
            },
            tolerance: 1e-5,
            mutants: &[
                ("amount - scatter_amount", "amount"),
                ("max(scatter_smooth, 1.0e-4)", "max(scatter_smooth - scatter_amount, 1.0e-4)"),
            ],
        },
    ]
}

fn coverages() -> Vec<Formula> {
    vec![
        Formula {
            name: "coverage",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, coverage(x(0), x(1)));",
            reference: |x| vec![lighting::coverage(x[0], x[1])],
            cases: random(50, &[(0.0, 1.0), (0.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("saturate(amount * boost)", "amount * boost")],
        },
        Formula {
            name: "painted_fraction",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, painted_fraction(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![lighting::painted_fraction(v3(x))],
            cases: random(100, &[(0.0, 1.3); 3]),
            tolerance: 1e-5,
            mutants: &[("luminance(paint)", "paint.r"), ("srgb_from_linear(saturate", "(saturate")],
        },
    ]
}

fn specular_scatter() -> Vec<Formula> {
    vec![
        Formula {
            name: "glow_falloff",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, glow_falloff(x(0), x(1), x(2)));",
            reference: |x| vec![lighting::glow_falloff(x[0], x[1], x[2])],
            cases: random(100, &[(0.0, 30.0), (0.05, 1.0), (0.0, 1.0)]),
            tolerance: TRANSCENDENTAL * 10.0,
            mutants: &[("-falloff", "falloff"), ("distance_squared + radius * radius", "distance_squared")],
        },
        Formula {
            name: "specular_scatter_fade",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, specular_scatter_fade(x(0), x(1), x(1) + x(2)));",
            reference: |x| vec![lighting::specular_scatter_fade(x[0], x[1], x[1] + x[2])],
            cases: random(50, &[(0.0, 9.0), (1.0, 4.0), (1.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("light_depth - smoke_near", "smoke_far - light_depth")],
        },
        Formula {
            name: "visibility_tap",
            file: "lib/lighting.wgsl",
            wgsl: "let v = visibility_tap(u32(x(0)), x(1)); y(0, v.x); y(1, v.y);",
            reference: |x| lighting::visibility_tap(x[0] as u32, x[1]).to_array().to_vec(),
            cases: with_choices(lighting::VISIBILITY_TAPS, &[(0.0, 20.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("index == 8u", "false"), ("0.785398163", "0.7"), ("* radius, vec2f", ", vec2f")],
        },
    ]
}
