//! Formula tests of `shaders/lib/flow.wgsl`.

use haze_core::formula::flow::{self, FlowStep, Flying, Wall};

use super::Formula;
use super::flight::{CASES, numbers, start, test_emitter, wgsl_emitter};
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, v3};

const WGSL_CARRIED: &str = wgsl_emitter!(
    "let f = carried_by_flow(e, Flying(Flight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))), 6.0, x(6))); \
     y3(0, f.position); y3(3, f.velocity);"
);

fn wall_numbers(wall: &Wall) -> Vec<f32> {
    [wall.normal.to_array().as_slice(), &[wall.distance], &wall.from_middle.to_array()].concat()
}

pub fn formulas() -> Vec<Formula> {
    // Around the rings that have left the source.
    const NEAR: [(f32, f32); 3] = [(0.0, 3.5), (2.0, 7.0), (1.0, 4.0)];
    vec![
        Formula {
            name: "swirl",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!("y3(0, swirl(e, vec3f(x(0), x(1), x(2)), x(3)));"),
            reference: |x| flow::swirl(&test_emitter(&[0.0]), v3(x), x[3]).to_array().to_vec(),
            cases: random(60, &[(-3.0, 3.0), (-3.0, 3.0), (-3.0, 3.0), (-6.0, 0.2)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("emitter.swirl_turn_rate * later", "0.0"),
                ("position - emitter.swirl_travel * later", "position"),
                ("emitter.swirl_frequency) + emitter.swirl_offset", "emitter.swirl_frequency)"),
                ("SWIRL_OCTAVES: u32 = 3u", "SWIRL_OCTAVES: u32 = 2u"),
                ("emitter.seed * 977u + octave", "emitter.seed * 977u"),
                ("at *= 2.0", "at *= 2.1"),
                ("first += first", "first += vec3i(1i)"),
                ("strength *= emitter.swirl_detail", "strength *= 0.5"),
            ],
        },
        Formula {
            name: "ring",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!("y3(0, ring(e, vec3f(x(0), x(1), x(2)), floor(x(3)), x(4)));"),
            reference: |x| flow::ring(&test_emitter(&[0.0]), v3(x), x[3].floor(), x[4]).to_array().to_vec(),
            cases: random(200, &[NEAR[0], NEAR[1], NEAR[2], (-3.0, 1.0), (-3.0, 0.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("(emitter.ring_phase - number) / emitter.ring_rate", "(0.0 - number) / emitter.ring_rate"),
                ("RING_SALT: u32 = 5u", "RING_SALT: u32 = 6u"),
                ("RING_GROWTH: f32 = 0.12", "RING_GROWTH: f32 = 0.1"),
                ("RING_SPREAD: f32 = 0.3", "RING_SPREAD: f32 = 0.2"),
                ("RING_ONSET: f32 = 0.1", "RING_ONSET: f32 = 0.2"),
                ("* hold * born_radius / radius", "* hold"),
                ("axis * (1.0 - aside)", "axis"),
                ("+ side * along)", "- side * along)"),
                ("exp(-aside - along * along)", "exp(-aside)"),
            ],
        },
        Formula {
            name: "rings",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!("y3(0, rings(e, vec3f(x(0), x(1), x(2)), x(3), x(4)));"),
            reference: |x| flow::rings(&test_emitter(&[0.0]), v3(x), x[3], x[4]).to_array().to_vec(),
            cases: random(100, &[NEAR[0], NEAR[1], NEAR[2], (-3.0, 1.0), (-3.0, 0.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("smoothstep_unit(2.0 - 2.0 * fraction)", "1.0"),
                ("smoothstep_unit(2.0 * fraction)", "fraction"),
                ("last + 1.0", "last"),
            ],
        },
        Formula {
            name: "floor_wall",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!(
                "let w = floor_wall(e, vec3f(x(0), x(1), x(2))); y3(0, w.normal); y(3, w.distance); y3(4, w.from_middle);"
            ),
            reference: |x| wall_numbers(&flow::floor_wall(&test_emitter(&[0.0]), v3(x))),
            cases: random(20, &[(-1.0, 3.0), (1.4, 2.5), (1.0, 5.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("dot(position, emitter.up) - emitter.floor", "dot(position, emitter.up)"),
                ("position - emitter.position", "position"),
            ],
        },
        Formula {
            name: "obstacle_wall",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!(
                "let w = obstacle_wall(e, vec3f(x(0), x(1), x(2))); y3(0, w.normal); y(3, w.distance); y3(4, w.from_middle);"
            ),
            reference: |x| wall_numbers(&flow::obstacle_wall(&test_emitter(&[0.0]), v3(x))),
            // Inside and on all sides.
            cases: random(300, &[(0.7, 1.9), (3.6, 4.4), (1.9, 3.3)]),
            // A normal is a small difference over another.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("abs(from_middle) - emitter.obstacle_core", "abs(from_middle)"),
                ("var normal = emitter.up", "var normal = vec3f(0.0)"),
                ("max(max(beyond.x, beyond.y), beyond.z)", "max(beyond.x, beyond.y)"),
                ("sign(from_middle) * outside", "outside"),
                ("distance - emitter.obstacle_rounding", "distance"),
            ],
        },
        Formula {
            name: "turned_aside",
            file: "lib/flow.wgsl",
            wgsl: wgsl_emitter!(
                "let w = obstacle_wall(e, vec3f(x(0), x(1), x(2))); y3(0, turned_aside(w, 0.6, vec3f(x(3), x(4), x(5)), 0.2));"
            ),
            reference: |x| {
                let wall = flow::obstacle_wall(&test_emitter(&[0.0]), v3(x));
                flow::turned_aside(&wall, 0.6, v3(&x[3..]), 0.2).to_array().to_vec()
            },
            cases: random(100, &[(0.3, 2.3), (3.5, 4.5), (1.4, 3.8), (-1.0, 1.0), (-2.0, 0.5), (-1.0, 1.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("smoothstep_unit(1.0 - wall.distance / margin)", "smoothstep_unit(1.0 - wall.distance)"),
                ("max(-dot(velocity, wall.normal), 0.0)", "-dot(velocity, wall.normal)"),
                ("(wall.normal + away) * towards", "wall.normal * towards"),
                ("dot(side, side) + margin * margin", "dot(side, side)"),
                ("max(-wall.distance, 0.0) * 0.5", "max(-wall.distance, 0.0)"),
            ],
        },
        Formula {
            name: "carried_by_flow",
            file: "lib/flow.wgsl",
            wgsl: WGSL_CARRIED,
            reference: |x| {
                let flying = Flying { start: start(x), lifetime: 6.0, seconds: x[6] };
                numbers(flow::carried_by_flow(&test_emitter(&[0.0]), &flying, &mut FlowStep::default()))
            },
            cases: random(60, &[CASES[0], CASES[1], CASES[2], CASES[3], CASES[4], CASES[5], (0.0, 5.99)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("FLOW_STEPS: u32 = 32u", "FLOW_STEPS: u32 = 31u"),
                ("SWIRL_ONSET: f32 = 0.15", "SWIRL_ONSET: f32 = 0.2"),
                ("path.position + offset", "path.position"),
                ("let later = seconds - flying.seconds", "let later = 0.0"),
                ("smoothstep_unit(age / SWIRL_ONSET)", "1.0"),
                ("velocity *= pace.speed;", ""),
                ("emitter.floor_margin, path.velocity + velocity", "emitter.floor_margin, path.velocity"),
                ("emitter.obstacle_margin, path.velocity + velocity", "emitter.obstacle_margin, path.velocity"),
                ("emitter.ring_phase - flying.seconds * emitter.ring_rate", "emitter.ring_phase"),
                ("velocity += emitter.wind_shear", "velocity -= emitter.wind_shear"),
                ("dot(position - emitter.position, emitter.up), 0.0)", "dot(position, emitter.up), 0.0)"),
                ("emitter.attraction / distance", "emitter.attraction"),
                ("emitter.attractor_size * emitter.attractor_size", "emitter.attractor_size"),
                ("moved.velocity * 1.5 - last.moved.velocity * 0.5", "moved.velocity"),
                ("(moved.velocity * rest - next", "(moved.velocity * rest + next"),
                ("(6.0 * x * rest)", "(x * rest)"),
                ("rest * (1.0 - 3.0 * x)", "rest"),
                ("x * (3.0 * x - 2.0)", "x"),
            ],
        },
    ]
}
