//! Formula tests of `shaders/lib/density_grid.wgsl`, `shaders/lib/shadow.wgsl`, `shaders/lib/scene_shadow.wgsl` and
//! `shaders/lib/screen_shadow.wgsl`.

use haze_core::formula::{density_grid, depth_moments, scene_shadow, screen_shadow, shadow, shadow_map};

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, unit_vectors, v3, with_choices};

const SIDE: (f32, f32) = (-1.0, 1.0);
/// Places in a grid of 9 x 12 x 7 cells.
const PLACE: [(f32, f32); 3] = [(0.0, 9.0), (0.0, 12.0), (0.0, 7.0)];

pub fn formulas() -> Vec<Formula> {
    [density(), lookups(), on_scene(), on_screen(), by_depth()].into_iter().flatten().collect()
}

fn density() -> Vec<Formula> {
    vec![
        Formula {
            name: "mean_optical_depth",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, mean_optical_depth(x(0), x(1), x(2)));",
            reference: |x| vec![density_grid::mean_optical_depth(x[0], x[1], x[2])],
            cases: random(100, &[(-0.2, 1.2), (0.0, 1.0), (0.01, 0.97)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("/ peak;", ";"), ("saturate(amount) * peak", "saturate(amount)")],
        },
        Formula {
            name: "bump_integral",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, bump_integral(x(0)));",
            reference: |x| vec![density_grid::bump_integral(x[0])],
            cases: random(60, &[(-1.5, 1.5)]),
            tolerance: ARITHMETIC,
            mutants: &[("clamp(q, -1.0, 1.0)", "q"), ("square * 0.2", "0.2")],
        },
        Formula {
            name: "bump_radius",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, bump_radius(x(0)));",
            reference: |x| vec![density_grid::bump_radius(x[0])],
            cases: random(30, &[(0.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("max(radius, 1.5)", "radius")],
        },
        Formula {
            name: "cell_optical_depth",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, cell_optical_depth(vec3f(x(0), x(1), x(2)), x(3), x(4)));",
            reference: |x| vec![density_grid::cell_optical_depth(v3(x), x[3], x[4])],
            cases: random(200, &[(-4.0, 3.0), (-4.0, 3.0), (-4.0, 3.0), (0.3, 5.0), (0.0, 2.0)]),
            tolerance: ARITHMETIC * 10.0,
            // The second: a grid that is half a cell off.
            mutants: &[("(x * y * z)", "(x * y)"), ("(low + 1.0) / reach", "(low + 0.5) / reach")],
        },
        Formula {
            name: "density_steps",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, f32(density_steps(x(0))));",
            reference: |x| vec![density_grid::density_steps(x[0]) as f32],
            cases: random(60, &[(-1.0, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("DENSITY_STEPS + 0.5", "DENSITY_STEPS - 0.5"),
                ("max(optical_depth, 0.0)", "abs(optical_depth)"),
            ],
        },
        Formula {
            name: "optical_depth_of_steps",
            file: "lib/density_grid.wgsl",
            wgsl: "y(0, optical_depth_of_steps(u32(x(0)), u32(x(1))));",
            reference: |x| vec![density_grid::optical_depth_of_steps(x[0] as u32, x[1] as u32)],
            cases: random(60, &[(0.0, 1.0e6), (0.0, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("f32(high) * 65536.0", "f32(high)")],
        },
    ]
}

fn lookups() -> Vec<Formula> {
    vec![
        Formula {
            name: "shadow_ray",
            file: "lib/shadow.wgsl",
            wgsl: "let r = shadow_ray(vec4f(x(1), x(2), x(3), x(0)), vec3f(x(4), x(5), x(6)), vec3f(9.0, 12.0, 7.0)); \
                   y3(0, r.xyz); y(3, r.w);",
            reference: |x| {
                let light = glam::Vec4::new(x[1], x[2], x[3], x[0]);
                shadow::shadow_ray(light, v3(&x[4..]), glam::vec3(9.0, 12.0, 7.0)).to_array().to_vec()
            },
            // Lamps in the grid and beyond it, and suns.
            cases: unit_vectors(
                with_choices(2, &[SIDE, SIDE, SIDE, PLACE[0], PLACE[1], PLACE[2], (2.0, 30.0)])
                    .into_iter()
                    .map(|mut case| {
                        let length = if case[0] > 0.5 { 1.0 } else { case[7] };
                        case[1..4].iter_mut().for_each(|axis| *axis *= length);
                        case
                    })
                    .collect(),
                1,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("origin * (1.0 - light.w)", "origin"),
                ("select(origin, size - origin,", "select(size - origin, origin,"),
                ("select(min(leave, distance), leave,", "select(leave, leave,"),
                ("let direction = to_light / distance", "let direction = -to_light / distance"),
            ],
        },
        Formula {
            name: "own_optical_depth",
            file: "lib/shadow.wgsl",
            wgsl: "y(0, own_optical_depth(x(0), x(1)));",
            reference: |x| vec![shadow::own_optical_depth(x[0], x[1])],
            cases: random(60, &[(0.1, 9.0), (0.0, 2.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("return 4.0 *", "return 8.0 *"), ("0.09 * kept * kept", "0.09")],
        },
        Formula {
            name: "foreign_optical_depths",
            file: "lib/shadow.wgsl",
            wgsl: "y3(0, foreign_optical_depths(vec3f(x(0), x(1), x(2)), x(3)));",
            reference: |x| shadow::foreign_optical_depths(v3(x), x[3]).to_array().to_vec(),
            cases: random(60, &[(0.0, 4.0), (0.0, 4.0), (0.0, 4.0), (0.0, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("in_grid - own", "in_grid"), ("max(in_grid - own, vec3f(0.0))", "in_grid - own")],
        },
        Formula {
            name: "shadow_position",
            file: "lib/shadow.wgsl",
            wgsl: "let p = shadow_position(x(0), vec3f(x(1), x(2), x(3)), vec3f(x(4), x(5), x(6))); y(0, p.x); y(1, p.y);",
            reference: |x| shadow::shadow_position(x[0], v3(&x[1..]), v3(&x[4..])).to_array().to_vec(),
            cases: unit_vectors(unit_vectors(random(100, &[(0.0, 12.0), SIDE, SIDE, SIDE, SIDE, SIDE, SIDE]), 1), 4),
            tolerance: TRANSCENDENTAL,
            mutants: &[("exp2(-optical_depth)", "exp2(optical_depth)"), ("0.5 - 0.5 * dot", "0.5 + 0.5 * dot")],
        },
        Formula {
            name: "channel_of_slot",
            file: "lib/shadow.wgsl",
            wgsl: "y3(0, channel_of_slot(x(0)));",
            reference: |x| shadow::channel_of_slot(x[0]).to_array().to_vec(),
            cases: with_choices(16, &[]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("vec3f(1.0, 2.0, 3.0)", "vec3f(3.0, 2.0, 1.0)"),
                ("max(1.0 - abs(vec3f(1.0, 2.0, 3.0) - slot), vec3f(0.0))", "1.0 - abs(vec3f(1.0, 2.0, 3.0) - slot)"),
            ],
        },
        Formula {
            name: "select_slot",
            file: "lib/shadow.wgsl",
            wgsl: "y(0, select_slot(x(0), vec3f(x(1), x(2), x(3))));",
            reference: |x| vec![shadow::select_slot(x[0], v3(&x[1..]))],
            cases: with_choices(16, &[(0.1, 3.0), (0.1, 3.0), (0.1, 3.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("vec3f(1.0, 2.0, 3.0)", "vec3f(3.0, 2.0, 1.0)"),
                ("slot - block_of_slot(slot) * f32(LIGHTS_PER_BLOCK)", "slot"),
            ],
        },
        Formula {
            name: "block_of_slot",
            file: "lib/shadow.wgsl",
            wgsl: "y(0, block_of_slot(x(0)));",
            reference: |x| vec![shadow::block_of_slot(x[0])],
            cases: with_choices(16, &[]),
            tolerance: ARITHMETIC,
            mutants: &[("max(slot - 1.0, 0.0)", "slot"), ("floor(max(slot", "(max(slot")],
        },
        Formula {
            name: "light_disc_offset",
            file: "lib/shadow.wgsl",
            wgsl: "y3(0, light_disc_offset(u32(x(0)), vec3f(x(1), x(2), x(3))));",
            reference: |x| shadow::light_disc_offset(x[0] as u32, v3(&x[1..])).to_array().to_vec(),
            cases: unit_vectors(with_choices(48, &[SIDE, SIDE, SIDE]), 1),
            // The sine of a large angle.
            tolerance: TRANSCENDENTAL * 10.0,
            mutants: &[("sqrt(position.x)", "position.x"), ("0.7548777, 0.5698403", "0.5698403, 0.7548777")],
        },
        Formula {
            name: "own_at_mean_depth",
            file: "lib/shadow.wgsl",
            wgsl: "y(0, own_at_mean_depth(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![shadow::own_at_mean_depth(v3(x), v3(&x[3..]))],
            cases: random(60, &[(0.0, 4.0); 6]),
            tolerance: ARITHMETIC,
            mutants: &[("max(in_grid - accumulated, vec3f(0.0))", "in_grid - accumulated"), ("1.0 / 3.0", "1.0")],
        },
    ]
}

fn on_scene() -> Vec<Formula> {
    vec![
        Formula {
            name: "grid_entry",
            file: "lib/scene_shadow.wgsl",
            wgsl: "let e = grid_entry(vec4f(x(1), x(2), x(3), x(0)), vec3f(x(4), x(5), x(6)), vec3f(9.0, 12.0, 7.0)); \
                   y3(0, e.xyz * e.w); y(3, e.w);",
            reference: |x| {
                let light = glam::Vec4::new(x[1], x[2], x[3], x[0]);
                let entry = scene_shadow::grid_entry(light, v3(&x[4..]), glam::vec3(9.0, 12.0, 7.0));
                (entry.truncate() * entry.w).extend(entry.w).to_array().to_vec()
            },
            // Lamps and suns, and points in the grid and around it.
            cases: unit_vectors(
                with_choices(2, &[SIDE, SIDE, SIDE, (-9.0, 18.0), (-12.0, 24.0), (-7.0, 14.0), (2.0, 30.0)])
                    .into_iter()
                    .map(|mut case| {
                        let length = if case[0] > 0.5 { 1.0 } else { case[7] };
                        case[1..4].iter_mut().for_each(|axis| *axis *= length);
                        case
                    })
                    .collect(),
                1,
            ),
            tolerance: TRANSCENDENTAL * 10.0,
            // The fourth: the light on the wrong side.
            mutants: &[
                ("origin * (1.0 - light.w)", "origin"),
                ("max(max(first.x, max(first.y, first.z)), 0.0)", "max(first.x, max(first.y, first.z))"),
                ("select(min(leave, distance), leave,", "select(leave, leave,"),
                ("let direction = to_light / distance", "let direction = -to_light / distance"),
            ],
        },
        Formula {
            name: "transmitted_light",
            file: "lib/scene_shadow.wgsl",
            wgsl: "y3(0, transmitted_light(x(0), vec3f(x(1), x(2), x(3))));",
            reference: |x| scene_shadow::transmitted_light(x[0], v3(&x[1..])).to_array().to_vec(),
            cases: random(60, &[(0.0, 8.0), (0.0, 2.0), (0.0, 2.0), (0.0, 2.0)]),
            tolerance: TRANSCENDENTAL,
            // The first: the sign of the shadow.
            mutants: &[("exp(-optical_depth)", "exp(optical_depth)"), ("exp2(-optical_depth)", "exp(-optical_depth)")],
        },
    ]
}

fn on_screen() -> Vec<Formula> {
    vec![
        Formula {
            name: "smoother_step",
            file: "lib/screen_shadow.wgsl",
            wgsl: "y3(0, smoother_step(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| screen_shadow::smoother_step(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: random(60, &[SIDE; 6]),
            tolerance: ARITHMETIC,
            mutants: &[("select(b, a,", "select(a, b,")],
        },
        Formula {
            name: "scene_normal",
            file: "lib/screen_shadow.wgsl",
            wgsl: "let c = vec3f(0.1, 0.2, -5.0); \
                   y3(0, scene_normal(c, c + vec3f(-0.1, 0.0, x(0)), c + vec3f(0.1, 0.0, x(1)), \
                   c + vec3f(0.0, 0.1, x(2)), c + vec3f(0.0, -0.1, x(3))));",
            reference: |x| {
                let c = glam::vec3(0.1, 0.2, -5.0);
                let at = |dx, dy, dz| c + glam::vec3(dx, dy, dz);
                let normal = screen_shadow::scene_normal(
                    c,
                    at(-0.1, 0.0, x[0]),
                    at(0.1, 0.0, x[1]),
                    at(0.0, 0.1, x[2]),
                    at(0.0, -0.1, x[3]),
                );
                normal.to_array().to_vec()
            },
            cases: random(60, &[(-0.3, 0.3); 4]),
            tolerance: TRANSCENDENTAL * 10.0,
            mutants: &[("cross(across, up)", "cross(up, across)"), ("center - left", "left - center")],
        },
        Formula {
            name: "fraction_of_light",
            file: "lib/screen_shadow.wgsl",
            wgsl: "y3(0, fraction_of_light(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| screen_shadow::fraction_of_light(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: random(60, &[(0.5, 4.0), (0.5, 4.0), (0.5, 4.0), (0.0, 4.0), (0.0, 4.0), (0.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("(shaded + 1.0e-6) / (full + 1.0e-6)", "shaded")],
        },
    ]
}

fn by_depth() -> Vec<Formula> {
    vec![
        Formula {
            name: "depth_moments",
            file: "lib/depth_moments.wgsl",
            wgsl: "let m = depth_moments(x(0), x(1), x(2), x(2) + x(3)); y(0, m.x); y(1, m.y);",
            reference: |x| depth_moments::depth_moments(x[0], x[1], x[2], x[2] + x[3]).to_array().to_vec(),
            cases: random(60, &[(0.0, 12.0), (0.1, 2.0), (0.5, 4.0), (0.5, 6.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("(view_depth - near) / range", "view_depth / range"), ("reach * reach / 7.0", "reach / 7.0")],
        },
        Formula {
            name: "depth_of_sample",
            file: "lib/depth_moments.wgsl",
            wgsl: "y(0, depth_of_sample(u32(x(0)), vec2f(x(1), x(1) * x(1) + x(2)), 2.0, 7.0));",
            reference: |x| {
                let moments = glam::vec2(x[1], x[1] * x[1] + x[2]);
                vec![depth_moments::depth_of_sample(x[0] as u32, moments, 2.0, 7.0)]
            },
            cases: with_choices(4, &[(0.0, 1.0), (-0.01, 0.1)]),
            tolerance: 1e-4,
            mutants: &[("moments.y - moments.x * moments.x", "moments.y"), ("* 1.7320508", "")],
        },
        Formula {
            name: "shadow_map_position",
            file: "lib/shadow_map.wgsl",
            wgsl: "let p = shadow_map_position(vec4f(x(0), x(1), x(2), x(3))); y3(0, p.xyz * p.w); y(3, p.w);",
            reference: |x| {
                let position = shadow_map::shadow_map_position(glam::Vec4::new(x[0], x[1], x[2], x[3]));
                (position.truncate() * position.w).extend(position.w).to_array().to_vec()
            },
            cases: random(120, &[(-1.5, 1.5), (-1.5, 1.5), (-0.5, 1.5), (-0.5, 1.5)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("0.5 - ndc.y * 0.5", "0.5 + ndc.y * 0.5"),
                ("ndc.z >= 0.0", "true"),
                ("<= vec3f(1.0)", "<= vec3f(2.0)"),
            ],
        },
        Formula {
            name: "shadow_map_visibility",
            file: "lib/shadow_map.wgsl",
            wgsl: "y(0, shadow_map_visibility(x(1), x(2), 0.1, x(0) > 0.5));",
            reference: |x| vec![shadow_map::shadow_map_visibility(x[1], x[2], 0.1, x[0] > 0.5)],
            cases: with_choices(2, &[(0.0, 1.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            // The first: light and shadow exchanged for maps of the other convention.
            mutants: &[
                ("depth >= stored - bias, reversed", "depth <= stored + bias, reversed"),
                ("stored + bias", "stored"),
            ],
        },
    ]
}
